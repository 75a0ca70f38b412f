"""From points to probes and weights: zone, walk, hull, in NumPy or in Numba."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from andon.transport.probes.grid import grid_index
from andon.transport.probes.lookup import barycentric, search_cells, step_limit, walk_cells
from andon.transport.probes.lookup_facets import search_facets, walk_facets
from andon.transport.probes.zones import zone_of

if TYPE_CHECKING:
    from andon.transport.probes.space import ProbeSpace

__all__ = ["FAR", "SEARCH_INSIDE", "Mix", "locate", "starts"]

Float = NDArray[np.float64]
Int = NDArray[np.int32]

# Beyond a facet by less than this share, a point that no walk could place is inside.
SEARCH_INSIDE = -1e-9
# Extents of a zone. A point farther from its middle is looked up at this distance, in the same
# direction: beyond, the digits of float64 do not tell one facet from the next.
FAR = 1e8


@dataclass(frozen=True, eq=False)
class Mix:
    """What each of q points takes from which probes.

    Attributes
    ----------
    probes : (q, w) int32 numbers of probes; not used, with weight 0, the same as another. w is 4,
        or 36 where walls hide some (`hidden_mix`).
    weights : (q, w) float64, ≥ 0, sum 1; NaN for a point with a coordinate that is not finite.
    cells : (q,) int32 the tetrahedron; −1 − f: the facet f of the hull. A start for the next time.
    """

    probes: Int
    weights: Float
    cells: Int


def locate(space: ProbeSpace, points: Float, start: Int | None, /) -> Mix:
    """`ProbeSpace.locate`, clear rather than fast."""
    at = np.array(points, np.float64).reshape(-1, 3)
    valid = np.isfinite(at).all(axis=1)
    at[~valid] = 0.0
    zones = zone_of(at, space.boxes, space.box_zones)
    at = _drawn_near(space, at, zones)
    cells = starts(space, at, zones, start)
    probes, weights = np.zeros((len(at), 4), np.int32), np.zeros((len(at), 4))
    exits = -1 - cells
    walks = np.flatnonzero(cells >= 0)
    cells[walks], exits[walks] = _walked(space, at[walks], cells[walks], zones[walks])
    inside = walks[exits[walks] < 0]
    probes[inside] = space.corners[cells[inside]]
    weights[inside] = _normalised(barycentric(space, at[inside], cells[inside]))
    outside = np.flatnonzero(exits >= 0)
    facets, shares = walk_facets(space, at[outside], exits[outside])
    probes[outside] = space.facets[facets][:, [0, 1, 2, 0]]
    weights[outside, :3] = shares
    cells[outside] = -1 - facets
    weights[~valid] = np.nan
    return Mix(probes, weights, cells)


def starts(space: ProbeSpace, points: Float, zones: Int, last: Int | None, /) -> Int:
    """(q,) where the walk to each point (q, 3) of a zone (q,) begins.

    A tetrahedron, or −1 − facet in a zone without volume: that of `last` (q,), as in `Mix.cells`,
    if it is of the point's zone, else that of the grid.
    """
    box = grid_index(
        points, space.grid_origins[zones], space.grid_steps[zones], space.grid_shapes[zones]
    )
    begin = space.grid_starts[space.grid_firsts[zones] + box]
    if last is None:
        return begin
    last = np.asarray(last, np.int32).reshape(len(points))
    facet = np.clip(-1 - last, 0, len(space.facets) - 1)
    # Behind a facet of the hull there is a cell; a zone without volume has −1 there, and the facet.
    behind = np.where(space.facet_cells[facet] >= 0, space.facet_cells[facet], -1 - facet)
    last = np.where(last < 0, np.where(-1 - last == facet, behind, len(space.corners)), last)
    first, count = space.zone_cells[zones].T
    first_facet, facets = space.zone_facets[zones].T
    of_zone = (last >= first) & (last < first + count)
    flat = (count == 0) & (-1 - last >= first_facet) & (-1 - last < first_facet + facets)
    return np.where(of_zone | flat, last, begin).astype(np.int32)


def _drawn_near(space: ProbeSpace, points: Float, zones: Int) -> Float:
    """Points farther than `FAR` are moved to that distance from the middle of their zone."""
    middles, reach = space.zone_middles[zones], FAR * space.zone_extents[zones]
    with np.errstate(over="ignore"):
        # Of a difference beyond the largest float the direction along its axes is enough.
        away = np.clip(points - middles, -1e300, 1e300)
    largest = np.abs(away).max(axis=1)
    far = np.flatnonzero(largest > reach / 2)
    unit = away[far] / largest[far, None]
    length = np.linalg.norm(unit, axis=1)
    share = np.minimum(1.0, reach[far] / largest[far] / length)[:, None]
    points[far] = np.where(share < 1, middles[far] + share * away[far], points[far])
    return points


def _walked(space: ProbeSpace, points: Float, start: Int, zones: Int) -> tuple[Int, Int]:
    """Tetrahedra (q,), and exits as of `walk_cells`, of points (q, 3), without a −2."""
    limits = space.zone_cells[zones, 1]
    limit = step_limit(int(limits.max(initial=0)))
    cells, exits = walk_cells(space, points, start, limit)
    for number in np.flatnonzero(exits == -2):
        zone, point = zones[number], points[number : number + 1]
        found, least = search_cells(space, point, *space.zone_cells[zone])
        cells[number], exits[number] = found[0], -1
        if least[0] < SEARCH_INSIDE:
            exits[number] = search_facets(space, point, *space.zone_facets[zone])[0]
    return cells, exits


def _normalised(weights: Float) -> Float:
    """Weights (q, 4) without what rounding put below 0; sum 1."""
    held = np.maximum(weights, 0.0)
    return held / held.sum(axis=1, keepdims=True)
