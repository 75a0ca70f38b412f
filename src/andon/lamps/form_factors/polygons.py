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

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from andon.lamps.form_factors.vectors import Float, dot, quotient
from andon.lamps.polygons import vector_area
from andon.lamps.triangles import area_vectors, shared_edges

__all__ = ["edge_factor", "edges_factor", "horizon_reference", "mesh_factor", "polygon_factor"]

# Pairs of receiver and edge that are worked on at once: at most about 200 MB of temporaries.
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
    triangles: NDArray[np.integer[Any]],
    facet_weights: ArrayLike | None = None,
    /,
) -> Float:
    """Sum of the factors of the triangles that face the receiver, in sr.

    (...) without weights or with `facet_weights` (m,), (..., 3) with (m, 3), all ≥ 0. Triangles
    run counter-clockwise outside and do not hide one another: exact for convex meshes.
    """
    place, up = np.broadcast_arrays(
        np.asarray(position, np.float64), np.asarray(normal, np.float64)
    )
    count = len(triangles)
    weights = np.ones(count) if facet_weights is None else np.asarray(facet_weights)
    mesh = _Mesh.of(np.asarray(positions, np.float64)[triangles], weights.reshape(count, -1))
    points, normals = place.reshape(-1, 3), up.reshape(-1, 3)
    total = np.empty((len(points), mesh.weights.shape[1]))
    flat = np.cross(normals, mesh.middle - points)
    beside = dot(flat, flat) > mesh.bound**2
    for who, factor in ((beside, mesh.by_edges), (~beside, mesh.by_facets)):
        which = np.flatnonzero(who)
        step = max(1, PAIRS // max(len(mesh.ends), 1))
        for start in range(0, len(which), step):
            part = which[start : start + step]
            total[part] = factor(points[part], normals[part])
    return total.reshape(*place.shape[:-1], *weights.shape[1:])


class _Mesh(NamedTuple):
    """A mesh with its edges, each with the facets along it and against it; −1: none, the last."""

    corners: Float
    weights: Float
    outward: Float
    places: Float
    ends: NDArray[np.int64]
    sides: NDArray[np.int64]
    middle: Float
    bound: float

    @staticmethod
    def of(corners: Float, weights: Float) -> _Mesh:
        """`corners` (m, 3, 3), `weights` (m, c)."""
        places, index = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
        middle = places.mean(axis=0)
        bound = float(np.linalg.norm(places - middle, axis=1).max())
        edges = shared_edges(index.reshape(-1, 3))
        return _Mesh(corners, weights, area_vectors(corners), places, *edges, middle, bound)

    def facing(self, points: Float) -> NDArray[np.bool_]:
        """(n, m) whether the outsides of the facets face `points` (n, 3)."""
        return points @ self.outward.T > dot(self.outward, self.corners[:, 0])

    def by_edges(self, points: Float, normals: Float) -> Float:
        """(n, c) for receivers beside the mesh: all facets have one `towards`.

        Edges between facets of one weight that both face the receiver cancel: of a convex mesh
        its outline is left.
        """
        front = np.pad(self.facing(points), ((0, 0), (0, 1)))
        weights = np.pad(self.weights, ((0, 1), (0, 0)))
        left, right = front[:, self.sides[:, 0]], front[:, self.sides[:, 1]]
        differ = (weights[self.sides[:, 0]] != weights[self.sides[:, 1]]).any(axis=1)
        height = normals @ self.places.T - dot(points, normals)[:, None]
        # Who is above is decided by `edge_factor`, for both edges at a vertex alike.
        above = height > -1e-9 * (np.abs(self.places).max() + np.abs(points).max())
        seen = (left != right) | (left & right & differ)
        seen &= above[:, self.ends[:, 0]] | above[:, self.ends[:, 1]]
        who, which = np.nonzero(seen)
        place = points[who]
        a, b = (self.places[self.ends[which, k]] - place for k in range(2))
        factor = edge_factor(a, b, normals[who], self.middle - place)
        share = left[who, which, None] * weights[self.sides[which, 0]]
        share -= right[who, which, None] * weights[self.sides[which, 1]]
        return np.maximum(_summed(who, factor[:, None] * share, len(points)), 0)

    def by_facets(self, points: Float, normals: Float) -> Float:
        """(n, c) for any receivers: each facet has a `towards` of its own."""
        heights = (normals @ self.corners.reshape(-1, 3).T).reshape(len(points), -1, 3)
        above = heights.max(axis=2) > dot(points, normals)[:, None]
        who, which = np.nonzero(self.facing(points) & above)
        corners = self.corners[which] - points[who, None]
        up, middle = normals[who], corners.mean(axis=1)
        bound = np.linalg.norm(corners - middle[:, None], axis=2).max(axis=1)
        towards = horizon_reference(middle, bound, -self.outward[which], up)
        factor = np.zeros(len(who))
        for k in range(3):
            factor += edge_factor(corners[:, k], corners[:, k - 2], up, towards)
        shares = np.maximum(factor, 0)[:, None] * self.weights[which]
        return _summed(who, shares, len(points))


def _summed(who: NDArray[np.intp], values: Float, count: int) -> Float:
    """(count, c) sums of the rows of `values` (k, c) of one number `who` (k,)."""
    sums = [np.bincount(who, column, minlength=count) for column in values.T]
    return np.stack(sums, axis=1, dtype=np.float64)


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
