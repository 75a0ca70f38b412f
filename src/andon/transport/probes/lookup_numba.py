"""The lookup of `locate`, one point after the other, compiled: for millions of points.

Each thread takes a run of points and begins at the cell of the last one while they stay near,
else where the grid says. Numba is imported with this module and by nobody else.
"""

# Numba knows its arguments, and needs none of the annotations that a checker would ask for.
# pyright: basic
from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit, prange
from numpy.typing import NDArray

from andon.transport.probes.locate import FAR, SEARCH_INSIDE
from andon.transport.probes.lookup import INSIDE, step_limit
from andon.transport.probes.lookup_facets import SAME_POINT, VISIBLE
from andon.transport.probes.space import ProbeSpace

__all__ = ["Compiled", "compiled", "locate_all", "lookup_all"]

# Points of a run: enough to be near each other, few enough to go round.
RUN = 1024
# Share of the extent by which a point is surely in front of a hull's facet.
CLEARLY = 1e-6
OPTIONS: dict[str, Any] = {"cache": True, "error_model": "numpy", "nogil": True}


class Compiled(NamedTuple):
    """Arrays of a `ProbeSpace`, packed so that what is read together lies together.

    `cells`: (m, 12) rows of the inverse, then the origin; `links`: (m, 8) neighbours, corners.
    """

    positions: NDArray[np.float64]
    cells: NDArray[np.float64]
    links: NDArray[np.int32]
    facets: NDArray[np.int32]
    facet_neighbours: NDArray[np.int32]
    facet_cells: NDArray[np.int32]
    facet_normals: NDArray[np.float64]
    facet_gradients: NDArray[np.float64]
    zone_cells: NDArray[np.int32]
    zone_facets: NDArray[np.int32]
    zone_middles: NDArray[np.float64]
    zone_extents: NDArray[np.float64]
    boxes: NDArray[np.float64]
    box_zones: NDArray[np.int32]
    grid_origins: NDArray[np.float64]
    grid_steps: NDArray[np.float64]
    grid_shapes: NDArray[np.int32]
    grid_firsts: NDArray[np.int32]
    grid_starts: NDArray[np.int32]
    limits: NDArray[np.int64]


def compiled(space: ProbeSpace, /) -> Compiled:
    """The arrays of `space`, contiguous."""
    cells = np.column_stack([space.inverses.reshape(-1, 9), space.origins])
    links = np.column_stack([space.neighbours, space.corners])
    limits = np.array([step_limit(int(count)) for count in space.zone_cells[:, 1]], np.int64)
    own = [getattr(space, name) for name in Compiled._fields if hasattr(space, name)]
    return Compiled(*(np.ascontiguousarray(a) for a in (own[0], cells, links, *own[1:], limits)))


@njit(**OPTIONS)
def _zone_of(s, x, y, z):
    if len(s.boxes) == 1:
        return s.box_zones[0]
    best, least = 0, np.inf
    for b in range(len(s.boxes)):
        dx = max(s.boxes[b, 0, 0] - x, x - s.boxes[b, 1, 0], 0.0)
        dy = max(s.boxes[b, 0, 1] - y, y - s.boxes[b, 1, 1], 0.0)
        dz = max(s.boxes[b, 0, 2] - z, z - s.boxes[b, 1, 2], 0.0)
        square = dx * dx + dy * dy + dz * dz
        if square < least:
            best, least = b, square
    return s.box_zones[best]


@njit(**OPTIONS)
def _drawn_near(s, zone, x, y, z):
    mx, my, mz = s.zone_middles[zone]
    reach = FAR * s.zone_extents[zone]
    dx = min(max(x - mx, -1e300), 1e300)
    dy = min(max(y - my, -1e300), 1e300)
    dz = min(max(z - mz, -1e300), 1e300)
    largest = max(abs(dx), abs(dy), abs(dz))
    if largest <= reach / 2:
        return x, y, z
    length = np.sqrt((dx / largest) ** 2 + (dy / largest) ** 2 + (dz / largest) ** 2)
    share = reach / largest / length
    if share >= 1:
        return x, y, z
    return mx + share * dx, my + share * dy, mz + share * dz


@njit(**OPTIONS)
def _grid_start(s, zone, x, y, z):
    o, t, n = s.grid_origins[zone], s.grid_steps[zone], s.grid_shapes[zone]
    i = int(min(max(np.floor((x - o[0]) / t[0]), 0.0), n[0] - 1.0))
    j = int(min(max(np.floor((y - o[1]) / t[1]), 0.0), n[1] - 1.0))
    k = int(min(max(np.floor((z - o[2]) / t[2]), 0.0), n[2] - 1.0))
    return s.grid_starts[s.grid_firsts[zone] + i + n[0] * (j + n[1] * k)]


@njit(**OPTIONS)
def _weights(s, cell, x, y, z):
    m = s.cells[cell]
    x, y, z = x - m[9], y - m[10], z - m[11]
    a = m[0] * x + m[1] * y + m[2] * z
    b = m[3] * x + m[4] * y + m[5] * z
    c = m[6] * x + m[7] * y + m[8] * z
    return a, b, c, 1 - (a + b + c)


@njit(**OPTIONS)
def _walk_cells(s, zone, cell, x, y, z):
    """The tetrahedron that holds the point, or −1 − the facet through which the walk has left."""
    before = -1
    for _ in range(s.limits[zone]):
        w = _weights(s, cell, x, y, z)
        inner, face = INSIDE, -1
        outer, exit_face = INSIDE, -1
        for k in range(4):
            beyond = s.links[cell, k]
            if beyond < 0:
                if w[k] < outer:
                    outer, exit_face = w[k], k
            elif w[k] < inner and beyond != before:
                inner, face = w[k], k
        if face < 0:
            return cell if exit_face < 0 else s.links[cell, exit_face]
        before, cell = cell, s.links[cell, face]
    return _search(s, zone, x, y, z)


@njit(**OPTIONS)
def _search(s, zone, x, y, z):
    """As `_walk_cells`, by looking at all."""
    first, count = s.zone_cells[zone]
    found, best = -1, -np.inf
    for cell in range(first, first + count):
        w = _weights(s, cell, x, y, z)
        least = min(min(w[0], w[1]), min(w[2], w[3]))
        if least > best:
            found, best = cell, least
    if best >= SEARCH_INSIDE:
        return found
    first, count = s.zone_facets[zone]
    found, best = -1, np.inf
    for facet in range(first, first + count):
        w = _closest(s, facet, x, y, z)
        c = _on_facet(s, facet, w)
        square = (c[0] - x) ** 2 + (c[1] - y) ** 2 + (c[2] - z) ** 2
        if square < best:
            found, best = facet, square
    return -1 - found


@njit(**OPTIONS)
def _closest(s, facet, x, y, z):
    """As `lookup_facets.closest_weights`."""
    pa = s.positions[s.facets[facet, 0]]
    pb = s.positions[s.facets[facet, 1]]
    pc = s.positions[s.facets[facet, 2]]
    bx, by, bz = pb[0] - pa[0], pb[1] - pa[1], pb[2] - pa[2]
    cx, cy, cz = pc[0] - pa[0], pc[1] - pa[1], pc[2] - pa[2]
    x, y, z = x - pa[0], y - pa[1], z - pa[2]
    d1, d2 = bx * x + by * y + bz * z, cx * x + cy * y + cz * z
    if d1 <= 0 and d2 <= 0:
        return 1.0, 0.0, 0.0
    across = bx * cx + by * cy + bz * cz
    d3, d4 = d1 - (bx * bx + by * by + bz * bz), d2 - across
    if d3 >= 0 and d4 <= d3:
        return 0.0, 1.0, 0.0
    g = s.facet_gradients[facet]
    wc = g[1, 0] * x + g[1, 1] * y + g[1, 2] * z
    if wc <= 0 and d1 >= 0 and d3 <= 0:
        return 1 - d1 / (d1 - d3), d1 / (d1 - d3), 0.0
    d5, d6 = d1 - across, d2 - (cx * cx + cy * cy + cz * cz)
    if d6 >= 0 and d5 <= d6:
        return 0.0, 0.0, 1.0
    wb = g[0, 0] * x + g[0, 1] * y + g[0, 2] * z
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
def _on_facet(s, facet, w):
    a = s.positions[s.facets[facet, 0]]
    b = s.positions[s.facets[facet, 1]]
    c = s.positions[s.facets[facet, 2]]
    return (
        w[0] * a[0] + w[1] * b[0] + w[2] * c[0],
        w[0] * a[1] + w[1] * b[1] + w[2] * c[1],
        w[0] * a[2] + w[1] * b[2] + w[2] * c[2],
    )


@njit(**OPTIONS)
def _height(s, facet, x, y, z):
    """Above the facet's plane, and the distance to its first corner."""
    a, n = s.positions[s.facets[facet, 0]], s.facet_normals[facet]
    x, y, z = x - a[0], y - a[1], z - a[2]
    return n[0] * x + n[1] * y + n[2] * z, np.sqrt(x * x + y * y + z * z)


@njit(**OPTIONS)
def _gain(s, facet, at, extent, x, y, z):
    """How much the square of the distance falls from `at` to the closest point of the facet."""
    height, away = _height(s, facet, x, y, z)
    if s.facet_cells[facet] >= 0 and height < VISIBLE * (away + extent):
        return 0.0
    c = _on_facet(s, facet, _closest(s, facet, x, y, z))
    mx, my, mz = c[0] - at[0], c[1] - at[1], c[2] - at[2]
    if mx * mx + my * my + mz * mz <= (SAME_POINT * extent) ** 2:
        return 0.0
    return (
        mx * (x - at[0] + (x - c[0]))
        + my * (y - at[1] + (y - c[1]))
        + mz * (z - at[2] + (z - c[2]))
    )


@njit(**OPTIONS)
def _best_around(s, facet, corner, at, extent, x, y, z):
    """Of the facets around a corner, the one with the largest gain; −1: none gains."""
    best, most, probe = -1, 0.0, s.facets[facet, corner]
    for turn in (1, 2):
        here, at_corner = facet, corner
        for _ in range(len(s.facets)):
            here = s.facet_neighbours[here, (at_corner + turn) % 3]
            if here < 0 or here == facet:
                break
            at_corner = 0
            while at_corner < 2 and s.facets[here, at_corner] != probe:
                at_corner += 1
            gain = _gain(s, here, at, extent, x, y, z)
            if gain > most:
                best, most = here, gain
        if here == facet:
            break
    return best


@njit(**OPTIONS)
def _walk_facets(s, zone, facet, x, y, z):
    """The facet with the closest point, and the weights there."""
    extent = s.zone_extents[zone]
    w = _closest(s, facet, x, y, z)
    for _ in range(len(s.facets)):
        zeros = int(w[0] == 0) + int(w[1] == 0) + int(w[2] == 0)
        if zeros == 0:
            break
        at = _on_facet(s, facet, w)
        if zeros == 1:
            edge = 0 if w[0] == 0 else (1 if w[1] == 0 else 2)
            other = s.facet_neighbours[facet, edge]
            if other >= 0 and _gain(s, other, at, extent, x, y, z) <= 0:
                other = -1
        else:
            corner = 0 if w[0] != 0 else (1 if w[1] != 0 else 2)
            other = _best_around(s, facet, corner, at, extent, x, y, z)
        if other < 0:
            break
        facet, w = other, _closest(s, other, x, y, z)
    return facet, w


@njit(**OPTIONS)
def _locate(s, zone, begin, x, y, z):
    """(cell or −1 − facet, four weights) of a point near the zone, from `begin` on."""
    found = begin
    if begin >= 0:
        found = _walk_cells(s, zone, begin, x, y, z)
    elif s.facet_cells[-1 - begin] >= 0:
        height, _ = _height(s, -1 - begin, x, y, z)
        if height <= CLEARLY * s.zone_extents[zone]:
            found = _walk_cells(s, zone, s.facet_cells[-1 - begin], x, y, z)
    if found >= 0:
        a, b, c, d = _weights(s, found, x, y, z)
        a, b, c, d = max(a, 0.0), max(b, 0.0), max(c, 0.0), max(d, 0.0)
        total = a + b + c + d
        return found, a / total, b / total, c / total, d / total
    facet, w = _walk_facets(s, zone, -1 - found, x, y, z)
    return -1 - facet, w[0], w[1], w[2], 0.0


@njit(**OPTIONS)
def _of_zone(s, zone, cell):
    """Whether a cell, or −1 − facet, is one of the zone's."""
    if cell >= 0:
        first, count = s.zone_cells[zone]
        return first <= cell < first + count
    first, count = s.zone_facets[zone]
    return first <= -1 - cell < first + count


@njit(**OPTIONS)
def _next(s, point, last, last_zone, last_at):
    """As `_locate`, of any point (3,), and its zone and place; `last` may be of another zone."""
    x, y, z = point[0], point[1], point[2]
    zone = _zone_of(s, x, y, z)
    x, y, z = _drawn_near(s, zone, x, y, z)
    step = s.grid_steps[zone]
    near = (
        zone == last_zone
        and abs(x - last_at[0]) <= step[0]
        and abs(y - last_at[1]) <= step[1]
        and abs(z - last_at[2]) <= step[2]
    )
    begin = last if near else _grid_start(s, zone, x, y, z)
    return _locate(s, zone, begin, x, y, z), zone, (x, y, z)


@njit(**OPTIONS)
def _is_finite(point):
    return np.isfinite(point[0]) and np.isfinite(point[1]) and np.isfinite(point[2])


@njit(**OPTIONS)
def _locate_run(s, points, start, probes, weights, cells):
    last, zone, at = 0, -1, (0.0, 0.0, 0.0)
    for i in range(len(points)):
        if not _is_finite(points[i]):
            weights[i], probes[i], cells[i] = np.nan, 0, s.grid_starts[0]
            continue
        if len(start) > 0:
            last, zone, at = _given(s, points[i], start[i])
        (last, a, b, c, d), zone, at = _next(s, points[i], last, zone, at)
        cells[i] = last
        weights[i, 0], weights[i, 1], weights[i, 2], weights[i, 3] = a, b, c, d
        for k in range(4):
            probes[i, k] = s.links[last, 4 + k] if last >= 0 else s.facets[-1 - last, k % 3]


@njit(**OPTIONS)
def _given(s, point, start):
    """A last place as `_next` wants it: here, in `start`, if that is of the zone."""
    zone = _zone_of(s, point[0], point[1], point[2])
    at = _drawn_near(s, zone, point[0], point[1], point[2])
    return start, zone if _of_zone(s, zone, start) else -1, at


@njit(**OPTIONS)
def _lookup_run(s, points, values, result):
    last, zone, at = 0, -1, (0.0, 0.0, 0.0)
    for i in range(len(points)):
        if not _is_finite(points[i]):
            result[i] = np.nan
            continue
        (last, a, b, c, d), zone, at = _next(s, points[i], last, zone, at)
        if last >= 0:
            p = s.links[last]
            _mix(values, p[4], p[5], p[6], p[7], a, b, c, d, result[i])
        else:
            p = s.facets[-1 - last]
            _mix(values, p[0], p[1], p[2], p[0], a, b, c, 0.0, result[i])


@njit(**OPTIONS)
def _mix(values, p, q, r, s, a, b, c, d, result):
    kind = values.dtype.type
    a, b, c, d = kind(a), kind(b), kind(c), kind(d)
    first, second, third, fourth = values[p], values[q], values[r], values[s]
    for k in range(len(result)):
        result[k] = a * first[k] + b * second[k] + c * third[k] + d * fourth[k]


@njit(parallel=True, **OPTIONS)
def locate_all(s, points, start, probes, weights, cells):
    """Fills probes, weights (q, 4) and cells (q,) of points (q, 3); `start` (q,) or (0,)."""
    for run in prange((len(points) + RUN - 1) // RUN):
        i, j = run * RUN, (run + 1) * RUN
        _locate_run(s, points[i:j], start[i:j], probes[i:j], weights[i:j], cells[i:j])


@njit(parallel=True, **OPTIONS)
def lookup_all(s, points, values, result):
    """Fills `result` (q, c) with the mix of `values` (n, c), of the same type."""
    for run in prange((len(points) + RUN - 1) // RUN):
        i, j = run * RUN, (run + 1) * RUN
        _lookup_run(s, points[i:j], values, result[i:j])
