"""The walk of `lookup_facets` for one point, compiled by Numba.

Instead of all facets around, it looks across the edge that the closest point is on, or around the
corner. `facets` and `edges` are those of `lookup_numba.Compiled`. They are passed on whole and read
by two subscripts: a row as an array of its own would be counted, with a lock, at each call.
"""

# Numba knows its arguments, and needs none of the annotations that a checker would ask for.
# pyright: basic
from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

from andon.transport.probes.lookup_facets import SAME_POINT, VISIBLE

__all__ = ["OPTIONS", "search_hull", "walk_hull"]

OPTIONS: dict[str, Any] = {"cache": True, "error_model": "numpy", "nogil": True}


@njit(**OPTIONS)
def _closest(facets, f, x, y, z):
    """As `lookup_facets.closest_weights`, of one facet `f`."""
    ax, ay, az = facets[f, 0], facets[f, 1], facets[f, 2]
    bx, by, bz = facets[f, 3] - ax, facets[f, 4] - ay, facets[f, 5] - az
    cx, cy, cz = facets[f, 6] - ax, facets[f, 7] - ay, facets[f, 8] - az
    x, y, z = x - ax, y - ay, z - az
    d1, d2 = bx * x + by * y + bz * z, cx * x + cy * y + cz * z
    if d1 <= 0 and d2 <= 0:
        return 1.0, 0.0, 0.0
    across = bx * cx + by * cy + bz * cz
    d3, d4 = d1 - (bx * bx + by * by + bz * bz), d2 - across
    if d3 >= 0 and d4 <= d3:
        return 0.0, 1.0, 0.0
    wc = facets[f, 15] * x + facets[f, 16] * y + facets[f, 17] * z
    if wc <= 0 and d1 >= 0 and d3 <= 0:
        return 1 - d1 / (d1 - d3), d1 / (d1 - d3), 0.0
    d5, d6 = d1 - across, d2 - (cx * cx + cy * cy + cz * cz)
    if d6 >= 0 and d5 <= d6:
        return 0.0, 0.0, 1.0
    wb = facets[f, 12] * x + facets[f, 13] * y + facets[f, 14] * z
    if wb <= 0 and d2 >= 0 and d6 <= 0:
        return 1 - d2 / (d2 - d6), 0.0, d2 / (d2 - d6)
    wa = 1 - wb - wc
    if wa <= 0 and d4 >= d3 and d5 >= d6:
        t = (d4 - d3) / ((d4 - d3) + (d5 - d6))
        return 0.0, 1 - t, t
    wa, wb, wc = min(max(wa, 0.0), 1.0), min(max(wb, 0.0), 1.0), min(max(wc, 0.0), 1.0)
    total = wa + wb + wc
    return wa / total, wb / total, wc / total


@njit(**OPTIONS)
def _at(facets, f, w):
    """The point of a facet with these weights."""
    a, b, c = w
    return (
        a * facets[f, 0] + b * facets[f, 3] + c * facets[f, 6],
        a * facets[f, 1] + b * facets[f, 4] + c * facets[f, 7],
        a * facets[f, 2] + b * facets[f, 5] + c * facets[f, 8],
    )


@njit(**OPTIONS)
def _gain(facets, f, has_back, at, extent, x, y, z):
    """How much the square of the distance falls from `at` to the closest point of a facet."""
    ax, ay, az = x - facets[f, 0], y - facets[f, 1], z - facets[f, 2]
    height = facets[f, 9] * ax + facets[f, 10] * ay + facets[f, 11] * az
    if has_back and height < VISIBLE * (np.sqrt(ax * ax + ay * ay + az * az) + extent):
        return 0.0
    c = _at(facets, f, _closest(facets, f, x, y, z))
    mx, my, mz = c[0] - at[0], c[1] - at[1], c[2] - at[2]
    if mx * mx + my * my + mz * mz <= (SAME_POINT * extent) ** 2:
        return 0.0
    along = mx * (x - at[0] + (x - c[0]))
    return along + my * (y - at[1] + (y - c[1])) + mz * (z - at[2] + (z - c[2]))


@njit(**OPTIONS)
def _best_around(facets, edges, facet, corner, at, extent, x, y, z):
    """Of the facets around a corner, the one with the largest gain; −1: none gains."""
    best, most, probe = -1, 0.0, edges[facet, corner]
    has_back = edges[facet, 6] >= 0
    for turn in (1, 2):
        here, k = facet, corner
        for _ in range(len(facets)):
            here = edges[here, 3 + (k + turn) % 3]
            if here < 0 or here == facet:
                break
            k = 0
            while k < 2 and edges[here, k] != probe:
                k += 1
            gain = _gain(facets, here, has_back, at, extent, x, y, z)
            if gain > most:
                best, most = here, gain
        if here == facet:
            break
    return best


@njit(**OPTIONS)
def walk_hull(facets, edges, extent, facet, x, y, z):
    """The facet with the point closest to (x, y, z), and the three weights there."""
    w = _closest(facets, facet, x, y, z)
    has_back = edges[facet, 6] >= 0
    for _ in range(len(facets)):
        zeros = int(w[0] == 0) + int(w[1] == 0) + int(w[2] == 0)
        if zeros == 0:
            break
        at = _at(facets, facet, w)
        if zeros == 1:
            edge = 0 if w[0] == 0 else (1 if w[1] == 0 else 2)
            other = edges[facet, 3 + edge]
            if other >= 0 and _gain(facets, other, has_back, at, extent, x, y, z) <= 0:
                other = -1
        else:
            corner = 0 if w[0] != 0 else (1 if w[1] != 0 else 2)
            other = _best_around(facets, edges, facet, corner, at, extent, x, y, z)
        if other < 0:
            break
        facet, w = other, _closest(facets, other, x, y, z)
    return facet, w


@njit(**OPTIONS)
def search_hull(facets, first, count, x, y, z):
    """Of `count` facets from `first` on, the one closest to a point."""
    found, best = first, np.inf
    for facet in range(first, first + count):
        c = _at(facets, facet, _closest(facets, facet, x, y, z))
        square = (c[0] - x) ** 2 + (c[1] - y) ** 2 + (c[2] - z) ** 2
        if square < best:
            found, best = facet, square
    return found
