"""The paper's scene of glass, and other bodies in the place of its ball."""

from __future__ import annotations

import os
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from andon.files.meshes import read_mesh
from andon.glass.model import Backdrop, Ball, Closed, LensShape, Slab, Solid
from andon.lamps.triangles import area_vectors
from andon.quantities import Geometry
from andon.spaces import View, look_at, pinhole_view
from andon.verify.registry import NotShown
from andon.verify.solids import lathe

__all__ = [
    "BACKDROP",
    "BETWEEN_EYES_M",
    "BODIES",
    "EYE_M",
    "FOCAL_PX",
    "HEIGHT",
    "PUPIL_M",
    "PX_M",
    "RADIUS_M",
    "WIDTH",
    "body",
    "drinking_glass",
    "eye_views",
    "goblet",
    "rays_of",
    "view_along",
]

Float = NDArray[np.float64]

INDEX = (1.51, 1.51, 1.51)
RADIUS_M = 0.075
EYE_M = np.array([0.0, 0.0, 0.4])
BETWEEN_EYES_M = 0.063
PUPIL_M = 0.006
# 40° over 1280 pixels: the ball is 671 px wide.
WIDTH, HEIGHT = 1280, 720
FOCAL_PX = WIDTH / 2 / float(np.tan(np.radians(20)))
BACKDROP = Backdrop(
    "texture",
    centre_m=np.array([0.0, 0.0, -0.2]),
    right_m=np.array([0.4, 0.0, 0.0]),
    up_m=np.array([0.0, 0.3, 0.0]),
)
# What a pixel covers of the backdrop where no glass is in between, metres.
PX_M = 0.6 / FOCAL_PX

BODIES = ("ball", "slab", "lens", "nested", "goblet")


@cache
def body(name: str, interfaces: int = 2) -> tuple[Solid, ...]:
    """Solids named in `BODIES`, around the origin, in front of the backdrop."""
    if name == "nested":  # a bubble in a ball of water in a ball of glass
        shells = ((RADIUS_M, 1.51, 0.0), (0.05, 1.33, 0.005), (0.02, 1.0, 0.015))
        return tuple(
            Solid(f"n = {n}", Ball(radius), _at(side, side, 0), (n, n, n), backdrop=BACKDROP)
            for radius, n, side in shells
        )
    shapes = {
        "ball": lambda: Ball(RADIUS_M),
        "slab": lambda: Slab(np.array([0.09, 0.06, 0.015])),
        "lens": lambda: LensShape(0.05, (0.12, 0.2), 0.03),
        "goblet": lambda: Closed(goblet()),
    }
    pose = _at(0, 0, 0) if name != "slab" else _turned(25.0)
    shape = shapes[name]()
    return (Solid(name, shape, pose, INDEX, interfaces=interfaces, backdrop=BACKDROP),)


def _at(x: float, y: float, z: float) -> Float:
    pose = np.eye(4)
    pose[:3, 3] = x, y, z
    return pose


def _turned(degrees: float) -> Float:
    """About y."""
    sine, cosine = np.sin(np.radians(degrees)), np.cos(np.radians(degrees))
    pose = np.eye(4)
    pose[0, 0], pose[0, 2], pose[2, 0], pose[2, 2] = cosine, sine, -sine, cosine
    return pose


@cache
def goblet(segments: int = 96, rings: int = 10) -> Geometry:
    """A drinking vessel of thick glass, turned: 0.14 m high, smooth normals, closed."""
    outer = [(0, 0), (32, 0), (33, 3), (12, 8), (7, 16), (7, 40), (14, 50), (32, 66), (40, 90)]
    inner = [(39, 126), (38, 140), (35, 140), (35.5, 126), (36, 90), (28, 69), (10, 60), (0, 58)]
    profile = np.array([*outer, *inner], np.float64) / 1000
    fine = _smoothed(profile, rings)
    solid = lathe(fine[:, 0], fine[:, 1] - 0.07, segments)
    corners = solid.positions[solid.triangles]
    normals = np.zeros_like(solid.positions)
    np.add.at(normals, solid.triangles, area_vectors(corners)[:, None])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return Geometry(solid.positions, solid.triangles, normals)


@cache
def drinking_glass() -> tuple[Solid, ...]:
    """The drinking glass of ``ANDON_DATA``, 0.2 m high, of 1,696 flat facets, closed.

    Raises `NotShown` where there is none.
    """
    folder = os.environ.get("ANDON_DATA")
    file = Path(folder or "") / "glass_and_lamp_ccby" / "glass" / "glass.obj"
    if folder is None or not file.is_file():
        raise NotShown("ANDON_DATA is not set: the folder that holds glass_and_lamp_ccby")
    read = read_mesh(file).geometry
    metres = read.positions / 100  # the file is in centimetres
    middle = (metres.min(axis=0) + metres.max(axis=0)) / 2
    shape = Closed(Geometry(metres - middle, read.triangles))
    return (Solid("drinking glass", shape, index=INDEX, backdrop=BACKDROP),)


def _smoothed(profile: Float, rings: int) -> Float:
    """(k, 2) points of Catmull and Rom's spline through `profile`; it ends on the axis."""
    padded = np.concatenate([profile[:1] * [-1, 1], profile, profile[-1:] * [-1, 1]])
    padded[0, 1], padded[-1, 1] = profile[1, 1], profile[-2, 1]
    padded[0, 0], padded[-1, 0] = -profile[1, 0], -profile[-2, 0]
    a, b, c, d = padded[:-3], padded[1:-2], padded[2:-1], padded[3:]
    t = np.linspace(0, 1, rings, endpoint=False)[:, None, None]
    points = 0.5 * (
        2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t**2 + (3 * b - a - 3 * c + d) * t**3
    )
    points = np.concatenate([points.swapaxes(0, 1).reshape(-1, 2), profile[-1:]])
    points[:, 0] = np.maximum(points[:, 0], 0)
    points[0, 0] = points[-1, 0] = 0
    return points


def eye_views() -> tuple[View, View]:
    """Left and right, in parallel."""
    views: list[View] = []
    for name, side in (("left", -BETWEEN_EYES_M / 2), ("right", BETWEEN_EYES_M / 2)):
        offset = np.array([side, 0, 0])
        pose = look_at(EYE_M + offset, offset)
        views.append(pinhole_view(WIDTH, HEIGHT, FOCAL_PX, pose, name=name))
    return views[0], views[1]


def view_along(direction: Float) -> View:
    """From the point between the eyes along `direction` (3,), which is in the picture's middle.

    An eye turns to what it looks at: its pupil is across the ray. Pixels are as large there as in
    the middle of the eyes' pictures.
    """
    pose = look_at(EYE_M, EYE_M + direction)
    return pinhole_view(WIDTH, HEIGHT, FOCAL_PX, pose)


def rays_of(view: View, step: int) -> tuple[Float, Float]:
    """Origins and unit directions (n, 3) of every `step`th pixel."""
    origin, directions = view.rays_world()
    chosen = directions[step // 2 :: step, step // 2 :: step].reshape(-1, 3)
    return np.broadcast_to(origin, chosen.shape), chosen
