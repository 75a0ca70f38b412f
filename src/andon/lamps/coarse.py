"""Few triangles instead of many, for emitters: a shader walks through them for every pixel."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.lamps.solids import quarters

__all__ = ["coarse_corners", "triangle_areas"]

Float = NDArray[np.float64]

# The emitter keeps its flux; its area may shrink by this share before its place is wrong too.
AREA_LOSS = 0.2
# Where the wanted number of triangles loses more, up to this many times as many are tried.
MOST_TIMES = 4


def triangle_areas(corners: Float, /) -> Float:
    """Areas (n,) in m² of triangles (n, 3, 3)."""
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.linalg.norm(across, axis=1) / 2


def coarse_corners(positions: Float, triangles: NDArray[Any], most: int, /) -> Float:
    """About `most` triangles (n, 3, 3) that stand for a welded mesh; fewer ones are cut finer.

    Quadric edge collapse (Garland & Heckbert 1997), in which rims collapse along themselves only.
    Raises `InputError` if so few triangles cannot have nearly the mesh's area.
    """
    corners = positions[triangles]
    if len(corners) <= most:
        return _cut(corners, most)
    import fast_simplification

    simplify: Any = fast_simplification.simplify  # its annotations promise float64 only
    middle = positions.mean(axis=0)
    size = float(np.abs(positions - middle).max())
    whole = triangle_areas(corners).sum()
    count = most
    while count <= MOST_TIMES * most and count < len(corners):
        points, faces = simplify(
            np.ascontiguousarray((positions - middle) / size, np.float64),
            np.ascontiguousarray(triangles, np.int32),
            target_count=count,
        )
        fewer = np.asarray(points, np.float64)[np.asarray(faces)] * size + middle
        fewer = fewer[triangle_areas(fewer) > 0]
        if abs(triangle_areas(fewer).sum() / whole - 1) <= AREA_LOSS and len(fewer) <= 2 * count:
            return fewer
        count *= 2
    if len(corners) <= MOST_TIMES * most:
        return corners
    raise InputError(
        f"has {len(corners)} triangles that {MOST_TIMES * most} cannot stand for",
        field="mesh",
        remedy="leave out small parts, or give a coarser mesh",
    )


def _cut(corners: Float, most: int) -> Float:
    while 4 * len(corners) <= most:
        corners = quarters(corners)
    return corners
