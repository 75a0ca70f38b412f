"""A camera that sees nothing is refused before Radiance is started for it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.quantities import Geometry
from andon.rays import RayScene
from andon.spaces import View

__all__ = ["check_view_sees"]

Float = NDArray[np.float64]

# Pixels along the longer side of the first look; if it is in vain every pixel is looked through.
FIRST_LOOK_PX = 64
ROWS_AT_ONCE = 1 << 20


def check_view_sees(geometry: Geometry, view: View, name: str, /) -> None:
    """Raises `InputError` where no pixel of `view` shows the surface; `name` is its field."""
    view = view.undistorted()
    rays = RayScene(geometry)
    factor = min(1.0, FIRST_LOOK_PX / max(view.shape))
    sparse = view.resized(*(max(1, round(side * factor)) for side in (view.width, view.height)))
    if _sees(rays, sparse) or (factor < 1 and _sees(rays, view)):
        return
    raise InputError(
        f"is a camera that sees nothing: it stands at {_place(view.position)} m, looks along "
        f"{_place(view.world_from_camera[:3, 2])}, and {_where(geometry, view)}",
        field=name,
        remedy="turn it towards the surface (look_at), or leave baked.camera out: cameras are "
        "found then",
    )


def _sees(rays: RayScene, view: View) -> bool:
    step = max(1, ROWS_AT_ONCE // view.width)
    for first in range(0, view.height, step):
        rows = np.arange(first, min(first + step, view.height))
        pixels = np.stack(np.meshgrid(np.arange(view.width), rows), axis=-1).reshape(-1, 2)
        directions = view.directions_at(pixels) @ view.world_from_camera[:3, :3].T
        hits = rays.first_hits(np.broadcast_to(view.position, directions.shape), directions)
        if (hits.triangle >= 0).any():
            return True
    return False


def _where(geometry: Geometry, view: View) -> str:
    """Where the surface is, as a half-sentence."""
    if len(geometry.triangles) == 0:
        return "there is no surface"
    points = geometry.positions[geometry.triangles.ravel()]
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    return f"the middle of the surface is at {_place(middle)} m"


def _place(numbers: Float) -> str:
    return "[" + ", ".join(f"{number:.3g}" for number in numbers + 0.0) + "]"
