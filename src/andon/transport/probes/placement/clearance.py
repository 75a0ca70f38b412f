"""How near points are to surfaces, and where they lie clear of them: exact, without rays.

Rays miss the surface that their origin lies on, and what lies between two of them. A probe on a
wall sees half of its sphere in that wall; a cell with a corner there shows it as an arc of dark.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.quantities import Geometry

__all__ = ["Near", "clear_of", "nearest_within", "off_surfaces"]

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]

# Points that are compared with the triangles around their common box, and pairs held at once.
BATCH = 256
PAIRS = 1 << 18
# From one wall to the next: a corner of three takes three.
STEPS = 12
# A point counts as clear within this share of the margin: glTF stores float32.
SLACK = 1e-5
# Nearer than this share of the margin is on the surface: off its front is the way.
ON = 1e-4


@dataclass(frozen=True, eq=False)
class Near:
    """The nearest surface of n points.

    Attributes
    ----------
    distance_m : (n,) inf where none is within reach.
    points : (n, 3) on it, metres; the point itself where none is.
    normals : (n, 3) unit, of its front; 0 where there is none.
    """

    distance_m: Float
    points: Float
    normals: Float


def nearest_within(points: Float, geometry: Geometry, reach_m: float, /) -> Near:
    """The nearest of the triangles within `reach_m` of each of `points` (n, 3)."""
    near = Near(np.full(len(points), np.inf), points.copy(), np.zeros_like(points))
    if len(geometry.triangles) == 0 or len(points) == 0:
        return near
    corners = geometry.positions[geometry.triangles]
    low, high = corners.min(axis=1) - reach_m, corners.max(axis=1) + reach_m
    order = _neighbourly(points)
    for start in range(0, len(order), BATCH):
        batch = order[start : start + BATCH]
        own = points[batch]
        around = np.flatnonzero(((low <= own.max(axis=0)) & (high >= own.min(axis=0))).all(axis=1))
        step = max(1, PAIRS // len(own))
        for first in range(0, len(around), step):
            some = around[first : first + step]
            inside = ((own[:, None] >= low[some]) & (own[:, None] <= high[some])).all(axis=2)
            point, triangle = np.nonzero(inside)
            _keep_nearest(near, batch[point], points, corners[some[triangle]], reach_m)
    return near


def _neighbourly(points: Float) -> NDArray[np.int64]:
    """An order in which points that follow each other lie near each other."""
    low, size = points.min(axis=0), np.ptp(points, axis=0).max()
    cells = np.floor((points - low) / max(size, 1e-300) * 15.99).astype(np.int64)
    return np.lexsort((cells[:, 2], cells[:, 1], cells[:, 0]))


def _keep_nearest(
    near: Near, numbers: NDArray[np.int64], points: Float, corners: Float, reach_m: float
) -> None:
    """Takes what is nearer than before of pairs (k,) of points and triangles (k, 3, 3)."""
    found = _on_triangles(points[numbers], corners)
    distance = np.linalg.norm(points[numbers] - found, axis=1)
    order = np.lexsort((distance, numbers))
    first = order[np.unique(numbers[order], return_index=True)[1]]
    better = first[
        (distance[first] < near.distance_m[numbers[first]]) & (distance[first] <= reach_m)
    ]
    which = numbers[better]
    near.distance_m[which], near.points[which] = distance[better], found[better]
    a, b, c = np.moveaxis(corners[better], 1, 0)
    normals = np.cross(b - a, c - a)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    near.normals[which] = np.divide(normals, length, out=np.zeros_like(normals), where=length > 0)


def _on_triangles(points: Float, corners: Float) -> Float:
    """(k, 3) the points of triangles (k, 3, 3) that are nearest to points (k, 3).

    In the plane where all three edges have the point on their inner side, else on an edge.
    """
    a, b, c = np.moveaxis(corners, 1, 0)
    normal = np.cross(b - a, c - a)
    size = np.einsum("ij,ij->i", normal, normal)
    over = size > 0  # a degenerate triangle is its edges
    best, least = a.copy(), np.full(len(points), np.inf)
    for start, end in ((a, b), (b, c), (c, a)):
        edge, reach = end - start, points - start
        length = np.einsum("ij,ij->i", edge, edge)
        dot = np.einsum("ij,ij->i", reach, edge)
        along = np.clip(np.divide(dot, length, out=np.zeros_like(dot), where=length > 0), 0, 1)
        place = start + along[:, None] * edge
        squared = np.einsum("ij,ij->i", points - place, points - place)
        nearer = squared < least
        best[nearer], least[nearer] = place[nearer], squared[nearer]
        over &= np.einsum("ij,ij->i", np.cross(edge, reach), normal) >= 0
    height = np.einsum("ij,ij->i", points - a, normal)
    share = np.divide(height, size, out=np.zeros_like(height), where=over)
    best[over] = (points - share[:, None] * normal)[over]
    return best


def off_surfaces(geometry: Geometry, points: Float, margin_m: float, /) -> Float:
    """Points (n, 3), those that lie on a surface `margin_m` off its front.

    What they see tells nothing: half of their rays begin inside the wall.
    """
    places = points.copy()
    near = nearest_within(points, geometry, ON * margin_m)
    on = np.isfinite(near.distance_m)
    places[on] = near.points[on] + margin_m * near.normals[on]
    return places


def clear_of(geometry: Geometry, points: Float, margin_m: float, /) -> tuple[Float, Bool]:
    """Points (n, 3) moved away from what is nearer than `margin_m`, and which are clear (n,).

    Straight away from the nearest surface, in several steps where walls meet; off its front where
    the point lies on it. Where surfaces are nearer to each other than twice the margin there is
    no such place.
    """
    places = points.copy()
    clear = np.ones(len(points), np.bool_)
    if margin_m <= 0:
        return places, clear
    open_ones = np.arange(len(points))
    for step in range(STEPS):
        near = nearest_within(places[open_ones], geometry, margin_m)
        tight = near.distance_m < margin_m * (1 - SLACK)
        clear[open_ones] = ~tight
        open_ones = open_ones[tight]
        if len(open_ones) == 0 or step == STEPS - 1:
            break
        distance = near.distance_m[tight, None]
        away = np.divide(
            places[open_ones] - near.points[tight],
            distance,
            out=near.normals[tight],
            where=distance > ON * margin_m,
        )
        places[open_ones] = near.points[tight] + margin_m * away
    return places, clear
