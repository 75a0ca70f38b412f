"""Distance from points to the nearest of many triangles: exact, and without rays.

A tree of boxes over the triangles, halved at the median of their longest side, so that it is
complete and lies in plain arrays: node k of a level has the children 2k and 2k + 1 of the next.
All points walk it together, level by level:

::

    1. down to a few leaves, always into the nearest boxes: what the answer cannot exceed
    2. once more through every box that is nearer than that; its triangles are measured

4096 points and 30,000 triangles take about 0.2 s, and no library that is not needed anyway.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.quantities import Geometry

__all__ = ["nearest_distance"]

Float = NDArray[np.float64]
Int = NDArray[np.int64]

# Leaves that the first walk ends in: fewer guess worse, so that the second walk meets more boxes.
GUESSES = 8
# Points that walk together: bounds the pairs of point and box, some dozens a point.
POINTS_PER_WALK = 1024


def nearest_distance(points: Float, geometry: Geometry, /) -> Float:
    """(n,) metres from `points` (n, 3) to the triangles; inf where there are none."""
    if len(geometry.triangles) == 0 or len(points) == 0:
        return np.full(len(points), np.inf)
    tree = _tree(geometry.positions[geometry.triangles])
    starts = range(0, len(points), POINTS_PER_WALK)
    return np.concatenate([_walk(points[i : i + POINTS_PER_WALK], tree) for i in starts])


@dataclass(frozen=True)
class _Tree:
    """`corners` (3, 3, leaves): a, b, c by x, y, z; `boxes` of each level: (nodes, 2, 3)."""

    corners: Float
    boxes: list[Float]


def _tree(corners: Float) -> _Tree:
    levels = max(0, int(np.ceil(np.log2(len(corners)))))
    # The last triangle stands in for those that a complete tree lacks.
    order = np.minimum(np.arange(1 << levels), len(corners) - 1)
    middle = corners.mean(axis=1)
    for level in range(levels):
        parts = middle[order].reshape(1 << level, -1, 3)
        longest = np.ptp(parts, axis=1).argmax(axis=1)
        along = np.take_along_axis(parts, longest[:, None, None], axis=2)[..., 0]
        within = np.argsort(along, axis=1, kind="stable")
        order = np.take_along_axis(order.reshape(1 << level, -1), within, axis=1).ravel()
    leaves = corners[order]
    boxes = [np.stack([leaves.min(axis=1), leaves.max(axis=1)], axis=1)]
    while len(boxes[0]) > 1:
        low, high = (boxes[0].reshape(-1, 2, 2, 3)[:, :, side] for side in range(2))
        boxes.insert(0, np.stack([low.min(axis=1), high.max(axis=1)], axis=1))
    return _Tree(np.ascontiguousarray(leaves.transpose(1, 2, 0)), boxes)


def _walk(points: Float, tree: _Tree) -> Float:
    squared = _first_guess(points, tree)
    point, node = np.arange(len(points)), np.zeros(len(points), np.int64)
    for boxes in tree.boxes[1:]:
        point, node = np.repeat(point, 2), np.stack([2 * node, 2 * node + 1], axis=1).ravel()
        near = _box_distance(points[point], boxes[node]) < squared[point]
        point, node = point[near], node[near]
    np.minimum.at(squared, point, _triangle_distance(points[point], tree.corners[..., node]))
    return np.sqrt(squared)


def _first_guess(points: Float, tree: _Tree) -> Float:
    """(n,) squared distance from the best of the leaves that the nearest boxes lead to."""
    node = np.zeros((len(points), 1), np.int64)
    for boxes in tree.boxes[1:]:
        node = np.concatenate([2 * node, 2 * node + 1], axis=1)
        if node.shape[1] > GUESSES:
            far = _box_distance(points[:, None], boxes[node])
            best = np.argpartition(far, GUESSES, axis=1)[:, :GUESSES]
            node = np.take_along_axis(node, best, axis=1)
    each = np.repeat(points, node.shape[1], axis=0)
    found = _triangle_distance(each, tree.corners[..., node.ravel()])
    return found.reshape(node.shape).min(axis=1)


def _box_distance(points: Float, boxes: Float) -> Float:
    """(...) squared distance of points (..., 3) from boxes (..., 2, 3)."""
    outside = np.maximum(np.maximum(boxes[..., 0, :] - points, points - boxes[..., 1, :]), 0)
    return _dot(np.moveaxis(outside, -1, 0), np.moveaxis(outside, -1, 0))


def _triangle_distance(points: Float, corners: Float) -> Float:
    """(n,) squared distance of each point (n, 3) from its triangle (3, 3, n).

    The plane's where all three edges have the point on their inner side, else the nearest edge's.
    """
    a, b, c = corners
    normal = _cross(b - a, c - a)
    size = _dot(normal, normal)
    over = size > 0  # a degenerate triangle is its edges
    rim = np.full(len(points), np.inf)
    for start, end in ((a, b), (b, c), (c, a)):
        edge, reach = end - start, points.T - start
        length, dot = _dot(edge, edge), _dot(reach, edge)
        along = np.clip(np.divide(dot, length, out=np.zeros_like(dot), where=length > 0), 0, 1)
        off = reach - along * edge
        rim = np.minimum(rim, _dot(off, off))
        over &= _dot(_cross(edge, reach), normal) >= 0
    height = _dot(points.T - a, normal)
    return np.divide(height**2, size, out=rim, where=over)


def _dot(a: NDArray[Any], b: NDArray[Any]) -> Float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _cross(a: Float, b: Float) -> Float:
    rows = [a[i - 2] * b[i - 1] - a[i - 1] * b[i - 2] for i in range(3)]
    return np.stack(rows)
