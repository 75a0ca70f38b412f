"""Triangles as arrays: areas and normals, vertices that are one, edges that two share."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "WELD",
    "area_vectors",
    "connected",
    "shared_edges",
    "triangle_areas",
    "unit_normals",
    "welded",
]

Float = NDArray[np.float64]
Int = NDArray[np.int64]

# Vertices closer than this share of a mesh's size are one: the precision of float32 files.
WELD = 1e-6
# Grids in which neighbours are looked for. A pair that straddles a cell of one lies within a cell
# of another; the fractions are arbitrary and unlike one another.
GRID_OFFSETS = np.array([[0.137, 0.731, 0.419], [0.593, 0.211, 0.887], [0.859, 0.467, 0.043]])


def area_vectors(corners: Float, /) -> Float:
    """(n, 3) normals of triangles (n, 3, 3), as long as their areas in m²."""
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2


def triangle_areas(corners: Float, /) -> Float:
    """Areas (n,) in m² of triangles (n, 3, 3)."""
    return np.linalg.norm(area_vectors(corners), axis=1)


def unit_normals(corners: Float, /) -> Float:
    """(n, 3) unit normals of triangles (n, 3, 3); 0 of one without area."""
    across = area_vectors(corners)
    length = np.linalg.norm(across, axis=1, keepdims=True)
    return np.divide(across, length, out=np.zeros_like(across), where=length > 0)


def welded(positions: Float, tolerance: float, /) -> tuple[Float, Int]:
    """Distinct positions (k, 3) and the index (n,) of each given one among them.

    All that are linked by steps of at most `tolerance` metres in each axis are one: the first.
    """
    scale = 1 / max(2 * tolerance, np.finfo(float).tiny)
    with np.errstate(over="ignore"):
        cells = [np.floor(np.minimum(positions * scale, 2.0**52) + o) for o in GRID_OFFSETS]
    groups = [np.unique(cell, axis=0, return_inverse=True)[1].ravel() for cell in cells]
    label = np.arange(len(positions))
    while True:
        before = label
        for group in groups:
            lowest = np.full(group.max() + 1, len(positions))
            np.minimum.at(lowest, group, label)
            label = lowest[group]
        if (label == before).all():
            break
    kept, index = np.unique(label, return_inverse=True)
    return positions[kept], index.ravel()


def shared_edges(triangles: NDArray[np.integer[Any]], /) -> tuple[Int, Int]:
    """Edges (e, 2) between vertices of triangles (m, 3), and the triangles (e, 2) at them.

    The first one runs along the edge, the second one against it; −1 is none. An edge with more
    than two comes as often as it takes.
    """
    start, end = triangles.reshape(-1), np.roll(triangles, -1, axis=1).reshape(-1)
    owner = np.repeat(np.arange(len(triangles)), 3)
    forward = start < end
    count = int(triangles.max(initial=0)) + 1
    key = np.minimum(start, end).astype(np.int64) * count + np.maximum(start, end)
    turn = _turn(key, forward)
    # The n-th triangle along an edge and the n-th against it are neighbours.
    slots, at = np.unique(np.c_[key, turn], axis=0, return_inverse=True)
    sides = np.full((len(slots), 2), -1)
    sides[at.reshape(-1), np.where(forward, 0, 1)] = owner
    return np.stack(np.divmod(slots[:, 0], count), axis=1), sides


def _turn(key: Int, forward: NDArray[np.bool_]) -> Int:
    """How many triangles came before on the same side of the same edge."""
    both = 2 * key + forward
    order = np.argsort(both, kind="stable")
    ranked = both[order]
    first = np.r_[True, ranked[1:] != ranked[:-1]]
    begin = np.maximum.accumulate(np.where(first, np.arange(len(ranked)), 0))
    turn = np.empty(len(both), np.int64)
    turn[order] = np.arange(len(ranked)) - begin
    return turn


def connected(count: int, pairs: Int, /) -> Int:
    """Number of the connected part (count,) of each of `count` things, from 0; `pairs` (k, 2)."""
    label = np.arange(count)
    while len(pairs):
        lowest = label[pairs].min(axis=1)
        update = label.copy()
        np.minimum.at(update, label[pairs].ravel(), np.repeat(lowest, 2))
        update = update[update]  # halves the longest way to go
        if (update == label).all():
            break
        label = update
    return np.unique(label, return_inverse=True)[1].ravel()
