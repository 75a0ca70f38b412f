"""The lookup of `locate`, one point after the other, compiled: for millions of points.

Each thread takes a run of points. A point is tried in the cell of the last one; else the walk
begins there while they stay near, or where the grid says. Numba is imported with this module and by
nobody else; `lookup_hull` has what happens outside.
"""

# Numba knows its arguments, and needs none of the annotations that a checker would ask for.
# pyright: basic
from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit, parallel_chunksize, prange
from numpy.typing import NDArray

from andon.transport.probes.locate import FAR, SEARCH_INSIDE
from andon.transport.probes.lookup import INSIDE, step_limit
from andon.transport.probes.lookup_hull import OPTIONS, search_hull, walk_hull
from andon.transport.probes.space import ProbeSpace

__all__ = ["Compiled", "compiled", "locate_all", "lookup_all"]

# Points of a run: enough to be near each other, few enough to go round.
RUN = 1024
# Runs that a thread takes at a time: some points cost a hundred times as much as others.
RUNS = 4
# Share of the extent by which a point is surely in front of a hull's facet.
CLEARLY = 1e-6


class Compiled(NamedTuple):
    """Arrays of a `ProbeSpace`, packed: what is read together lies together.

    Few of them, since each travels through every call. Rows are
    `cells` (m, 12): inverse, origin; `links` (m, 8): neighbours, corners;
    `facets` (f, 18): three corners, normal, gradients; `edges` (f, 7): probes, neighbours, cell;
    `zones` (z, 10): middle, extent, origin and step of the grid;
    `ranges` (z, 9): first and count of cells, of facets, shape and first of the grid, step limit.
    """

    cells: NDArray[np.float64]
    links: NDArray[np.int32]
    facets: NDArray[np.float64]
    edges: NDArray[np.int32]
    zones: NDArray[np.float64]
    ranges: NDArray[np.int32]
    boxes: NDArray[np.float64]
    box_zones: NDArray[np.int32]
    starts: NDArray[np.int32]


def compiled(space: ProbeSpace, /) -> Compiled:
    """The arrays of `space`, packed."""
    limits = [step_limit(int(count)) for count in space.zone_cells[:, 1]]
    corners = space.positions[space.facets].reshape(-1, 9)
    gradients = space.facet_gradients.reshape(-1, 6)
    return Compiled(
        np.column_stack([space.inverses.reshape(-1, 9), space.origins]),
        np.column_stack([space.neighbours, space.corners]),
        np.column_stack([corners, space.facet_normals, gradients]),
        np.column_stack([space.facets, space.facet_neighbours, space.facet_cells]),
        np.column_stack(
            [space.zone_middles, space.zone_extents, space.grid_origins, space.grid_steps]
        ),
        np.column_stack(
            [space.zone_cells, space.zone_facets, space.grid_shapes, space.grid_firsts, limits]
        ).astype(np.int32),
        np.ascontiguousarray(space.boxes),
        np.ascontiguousarray(space.box_zones),
        np.ascontiguousarray(space.grid_starts),
    )


@njit(**OPTIONS)
def _zone_of(boxes, box_zones, x, y, z):
    if len(boxes) == 1:
        return box_zones[0]
    best, least = 0, np.inf
    for b in range(len(boxes)):
        dx = max(boxes[b, 0, 0] - x, x - boxes[b, 1, 0], 0.0)
        dy = max(boxes[b, 0, 1] - y, y - boxes[b, 1, 1], 0.0)
        dz = max(boxes[b, 0, 2] - z, z - boxes[b, 1, 2], 0.0)
        square = dx * dx + dy * dy + dz * dz
        if square < least:
            best, least = b, square
    return box_zones[best]


@njit(**OPTIONS)
def _drawn_near(zones, i, x, y, z):
    """As `locate._drawn_near`, in the zone `i`."""
    reach = FAR * zones[i, 3]
    dx = min(max(x - zones[i, 0], -1e300), 1e300)
    dy = min(max(y - zones[i, 1], -1e300), 1e300)
    dz = min(max(z - zones[i, 2], -1e300), 1e300)
    largest = max(abs(dx), abs(dy), abs(dz))
    if largest <= reach / 2:
        return x, y, z
    length = np.sqrt((dx / largest) ** 2 + (dy / largest) ** 2 + (dz / largest) ** 2)
    share = reach / largest / length
    if share >= 1:
        return x, y, z
    return zones[i, 0] + share * dx, zones[i, 1] + share * dy, zones[i, 2] + share * dz


@njit(**OPTIONS)
def _box(at, origin, step, count):
    return int(min(max(np.floor((at - origin) / step), 0.0), count - 1.0))


@njit(**OPTIONS)
def _grid_start(zones, ranges, starts, i, x, y, z):
    column = _box(x, zones[i, 4], zones[i, 7], ranges[i, 4])
    row = _box(y, zones[i, 5], zones[i, 8], ranges[i, 5])
    layer = _box(z, zones[i, 6], zones[i, 9], ranges[i, 6])
    return starts[ranges[i, 7] + column + ranges[i, 4] * (row + ranges[i, 5] * layer)]


@njit(**OPTIONS)
def _weights(cells, i, x, y, z):
    """Coordinates in the tetrahedron `i`."""
    x, y, z = x - cells[i, 9], y - cells[i, 10], z - cells[i, 11]
    a = cells[i, 0] * x + cells[i, 1] * y + cells[i, 2] * z
    b = cells[i, 3] * x + cells[i, 4] * y + cells[i, 5] * z
    c = cells[i, 6] * x + cells[i, 7] * y + cells[i, 8] * z
    return a, b, c, 1 - (a + b + c)


@njit(**OPTIONS)
def _walk(cells, links, limit, cell, x, y, z):
    """Where a walk ends: a tetrahedron, or −1 − the facet through which it has left; and whether it
    did."""
    before = -1
    for _ in range(limit):
        w = _weights(cells, cell, x, y, z)
        inner, ahead = INSIDE, -1
        outer, left = INSIDE, 0
        for k in range(4):
            beyond = links[cell, k]
            if beyond < 0:
                if w[k] < outer:
                    outer, left = w[k], beyond
            elif w[k] < inner and beyond != before:
                inner, ahead = w[k], beyond
        if ahead < 0:
            return (left if left < 0 else cell), True
        before, cell = cell, ahead
    return cell, False


@njit(**OPTIONS)
def _search(cells, first, count, x, y, z):
    """The one of `count` tetrahedra that holds a point best, and its smallest weight there."""
    found, best = -1, -np.inf
    for cell in range(first, first + count):
        w = _weights(cells, cell, x, y, z)
        least = min(min(w[0], w[1]), min(w[2], w[3]))
        if least > best:
            found, best = cell, least
    return found, best


@njit(**OPTIONS)
def _found(cells, links, facets, edges, zones, ranges, zone, begin, x, y, z):
    """The tetrahedron of a point; −1 − f: it is outside, near the facet f."""
    cell = begin
    if begin < 0:
        f = -1 - begin
        cell = edges[f, 6]
        if cell < 0:
            return begin
        height = facets[f, 9] * (x - facets[f, 0]) + facets[f, 10] * (y - facets[f, 1])
        height += facets[f, 11] * (z - facets[f, 2])
        if height > CLEARLY * zones[zone, 3]:
            return begin
    end, ended = _walk(cells, links, ranges[zone, 8], cell, x, y, z)
    if ended:
        return end
    cell, least = _search(cells, ranges[zone, 0], ranges[zone, 1], x, y, z)
    if least >= SEARCH_INSIDE:
        return cell
    return -1 - search_hull(facets, ranges[zone, 2], ranges[zone, 3], x, y, z)


@njit(**OPTIONS)
def _place(cells, links, facets, edges, zones, ranges, zone, begin, x, y, z):
    """(cell, or −1 − facet, and four weights) of a finite point."""
    found = _found(cells, links, facets, edges, zones, ranges, zone, begin, x, y, z)
    if found >= 0:
        return found, _held(_weights(cells, found, x, y, z))
    facet, w = walk_hull(facets, edges, zones[zone, 3], -1 - found, x, y, z)
    return -1 - facet, (w[0], w[1], w[2], 0.0)


@njit(**OPTIONS)
def _held(w):
    """Without what rounding put below 0; sum 1."""
    a, b, c, d = max(w[0], 0.0), max(w[1], 0.0), max(w[2], 0.0), max(w[3], 0.0)
    total = a + b + c + d
    return a / total, b / total, c / total, d / total


@njit(**OPTIONS)
def _is_near(zones, i, x, y, z, u, v, w):
    """Whether two points are no more than a box of the grid apart."""
    return abs(x - u) <= zones[i, 7] and abs(y - v) <= zones[i, 8] and abs(z - w) <= zones[i, 9]


@njit(**OPTIONS)
def _of_zone(ranges, i, cell):
    """Whether a cell, or −1 − facet, is one of the zone's."""
    if cell >= 0:
        return ranges[i, 0] <= cell < ranges[i, 0] + ranges[i, 1]
    return ranges[i, 2] <= -1 - cell < ranges[i, 2] + ranges[i, 3]


@njit(**OPTIONS)
def _is_finite(x, y, z):
    return np.isfinite(x) and np.isfinite(y) and np.isfinite(z)


@njit(**OPTIONS)
def _locate_run(s, points, start, probes, weights, numbers):
    cells, links, facets, edges, zones, ranges, boxes, box_zones, starts = s
    last, last_zone, u, v, w = 0, -1, 0.0, 0.0, 0.0
    for i in range(len(points)):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        if not _is_finite(x, y, z):
            weights[i], probes[i], numbers[i] = np.nan, 0, starts[0]
            continue
        zone = _zone_of(boxes, box_zones, x, y, z)
        if len(start) > 0:
            last, near = start[i], _of_zone(ranges, zone, start[i])
        else:
            near = zone == last_zone and _is_near(zones, zone, x, y, z, u, v, w)
        last_zone, u, v, w = zone, x, y, z
        x, y, z = _drawn_near(zones, zone, x, y, z)
        if not near:
            last = _grid_start(zones, ranges, starts, zone, x, y, z)
        last, share = _place(cells, links, facets, edges, zones, ranges, zone, last, x, y, z)
        numbers[i] = last
        for k in range(4):
            weights[i, k] = share[k]
            probes[i, k] = links[last, 4 + k] if last >= 0 else edges[-1 - last, k % 3]


@njit(**OPTIONS)
def _lookup_run(s, points, values, result):
    cells, links, facets, edges, zones, ranges, boxes, box_zones, starts = s
    last, last_zone, u, v, w = -1, -1, 0.0, 0.0, 0.0
    for i in range(len(points)):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        zone = _zone_of(boxes, box_zones, x, y, z)
        if last >= 0 and zone == last_zone:
            share = _weights(cells, last, x, y, z)
            if min(min(share[0], share[1]), min(share[2], share[3])) >= 0:
                u, v, w = x, y, z
                _mix(values, links, last, 4, share, result, i)
                continue
        near = zone == last_zone and _is_near(zones, zone, x, y, z, u, v, w)
        last_zone, u, v, w = zone, x, y, z
        if not _is_finite(x, y, z):
            result[i] = np.nan
            last_zone = -1
            continue
        x, y, z = _drawn_near(zones, zone, x, y, z)
        if not near:
            last = _grid_start(zones, ranges, starts, zone, x, y, z)
        # Most points end here. `_place` would find the same, but its call costs as much again.
        if last >= 0:
            last, ended = _walk(cells, links, ranges[zone, 8], last, x, y, z)
            if ended and last >= 0:
                _mix(values, links, last, 4, _held(_weights(cells, last, x, y, z)), result, i)
                continue
        last, share = _place(cells, links, facets, edges, zones, ranges, zone, last, x, y, z)
        if last >= 0:
            _mix(values, links, last, 4, share, result, i)
        else:
            _mix(values, edges, -1 - last, 0, share, result, i)


@njit(**OPTIONS)
def _mix(values, numbers, row, first, share, result, i):
    """Row `i` of `result`: the mix of the rows of `values` that a row of `numbers` names."""
    kind = values.dtype.type
    a, b, c, d = kind(share[0]), kind(share[1]), kind(share[2]), kind(share[3])
    p, q, r = numbers[row, first], numbers[row, first + 1], numbers[row, first + 2]
    s = numbers[row, first + 3] if first else p
    for k in range(result.shape[1]):
        mixed = a * values[p, k] + b * values[q, k]
        result[i, k] = mixed + (c * values[r, k] + d * values[s, k])


@njit(parallel=True, **OPTIONS)
def _locate_runs(s, points, start, probes, weights, cells):
    for run in prange((len(points) + RUN - 1) // RUN):
        i, j = run * RUN, (run + 1) * RUN
        _locate_run(s, points[i:j], start[i:j], probes[i:j], weights[i:j], cells[i:j])


@njit(parallel=True, **OPTIONS)
def _lookup_runs(s, points, values, result):
    for run in prange((len(points) + RUN - 1) // RUN):
        i, j = run * RUN, (run + 1) * RUN
        _lookup_run(s, points[i:j], values, result[i:j])


def locate_all(s, points, start, probes, weights, cells):
    """Fills probes, weights (q, 4) and cells (q,) of points (q, 3); `start` (q,) or (0,)."""
    with parallel_chunksize(RUNS):
        _locate_runs(s, points, start, probes, weights, cells)


def lookup_all(s, points, values, result):
    """Fills `result` (q, c) with the mix of `values` (n, c), of the same type."""
    with parallel_chunksize(RUNS):
        _lookup_runs(s, points, values, result)
