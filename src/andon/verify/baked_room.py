"""The furnished room as files, baked by `andon.bake`, and Radiance's own answer at its pixels.

A spot, a ball and a disk are direct with a baked bounce, a panel at the ceiling is baked whole. The
truth uses nothing of the bake but the room and its lamps: Radiance is asked anew at the frame's own
points, without its cache of irradiance.

The photograph is made here: ρ·E0/π of each pixel, E0 from Radiance in the light of two other lamps.
What differs between ours and the truth is ΔE alone, and what 8 bits lose.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.bake.maps import bake_maps
from andon.bake.tasks import write_bundle
from andon.files.pictures import write_exr, write_png
from andon.lamps import Lamp, PolygonLamp, resolve_lamps
from andon.pipeline import EngineName, Frame, render
from andon.quantities import Geometry, Surface
from andon.responses import SRGB
from andon.scene import Scene, scene_from_dict
from andon.spaces import View
from andon.surface import reference as surface
from andon.surface.load import surface_of_mesh
from andon.transport.baked.radiance import radiance_bundle
from andon.transport.baked.radiance.quality import QUALITIES, Quality
from andon.transport.baked.radiance.scene import BOUNCE_OCTREE, OCTREE
from andon.transport.baked.radiance.trace import traced_illuminance
from andon.verify.rooms import camera_in
from andon.verify.setting import room

__all__ = [
    "BOUNCES",
    "DIMMING",
    "LAMPS",
    "added_lux",
    "asked_pixels",
    "baked_frame",
    "captured_parts",
    "relit_lux",
    "white_cd_m2",
]

Float = NDArray[np.float64]

WIDTH, HEIGHT = 240, 135
BOUNCES = 3
DIMMING = 0.3
# Pixels at which the truth is asked, each by itself; converged light of all would take hours.
ASKED = 250
TRUTH = QUALITIES["normal"]
# Of each area lamp in the truth, seen by all rays: eight are the bake's own.
TILES = 24
# Of the photograph's white above its brightest pixel, and above the brightest relit one.
MARGIN = 1.02

LAMPS: dict[str, dict[str, Any]] = {
    "spot": {
        "kind": "spot",
        "transport": "direct+bounce",
        "position": [-1.8, 2.6, 1.2],
        "direction": [0.6, -0.65, -0.45],
        "inner_degrees": 18.0,
        "outer_degrees": 30.0,
        "intensity_cd": 250.0,
        "rgb": [1.0, 0.8, 0.6],
    },
    "panel": {
        "kind": "rectangle",
        "transport": "baked",
        "position": [-0.4, 2.85, 0.6],
        "direction": [0.0, -1.0, 0.0],
        "up": [0.0, 0.0, -1.0],
        "width_m": 0.8,
        "height_m": 0.5,
        "luminance_cd_m2": 600.0,
        "rgb": [0.7, 0.9, 1.0],
        "drawn": False,
    },
    "ball": {
        "kind": "sphere",
        "transport": "direct+bounce",
        "position": [0.3, 2.6, 0.4],
        "radius_m": 0.12,
        "luminance_cd_m2": 1200.0,
        "rgb": [1.0, 0.75, 0.45],
        "drawn": False,
    },
    "disk": {
        "kind": "disk",
        "transport": "direct+bounce",
        "position": [-2.2, 1.5, -0.5],
        "direction": [0.9, -0.4, 0.0],
        "radius_m": 0.15,
        "luminance_cd_m2": 900.0,
        "rgb": [0.6, 1.0, 0.9],
        "drawn": False,
    },
}


@cache
def _view() -> View:
    return camera_in(room(), WIDTH, HEIGHT)


@cache
def _seen() -> Surface:
    return surface.see(surface_of_mesh(room(), _view().position), _view())


def _captured_lamps() -> tuple[Lamp, ...]:
    """What the photograph was taken in: warm light at the ceiling, cool light from the left."""
    over = np.array([(-0.4, 0, -0.3), (0.4, 0, -0.3), (0.4, 0, 0.3), (-0.4, 0, 0.3)])
    beside = np.array([(0, -0.4, 0.3), (0, -0.4, -0.3), (0, 0.4, -0.3), (0, 0.4, 0.3)])
    warm, cool = np.array([460.0, 330, 200]), np.array([210.0, 280, 400])
    return (
        PolygonLamp("over", warm, over + np.array([-1.3, 2.9, 0.9]), drawn=False),
        PolygonLamp("beside", cool, beside + np.array([-2.45, 1.7, 0.2]), drawn=False),
    )


def _traced(
    lamps: tuple[Lamp, ...], which: NDArray[np.bool_], quality: Quality, bounces: int
) -> Float:
    """(n, 3) lux at the pixels `which` (H, W), of lamps with all their tiles in each bounce."""
    with TemporaryDirectory() as folder:
        bundle = radiance_bundle([room()], lamps, tiles=TILES)
        write_bundle(Path(folder), dict(bundle) | {BOUNCE_OCTREE: bundle[OCTREE]})
        seen = _seen()
        lux = traced_illuminance(
            Path(folder),
            seen.position[which],
            seen.normal[which],
            quality=quality,
            bounces=bounces,
        )
    return lux.astype(np.float64)


@cache
def _e0() -> Float:
    """(H, W, 3) lux: what this is called the photograph's light is, so it need not be exact."""
    lux = np.zeros((HEIGHT, WIDTH, 3))
    lux[_seen().valid] = _traced(_captured_lamps(), _seen().valid, QUALITIES["draft"], BOUNCES)
    return np.maximum(lux, 1e-3 * np.median(lux))


@cache
def asked_pixels() -> NDArray[np.bool_]:
    """(H, W) the pixels at which the truth is known."""
    places = np.flatnonzero(_seen().valid)
    chosen = np.random.default_rng(5).permutation(places)[:ASKED]
    which = np.zeros(HEIGHT * WIDTH, bool)
    which[chosen] = True
    return which.reshape(HEIGHT, WIDTH)


@cache
def _lamps(name: str) -> tuple[Lamp, ...]:
    scene = scene_from_dict({"lamp": [LAMPS[name] | {"name": name, "transport": "direct"}]})
    return resolve_lamps(scene, 0.0)


@cache
def added_lux(name: str, bounces: int) -> Float:
    """(n, 3) lux that one lamp truly adds to the pixels that are asked."""
    return _traced(_lamps(name), asked_pixels(), TRUTH, bounces)


def relit_lux(*, direct: frozenset[str] = frozenset()) -> Float:
    """(n, 3) ΔE in truth at the pixels that are asked; of the lamps `direct` no reflected light."""
    return sum((added_lux(name, 0 if name in direct else BOUNCES) for name in LAMPS), np.zeros(3))


def captured_parts() -> tuple[Float, Float]:
    """Reflectance and E0 in lx of the photograph, both (H, W, 3)."""
    return _seen().reflectance, _e0()


@cache
def _folder() -> TemporaryDirectory[str]:
    """Holds the scene's files and its maps, as long as this process lives."""
    folder = TemporaryDirectory(prefix="andon-verify-")
    path = Path(folder.name)
    _write_mesh(path, room())
    reflected = _seen().reflectance * _e0() / np.pi
    write_exr(path / "e0.exr", _e0().astype(np.float32), unit="lx", photometry="absolute")
    codes = np.asarray(SRGB.encode(np.clip(reflected / white_cd_m2(), 0, 1)), np.float64)
    write_png(path / "photo.png", np.asarray(codes * 255 + 0.5, np.uint8))
    bake_maps(_scene(path, frozenset()))
    return folder


@cache
def white_cd_m2() -> float:
    """The luminance at the end of the range, for both pictures: neither is clipped."""
    reflectance, which = _seen().reflectance, asked_pixels()
    relit = reflectance[which] * (DIMMING * _e0()[which] + relit_lux()) / np.pi
    captured = reflectance * _e0() / np.pi
    return MARGIN * max(float(captured.max()), float(relit.max()))


def _write_mesh(folder: Path, geometry: Geometry) -> None:
    """``room.obj`` and ``room.mtl``."""
    lines = [
        "mtllib room.mtl",
        *(f"v {x!r} {y!r} {z!r}" for x, y, z in geometry.positions.tolist()),
    ]
    ids = geometry.material_ids
    assert ids is not None
    for number in range(len(geometry.materials)):
        lines.append(f"usemtl m{number}")
        own = geometry.triangles[ids == number] + 1
        lines += [f"f {a} {b} {c}" for a, b, c in own.tolist()]
    (folder / "room.obj").write_text("\n".join([*lines, ""]), encoding="ascii")
    text = ""
    for number, material in enumerate(geometry.materials):
        red, green, blue = map(float, material.reflectance)
        text += f"newmtl m{number}\nKd {red!r} {green!r} {blue!r}\n"
    (folder / "room.mtl").write_text(text, encoding="ascii")


def _scene(folder: Path, direct: frozenset[str]) -> Scene:
    """The scene with maps of all four lamps; those of `direct` are not asked of them."""
    view = _view()
    camera = {
        "fx": view.fx,
        "width": WIDTH,
        "height": HEIGHT,
        "world_from_camera": view.world_from_camera.tolist(),
    }
    lamps = [
        table | {"name": name} | ({"transport": "direct"} if name in direct else {})
        for name, table in LAMPS.items()
    ]
    return scene_from_dict(
        {
            "rig": {"camera": camera},
            "capture": {"source": "photo.png", "luminance_per_unit": white_cd_m2()},
            "surface": {"mesh": "room.obj"},
            "ambient": {"map": "e0.exr", "dimming": DIMMING},
            "lamp": lamps,
            "baked": {
                "folder": "maps",
                "lamps": [name for name in LAMPS if name not in direct],
                "bounces": BOUNCES,
                "map_size_px": WIDTH,
                "most_cameras": 4,
            },
        },
        folder=folder,
        file="room",
    )


@cache
def baked_frame(engine: EngineName, *, direct: frozenset[str] = frozenset()) -> Frame:
    """The frame with its maps; the lamps `direct` give no reflected light."""
    return render(_scene(Path(_folder().name), direct), engine=engine)
