"""The closest point of the hull, in NumPy: all points walk over facets at once.

The projection onto a convex set is unique and moves no farther than the point itself does, so
light beyond the hull is continuous, and constant along the normals of the hull. Of a zone without
volume the same walk over all its facets finds the light everywhere.

From the facet through which the walk in tetrahedra has left, it goes to the facet among those
around it whose closest point is nearest, while that is nearer. Where no facet that shares the
closest point has a nearer one, the point lies in the normal cone there, and no other facet of a
convex hull has one. Facets are only entered that the point lies in front of: seen from behind, the
middle of a facet can be closest of all around it, and yet not of the hull.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from andon.transport.probes.space import ProbeSpace

__all__ = ["SAME_POINT", "VISIBLE", "closest_weights", "search_facets", "walk_facets"]

Float = NDArray[np.float64]
Int = NDArray[np.int32]
Bool = NDArray[np.bool_]

# Share of a zone's extent within which two closest points are one.
SAME_POINT = 1e-13
# A point is in front of a facet down to this share of its distance and of the extent behind it.
VISIBLE = -1e-12
# Points that walk together; each looks at a dozen facets at once.
CHUNK = 1 << 15


def closest_weights(space: ProbeSpace, points: Float, facets: Int, /) -> Float:
    """(q, 3) weights, ≥ 0, of the corners of facets (q,) at their points closest to (q, 3).

    Ericson 2004, section 5.1.5, but with precomputed gradients for the coordinates inside: his
    products of products lose their digits far away. Also of pieces (a, b, b) and points (a, a, a),
    whose gradients are zero.
    """
    a, b, c = (space.positions[space.facets[facets, i]] for i in range(3))
    ab, ac, ap = b - a, c - a, points - a
    dot = "qi,qi->q"
    d1, d2 = np.einsum(dot, ab, ap), np.einsum(dot, ac, ap)
    square, across = np.einsum(dot, ab, ab), np.einsum(dot, ab, ac)
    d3, d4 = d1 - square, d2 - across
    d5, d6 = d1 - across, d2 - np.einsum(dot, ac, ac)
    wb, wc = np.einsum("qki,qi->kq", space.facet_gradients[facets], ap)
    wa = 1 - wb - wc
    zero, one = np.zeros(len(points)), np.ones(len(points))
    with np.errstate(divide="ignore", invalid="ignore"):
        on_ab, on_ac = d1 / (d1 - d3), d2 / (d2 - d6)
        on_bc = (d4 - d3) / ((d4 - d3) + (d5 - d6))
    cases = [
        ((d1 <= 0) & (d2 <= 0), (one, zero, zero)),
        ((d3 >= 0) & (d4 <= d3), (zero, one, zero)),
        ((wc <= 0) & (d1 >= 0) & (d3 <= 0), (1 - on_ab, on_ab, zero)),
        ((d6 >= 0) & (d5 <= d6), (zero, zero, one)),
        ((wb <= 0) & (d2 >= 0) & (d6 <= 0), (1 - on_ac, zero, on_ac)),
        ((wa <= 0) & (d4 >= d3) & (d5 >= d6), (zero, 1 - on_bc, on_bc)),
    ]
    conditions = [condition for condition, _ in cases]
    weights = np.column_stack(
        [np.select(conditions, [w[i] for _, w in cases], (wa, wb, wc)[i]) for i in range(3)]
    )
    weights = np.clip(weights, 0.0, 1.0)
    return weights / weights.sum(axis=1, keepdims=True)


def _on_facets(space: ProbeSpace, facets: Int, weights: Float) -> Float:
    return np.einsum("qk,qki->qi", weights, space.positions[space.facets[facets]])


def _in_front(space: ProbeSpace, points: Float, facets: Int) -> Bool:
    """(q,) whether the points lie in front of the facets; of a zone without volume, always."""
    away = points - space.positions[space.facets[facets, 0]]
    height = np.einsum("qi,qi->q", away, space.facet_normals[facets])
    near = np.linalg.norm(away, axis=1) + space.zone_extents[space.facet_zones[facets]]
    return (height >= VISIBLE * near) | (space.facet_cells[facets] < 0)


def walk_facets(space: ProbeSpace, points: Float, start: Int, /) -> tuple[Int, Float]:
    """The facet (q,) with the point closest to each of (q, 3), and (q, 3) weights there."""
    facets = np.array(start, np.int32)
    weights = np.zeros((len(facets), 3))
    for first in range(0, len(facets), CHUNK):
        part = slice(first, first + CHUNK)
        facets[part], weights[part] = _walk(space, points[part], facets[part])
    return facets, weights


def _walk(space: ProbeSpace, points: Float, facets: Int) -> tuple[Int, Float]:
    weights = closest_weights(space, points, facets)
    at = _on_facets(space, facets, weights)
    # In the middle of a facet in front of the point nothing is left to be found.
    walking = np.flatnonzero((weights == 0).any(axis=1) | ~_in_front(space, points, facets))
    for _ in range(len(space.facets) + 1):
        if not len(walking):
            break
        owner, around = _rings(space, facets[walking])
        who = walking[owner]
        other = closest_weights(space, points[who], around)
        there = _on_facets(space, around, other)
        moved = there - at[who]
        gain = np.einsum("ei,ei->e", moved, (points[who] - at[who]) + (points[who] - there))
        same = SAME_POINT * space.zone_extents[space.facet_zones[around]]
        real = (gain > 0) & (np.einsum("ei,ei->e", moved, moved) > same**2)
        gain = np.where(real & _in_front(space, points[who], around), gain, 0.0)
        # The last of each owner's in rising order of gain is its best.
        order = np.lexsort([gain, owner])
        best = order[np.flatnonzero(np.diff(owner[order], append=-1))]
        best = best[gain[best] > 0]
        walking = who[best]
        facets[walking], weights[walking], at[walking] = around[best], other[best], there[best]
    return facets, weights


def _rings(space: ProbeSpace, facets: Int) -> tuple[NDArray[np.intp], Int]:
    """All facets that touch each of `facets` (q,): (e,) whose, rising, and (e,) which."""
    first, members = space.facet_rings
    counts = (first[1:] - first[:-1])[facets]
    owner = np.repeat(np.arange(len(facets)), counts)
    within = np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)
    return owner, members[first[facets][owner] + within]


def search_facets(space: ProbeSpace, points: Float, first: int, count: int, /) -> Int:
    """(q,) among `count` facets from `first` on, the one closest to each point (q, 3)."""
    every = np.arange(first, first + count, dtype=np.int32)
    found = np.zeros(len(points), np.int32)
    for number, point in enumerate(points):
        here = np.broadcast_to(point, (count, 3))
        weights = closest_weights(space, here, every)
        away = _on_facets(space, every, weights) - here
        found[number] = every[np.einsum("fi,fi->f", away, away).argmin()]
    return found
