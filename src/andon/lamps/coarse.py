"""Few triangles instead of many, for emitters: a shader walks through them for every pixel."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.lamps.solids import quarters
from andon.lamps.triangles import triangle_areas

__all__ = ["coarse_corners"]

Float = NDArray[np.float64]

# The emitter keeps its flux; its area may shrink by this share before its place is wrong too.
AREA_LOSS = 0.2
# Where the wanted number of triangles loses more, up to this many times as many are tried.
MOST_TIMES = 4
# Edge collapse does not always get below its target.
BUDGET_SLACK = 1.1
FINEST_GRID = 24


def coarse_corners(positions: Float, triangles: NDArray[Any], most: int, /) -> Float:
    """About `most` triangles (n, 3, 3) that stand for a welded mesh; fewer ones are cut finer.

    Quadric edge collapse (Garland & Heckbert 1997), in which rims collapse along themselves only;
    where it stops early, as on long slivers, vertices are joined in the cells of a grid.
    Raises `InputError` if few triangles cannot have nearly the mesh's area.
    """
    corners = positions[triangles]
    if len(corners) <= most:
        return _cut(corners, most)
    middle = positions.mean(axis=0)
    size = float(np.abs(positions[triangles] - middle).max())
    unit = (positions - middle) / size
    whole = triangle_areas(unit[triangles]).sum()
    budgets = [times * most for times in (1, 2, MOST_TIMES)]
    for budget in budgets:
        for simplify in (_collapsed, _joined):
            fewer = simplify(unit, triangles, budget)
            loss = abs(triangle_areas(fewer).sum() / whole - 1)
            if loss <= AREA_LOSS and len(fewer) <= BUDGET_SLACK * budget:
                return fewer * size + middle
    if len(corners) <= budgets[-1]:
        return corners
    raise InputError(
        f"has {len(corners)} triangles that {budgets[-1]} cannot stand for",
        field="mesh",
        remedy="leave out small parts, or give a coarser mesh",
    )


def _collapsed(positions: Float, triangles: NDArray[Any], most: int) -> Float:
    import fast_simplification

    simplify: Any = fast_simplification.simplify  # its annotations promise float64 only
    points, faces = simplify(
        np.ascontiguousarray(positions, np.float64),
        np.ascontiguousarray(triangles, np.int32),
        target_count=min(most, len(triangles)),
    )
    corners: Float = np.asarray(points, np.float64)[np.asarray(faces)]
    return corners[triangle_areas(corners) > 0]


def _joined(positions: Float, triangles: NDArray[Any], most: int) -> Float:
    """Vertices in one cell of a grid become their mean; the finest grid that is coarse enough."""
    corners = np.empty((0, 3, 3))
    for cells in range(2, FINEST_GRID):
        place = np.floor((positions + 1.001) / 2.002 * cells).astype(np.int64)
        _, group = np.unique(place, axis=0, return_inverse=True)
        group = group.ravel()
        count = np.bincount(group)
        means = [np.bincount(group, positions[:, axis]) / count for axis in range(3)]
        faces = group[triangles]
        distinct = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
        _, first = np.unique(np.sort(faces, axis=1), axis=0, return_index=True)
        faces = faces[np.intersect1d(np.flatnonzero(distinct), first)]
        if len(faces) > most:
            break
        corners = np.stack(means, axis=1)[faces]
    return corners[triangle_areas(corners) > 0]


def _cut(corners: Float, most: int) -> Float:
    while 4 * len(corners) <= most:
        corners = quarters(corners)
    return corners
