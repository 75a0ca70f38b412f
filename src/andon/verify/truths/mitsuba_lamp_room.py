"""A furnished corner with a shaded table lamp, as Mitsuba traces it: the lamp off, and its light.

::

      window ▒ │       ┌────┐ picture     The shade is a thin sheet that scatters what it lets
      (cold)   │       └────┘             through; the bulb is a ball inside it, stem and foot are
               │  ceiling lamp (warm)     under it. All reflections are traced. What is written
         sofa  │    ╱▔╲ lamp              here is all that Mitsuba is told: no geometry, light or
         ▟█▙   │  ══╤══╤══ table, vase    material of Andon's is in it.
      ─────────┴──────────────── rug
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.spaces import View
from andon.verify.truths.mitsuba_glass import mitsuba, sensor_of

__all__ = ["BULB_M", "SHADE", "LampRoom", "Shade", "camera"]

Float = NDArray[np.float64]

WIDTH, HEIGHT = 320, 240
# Everything is in metres, +Y up; the corner is at x = −1.5, z = −1.6.
FLOOR, CEILING, LEFT, RIGHT, BACK, FRONT = 0.0, 2.6, -1.5, 2.3, -1.6, 2.4
TABLE_M = 0.52
MAX_DEPTH = 10


@dataclass(frozen=True)
class Shade:
    """A drum: radii below and above, height of its lower rim over the floor, and its own height."""

    radius_m: float = 0.17
    top_radius_m: float = 0.13
    height_m: float = 0.22
    lower_rim_m: float = TABLE_M + 0.27
    centre: tuple[float, float] = (-0.35, -1.05)


SHADE = Shade()
BULB_RADIUS_M = 0.03
BULB_M = (SHADE.centre[0], SHADE.lower_rim_m + 0.10, SHADE.centre[1])
# Of the paper: a fifth is lost at every hit, a third is let through.
PAPER = {"base_color": (0.82, 0.80, 0.74), "diff_trans": 0.8}
# Photometric, linear Rec.709: lumens of the bulb, cd/m² of window and ceiling lamp.
BULB_LM, BULB_RGB = 420.0, (1.42, 0.95, 0.52)
WINDOW_CD_M2, WINDOW_RGB = 420.0, (0.86, 1.00, 1.35)
CEILING_CD_M2, CEILING_RGB = 600.0, (1.25, 0.98, 0.62)


def camera() -> View:
    """At eye height of somebody who sits, before the corner."""
    eye, at = np.array([0.5, 1.2, 1.05]), np.array([-0.18, 0.76, -1.1])
    forward = (at - eye) / np.linalg.norm(at - eye)
    right = np.cross(forward, [0.0, 1.0, 0.0])
    right /= np.linalg.norm(right)
    pose = np.eye(4)
    pose[:3, :3] = np.stack([right, np.cross(forward, right), forward], axis=1)
    pose[:3, 3] = eye
    focal = 0.95 * WIDTH
    return View(
        "pinhole",
        WIDTH,
        HEIGHT,
        focal,
        focal,
        (WIDTH - 1) / 2,
        (HEIGHT - 1) / 2,
        world_from_camera=pose,
    )


class LampRoom:
    """The room under one of two lights. Raises `NotShown` where Mitsuba is not installed.

    Parameters
    ----------
    bulb : the bulb shines; else window and ceiling lamp do.
    """

    def __init__(self, *, bulb: bool) -> None:
        document: dict[str, Any] = {"type": "scene", **_walls(), **_furniture(), **_lamp(bulb)}
        if not bulb:
            document |= _daylight()
        self.scene: Any = mitsuba().load_dict(document)

    def traced(self, view: View, /, *, samples: int, seed: int = 0) -> Float:
        """(H, W, 3) luminance in cd/m² by paths from the camera."""
        mi = mitsuba()
        integrator = mi.load_dict({"type": "path", "max_depth": MAX_DEPTH})
        sensor = sensor_of(view)
        picture = mi.render(
            self.scene, sensor=sensor, integrator=integrator, spp=samples, seed=seed
        )
        return np.array(picture, np.float64)[..., :3]

    def traced_from_bulb(self, view: View, /, *, samples: int, seed: int = 0) -> Float:
        """(H, W, 3) luminance in cd/m² by paths from the bulb: what a lit shade needs."""
        mi = mitsuba()
        integrator = mi.load_dict({"type": "ptracer", "max_depth": MAX_DEPTH})
        sensor = sensor_of(view)
        picture = mi.render(
            self.scene, sensor=sensor, integrator=integrator, spp=samples, seed=seed
        )
        return np.array(picture, np.float64)[..., :3]

    def depth(self, view: View, /) -> Float:
        """(H, W) planar depth in metres at the pixels' centres; NaN where nothing is."""
        mi = mitsuba()
        directions = view.rays_world()[1]
        along = view.rays_planar()
        length = np.linalg.norm(along, axis=-1)
        origin = mi.Point3f(view.position.tolist())
        depth = np.full(view.shape, np.nan)
        for row, column in np.ndindex(*view.shape):
            ray = mi.Ray3f(origin, mi.Vector3f(directions[row, column].tolist()))
            hit = self.scene.ray_intersect(ray)
            if hit.is_valid():
                depth[row, column] = hit.t / length[row, column]
        return depth


def _rgb(values: Any) -> dict[str, Any]:
    return {"type": "rgb", "value": [float(x) for x in values]}


def _diffuse(reflectance: Any) -> dict[str, Any]:
    if isinstance(reflectance, np.ndarray):
        picture = np.ascontiguousarray(reflectance, np.float32)
        reflectance = {"type": "bitmap", "bitmap": mitsuba().Bitmap(picture), "raw": True}
    else:
        reflectance = _rgb(reflectance)
    return {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": reflectance}}


def _quad(middle: Any, right: Any, up: Any) -> dict[str, Any]:
    """Half-sides `right` and `up` about `middle`; faces right × up."""
    right, up = np.asarray(right, float), np.asarray(up, float)
    normal = np.cross(right, up)
    pose = np.eye(4)
    pose[:3] = np.stack([right, up, normal / np.linalg.norm(normal), middle], axis=1)
    return {"type": "rectangle", "to_world": mitsuba().ScalarTransform4f(pose)}


def _box(middle: Any, half: Any, turn_degrees: float = 0.0) -> dict[str, Any]:
    transform: Any = mitsuba().ScalarTransform4f
    pose = transform().translate(list(middle)).rotate([0, 1, 0], turn_degrees).scale(list(half))
    return {"type": "cube", "to_world": pose}


def _walls() -> dict[str, Any]:
    x, y, z = (LEFT + RIGHT) / 2, (FLOOR + CEILING) / 2, (BACK + FRONT) / 2
    wide, high, deep = (RIGHT - LEFT) / 2, (CEILING - FLOOR) / 2, (FRONT - BACK) / 2
    random = np.random.default_rng(3)
    return {
        "floor": _quad((x, FLOOR, z), (wide, 0, 0), (0, 0, -deep))
        | {"bsdf": _diffuse(_boards(random))},
        "ceiling": _quad((x, CEILING, z), (wide, 0, 0), (0, 0, deep))
        | {"bsdf": _diffuse((0.78, 0.77, 0.75))},
        "back": _quad((x, y, BACK), (wide, 0, 0), (0, high, 0))
        | {"bsdf": _diffuse(_plaster(random, (0.66, 0.63, 0.56)))},
        "front": _quad((x, y, FRONT), (-wide, 0, 0), (0, high, 0))
        | {"bsdf": _diffuse((0.55, 0.55, 0.53))},
        "left": _quad((LEFT, y, z), (0, 0, -deep), (0, high, 0))
        | {"bsdf": _diffuse(_plaster(random, (0.46, 0.56, 0.58)))},
        "right": _quad((RIGHT, y, z), (0, 0, deep), (0, high, 0))
        | {"bsdf": _diffuse((0.62, 0.60, 0.57))},
    }


def _furniture() -> dict[str, Any]:
    random = np.random.default_rng(4)
    table = (-0.25, TABLE_M - 0.02, -1.1)
    made: dict[str, Any] = {
        "table": _box(table, (0.55, 0.02, 0.36)) | {"bsdf": _diffuse((0.36, 0.22, 0.13))},
        "book": _box((0.06, TABLE_M + 0.02, -0.98), (0.11, 0.02, 0.08), 25)
        | {"bsdf": _diffuse((0.52, 0.12, 0.10))},
        "book2": _box((0.05, TABLE_M + 0.055, -0.98), (0.10, 0.015, 0.07), 10)
        | {"bsdf": _diffuse((0.13, 0.22, 0.42))},
        "vase": {
            "type": "sphere",
            "center": [0.14, TABLE_M + 0.07, -1.25],
            "radius": 0.07,
            "bsdf": _diffuse((0.70, 0.68, 0.62)),
        },
        "rug": _quad((0.15, 0.008, -0.2), (0.8, 0, 0), (0, 0, -0.55))
        | {"bsdf": _diffuse(_checks())},
        "frame": _box((0.55, 1.35, BACK + 0.015), (0.27, 0.21, 0.015))
        | {"bsdf": _diffuse((0.10, 0.08, 0.06))},
        "picture": _quad((0.55, 1.35, BACK + 0.032), (0.23, 0, 0), (0, 0.17, 0))
        | {"bsdf": _diffuse(_painting(random))},
        "seat": _box((1.05, 0.22, -1.05), (0.42, 0.22, 0.40))
        | {"bsdf": _diffuse((0.30, 0.34, 0.24))},
        "rest": _box((1.05, 0.55, -1.40), (0.42, 0.30, 0.10))
        | {"bsdf": _diffuse((0.32, 0.36, 0.26))},
        "cushion": _box((0.95, 0.56, -1.18), (0.18, 0.14, 0.06), 12)
        | {"bsdf": _diffuse((0.66, 0.50, 0.18))},
    }
    for number, (x, z) in enumerate(((-0.75, -1.4), (0.25, -1.4), (-0.75, -0.8), (0.25, -0.8))):
        leg = _box((x, TABLE_M / 2 - 0.02, z), (0.025, TABLE_M / 2 - 0.02, 0.025))
        made[f"leg{number}"] = leg | {"bsdf": _diffuse((0.30, 0.18, 0.11))}
    return made


def _lamp(shines: bool) -> dict[str, Any]:
    mi = mitsuba()
    x, z = SHADE.centre
    foot = TABLE_M + 0.012
    paper = {
        "type": "principledthin",
        "base_color": _rgb(PAPER["base_color"]),
        "diff_trans": PAPER["diff_trans"],
        "spec_trans": 0.0,
        "eta": 1.0001,
        "roughness": 0.4,
    }
    bulb: dict[str, Any] = {"type": "sphere", "center": list(BULB_M), "radius": BULB_RADIUS_M}
    bulb["bsdf"] = _diffuse((0.75, 0.75, 0.75))
    if shines:
        # Φ = π·L·4πr²
        luminance = BULB_LM / (4 * np.pi**2 * BULB_RADIUS_M**2)
        bulb["emitter"] = {"type": "area", "radiance": _rgb(luminance * np.array(BULB_RGB))}
    stem = {"type": "cylinder", "p0": [x, foot, z], "p1": [x, BULB_M[1] - 0.035, z]}
    return {
        "shade": {**_drum(mi), "bsdf": paper},
        "bulb": bulb,
        "stem": {**stem, "radius": 0.008, "bsdf": _diffuse((0.35, 0.30, 0.20))},
        "foot": {
            "type": "cylinder",
            "p0": [x, TABLE_M, z],
            "p1": [x, foot, z],
            "radius": 0.07,
            "bsdf": _diffuse((0.35, 0.30, 0.20)),
        },
        "foot_top": {
            "type": "disk",
            "to_world": mi.ScalarTransform4f()
            .translate([x, foot, z])
            .rotate([1, 0, 0], -90)
            .scale([0.07, 0.07, 1]),
            "bsdf": _diffuse((0.35, 0.30, 0.20)),
        },
    }


def _drum(mi: Any) -> dict[str, Any]:
    """Flat panels, 72 around and 6 along: 0.2 mm off the cone."""
    around, along = 72, 6
    turn, rise = np.meshgrid(np.linspace(0, 2 * np.pi, around + 1), np.linspace(0, 1, along + 1))
    radius = SHADE.radius_m + rise * (SHADE.top_radius_m - SHADE.radius_m)
    points = np.stack(
        [
            SHADE.centre[0] + radius * np.sin(turn),
            SHADE.lower_rim_m + rise * SHADE.height_m,
            SHADE.centre[1] + radius * np.cos(turn),
        ],
        axis=-1,
    ).reshape(-1, 3)
    first = (np.arange(along)[:, None] * (around + 1) + np.arange(around)).ravel()
    above = first + around + 1
    faces = np.concatenate(
        [np.stack([first, first + 1, above + 1], 1), np.stack([first, above + 1, above], 1)]
    )
    mesh = mi.Mesh("shade", len(points), len(faces))
    parameters = mi.traverse(mesh)
    parameters["vertex_positions"] = points.astype(np.float32).ravel()
    parameters["faces"] = faces.astype(np.uint32).ravel()
    parameters.update()
    return {"type": "ply", "filename": _written(mesh)}


def _written(mesh: Any) -> str:
    from tempfile import mkdtemp

    path = f"{mkdtemp(prefix='andon-mitsuba-')}/shade.ply"
    mesh.write_ply(path)
    return path


def _daylight() -> dict[str, Any]:
    window = _quad((RIGHT - 0.01, 1.35, 0.6), (0, 0, 0.5), (0, 0.6, 0))
    above = _quad((0.9, CEILING - 0.03, 0.9), (0.2, 0, 0), (0, 0, 0.2))
    cold = WINDOW_CD_M2 * np.array(WINDOW_RGB)
    warm = CEILING_CD_M2 * np.array(CEILING_RGB)
    return {
        "window": window | {"emitter": {"type": "area", "radiance": _rgb(cold)}},
        "above": above | {"emitter": {"type": "area", "radiance": _rgb(warm)}},
    }


def _boards(random: Any) -> Float:
    """Floor boards of many browns."""
    shade = random.uniform(0.7, 1.15, (24, 1, 1)) * random.uniform(0.93, 1.05, (24, 160, 1))
    rows = np.repeat(shade * np.array([0.42, 0.29, 0.18]), 8, axis=0)
    rows[::8] *= 0.6
    return np.clip(rows, 0.02, 0.9)


def _plaster(random: Any, base: tuple[float, float, float]) -> Float:
    return np.clip(np.array(base) * random.uniform(0.95, 1.05, (96, 128, 1)), 0, 0.9)


def _checks() -> Float:
    rows, columns = np.mgrid[:120, :160]
    odd = ((rows // 12 + columns // 16) % 2 == 1)[..., None]
    return np.where(odd, np.array([0.62, 0.52, 0.40]), np.array([0.30, 0.09, 0.10]))


def _painting(random: Any) -> Float:
    rows, columns = np.mgrid[:60, :80] / 60.0
    sky = np.stack([0.35 + 0.3 * rows, 0.45 + 0.2 * rows, 0.65 - 0.2 * rows], axis=-1)
    hill = rows > 0.55 + 0.12 * np.sin(5 * columns)
    land = np.array([0.20, 0.33, 0.14]) * random.uniform(0.7, 1.2, (60, 80, 1))
    return np.clip(np.where(hill[..., None], land, sky), 0.03, 0.85)
