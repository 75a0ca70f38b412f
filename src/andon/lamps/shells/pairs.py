"""Neighbouring facets of one plane get one luminance: the edge between them then costs nothing."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.lamps.triangles import shared_edges, unit_normals, welded

__all__ = ["evened", "flat_pairs"]

Float = NDArray[np.float64]

# Corners closer than this share of the shell are one; planes whose normals agree so well are one.
SAME_CORNER, SAME_PLANE = 1e-5, 1e-6


def flat_pairs(corners: Float, /) -> NDArray[np.int32]:
    """(n,) a number for each facet (n, 3, 3), shared by two that make a flat quadrilateral.

    Pairs share their longest edges first, as the halves of a rectangle do. From the form alone:
    what shines alike is then the same for every beam and at all times.
    """
    number = np.arange(len(corners), dtype=np.int32)
    paired = np.zeros(len(corners), bool)
    for first, second in _neighbours(corners):
        if not (paired[first] or paired[second]):
            paired[[first, second]] = True
            number[second] = first
    return number


def evened(luminance: Float, area: Float, number: NDArray[np.int32], /) -> Float:
    """(n, c) luminance, made one for facets of one `number` (n,) by their `area` (n,).

    Flux is kept.
    """
    share = area / np.bincount(number, area)[number]
    columns = [np.bincount(number, share * column)[number] for column in luminance.T]
    return np.stack(columns, axis=1, dtype=np.float64)


def _neighbours(corners: Float) -> list[tuple[int, int]]:
    """Pairs of coplanar facets with a common edge, the longest edge first."""
    points = corners.reshape(-1, 3)
    places, index = welded(points, SAME_CORNER * float(np.ptp(points, axis=0).max()))
    ends, sides = shared_edges(index.reshape(-1, 3))
    first, second = sides.min(axis=1), sides.max(axis=1)
    normal = unit_normals(corners)
    flat = np.einsum("ei,ei->e", normal[first], normal[second]) > 1 - SAME_PLANE
    length = np.linalg.norm(places[ends[:, 0]] - places[ends[:, 1]], axis=1)
    at = np.flatnonzero((first >= 0) & (first < second) & flat)
    order = np.lexsort((second[at], first[at], -length[at]))
    return [(int(a), int(b)) for a, b in np.stack([first, second], axis=1)[at[order]]]
