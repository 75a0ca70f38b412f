"""Polygons and meshes: a sum over edges, each cut at the horizon by itself.

Where an edge crosses the horizon, it adds half the azimuth of the crossing, with the sign of
leaving or entering: summed over a closed outline that is the closure along the horizon circle, and
no crossing need know of another. Azimuths count from a direction `towards` and jump by 2π opposite
to it, so the outline above must not pass there. What guarantees it:

* the direction to any point c, for a lamp inside the ball around c whose radius is the receiver's
  distance: on the horizon all of it lies less than 90° from c's azimuth;
* the direction to the foot of the perpendicular, for a flat lamp: the receiver's side of space
  that holds it is an open half.

`horizon_reference` takes the first where it holds, because azimuths are then as small as the lamp
and rounding with them, and the second otherwise.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from andon.lamps.form_factors.vectors import Float, dot, quotient
from andon.lamps.polygons import vector_area

__all__ = ["edge_factor", "edges_factor", "horizon_reference", "mesh_factor", "polygon_factor"]

# Pairs of receiver and triangle that are worked on at once: about 200 MB of temporaries.
PAIRS = 1 << 18


def edge_factor(a: Float, b: Float, normal: Float, towards: Float, /) -> Float:
    """Share (...) in sr of the edge from `a` to `b` in a polygon's factor.

    All (..., 3): `a`, `b` vertices as seen from the receiver, metres; `normal` unit; `towards`
    any length, see `horizon_reference`. The sum over a polygon that runs counter-clockwise as
    seen from the receiver is its factor, that over a clockwise one the negative of it. Source:
    Lambert 1760; Baum, Rushmeier & Winget 1989; the cut at the horizon is the module's.
    """
    edge = b - a
    height_a, height_b = dot(a, normal), dot(b, normal)
    above_a, above_b = height_a > 0, height_b > 0
    at = quotient(height_a, height_a - height_b)
    start, end = np.where(above_a, 0.0, at), np.where(above_b, 1.0, at)
    length = np.where(above_a | above_b, end - start, 0.0)
    cross = np.cross(edge, a)
    area = np.sqrt(dot(cross, cross))
    first, last = a + start[..., None] * edge, a + end[..., None] * edge
    angle = np.arctan2(area * length, dot(first, last))
    arc = angle * quotient(dot(cross, normal), area)
    # The crossing relative to `towards`, so that what is small stays exact.
    aside, crossing = np.cross(normal, towards), a + at[..., None] * edge
    ahead = np.cross(aside, normal)
    azimuth = np.arctan2(dot(aside, a - towards) + at * dot(aside, edge), dot(ahead, crossing))
    sign = above_a.astype(np.float64) - above_b
    return 0.5 * (arc + sign * azimuth)


def horizon_reference(centre: Float, bound: Float | float, plane: Float, normal: Float, /) -> Float:
    """A `towards` (..., 3) for `edge_factor` of a flat lamp.

    `centre` (..., 3) of a ball of radius `bound` that holds the lamp, as seen from the receiver;
    `plane` (..., 3) unit normal of the lamp's plane, away from the receiver.
    """
    flat = np.cross(normal, centre)
    outside = dot(flat, flat) > np.square(bound)
    return np.where(outside[..., None], centre, plane)


def polygon_factor(position: ArrayLike, normal: ArrayLike, vertices: ArrayLike, /) -> Float:
    """Projected solid angle (...) in sr of the front of a flat simple polygon.

    `vertices` (k, 3) run counter-clockwise as seen from the front; convex or not. 0 behind it
    and in its plane. A plane fitted by its vector area decides what is behind.
    """
    corners = np.asarray(vertices, np.float64)
    place, up = np.asarray(position, np.float64), np.asarray(normal, np.float64)
    towards, front = _flat_reference(corners, place, up)
    total = np.zeros(np.broadcast_shapes(place.shape, up.shape)[:-1])
    for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        total += edge_factor(a - place, b - place, up, towards)
    return np.where(front, np.clip(total, 0, np.pi), 0.0)


def _flat_reference(corners: Float, place: Float, up: Float) -> tuple[Float, NDArray[np.bool_]]:
    """`towards` for a flat polygon, and whether the receiver is in front of it."""
    middle = corners.mean(axis=0)
    front = vector_area(corners)
    front /= np.linalg.norm(front)
    centre = middle - place
    bound = float(np.linalg.norm(corners - middle, axis=1).max())
    return horizon_reference(centre, bound, -front, up), centre @ front < 0


def mesh_factor(
    position: ArrayLike,
    normal: ArrayLike,
    positions: ArrayLike,
    triangles: NDArray[np.integer],
    facet_weights: ArrayLike | None = None,
    /,
) -> Float:
    """Sum of the factors of the triangles that face the receiver, in sr.

    (...) without weights or with `facet_weights` (m,), (..., 3) with (m, 3). Triangles run
    counter-clockwise outside and do not hide one another: exact for convex meshes.
    """
    corners = np.asarray(positions, np.float64)[np.asarray(triangles)]
    place, up = np.broadcast_arrays(
        np.asarray(position, np.float64), np.asarray(normal, np.float64)
    )
    weights = np.ones(len(corners)) if facet_weights is None else np.asarray(facet_weights)
    columns = weights.reshape(len(corners), -1)
    total = np.empty((place.size // 3, columns.shape[1]))
    points, normals = place.reshape(-1, 3), up.reshape(-1, 3)
    step = max(1, PAIRS // max(len(corners), 1))
    for start in range(0, len(points), step):
        part = slice(start, start + step)
        total[part] = _facets(points[part], normals[part], corners, columns)
    return total.reshape(*place.shape[:-1], *weights.shape[1:])


def _facets(points: Float, normals: Float, corners: Float, columns: Float) -> Float:
    """(n, c) sums over the facets that face each of `points` (n, 3) and rise above its horizon."""
    outward = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    offset = dot(outward, corners[:, 0])
    highest = (normals @ corners.reshape(-1, 3).T).reshape(len(points), -1, 3).max(axis=2)
    seen = (points @ outward.T > offset) & (highest > dot(points, normals)[:, None])
    who, which = np.nonzero(seen)
    seen_corners = corners[which] - points[who, None]
    up, middle = normals[who], seen_corners.mean(axis=1)
    bound = np.linalg.norm(seen_corners - middle[:, None], axis=2).max(axis=1)
    towards = horizon_reference(middle, bound, -outward[which], up)
    factor = np.zeros(len(who))
    for k in range(3):
        factor += edge_factor(seen_corners[:, k], seen_corners[:, k - 2], up, towards)
    factor = np.maximum(factor, 0)
    sums = np.zeros((len(points), columns.shape[1]))
    np.add.at(sums, who, factor[:, None] * columns[which])
    return sums


def edges_factor(
    position: ArrayLike,
    normal: ArrayLike,
    vertices: ArrayLike,
    a: Float,
    b: Float,
    weight: Float,
    /,
) -> Float:
    """(..., c) in sr: Σ weight·edge over the edges of a weighted division of a flat polygon.

    `vertices` (k, 3) of the polygon as in `polygon_factor`, `a`, `b` (e, 3) and `weight` (e, c)
    of its cells' edges: (weight on the left) − (weight on the right) as seen from the front.
    0 behind it.
    """
    corners, up = np.asarray(vertices, np.float64), np.asarray(normal, np.float64)
    place = np.asarray(position, np.float64)
    towards, front = _flat_reference(corners, place, up)
    total = np.zeros((*np.broadcast_shapes(place.shape, up.shape)[:-1], weight.shape[1]))
    for start, end, share in zip(a, b, weight, strict=True):
        total += edge_factor(start - place, end - place, up, towards)[..., None] * share
    return np.where(front[..., None], np.maximum(total, 0), 0.0)
