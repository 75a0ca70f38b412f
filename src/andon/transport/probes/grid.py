"""Where a walk begins: a grid over each zone that names a cell near the middle of each box.

About one box a cell, so a walk from there is a step or two long, and a random point costs little
more than one beside the last.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from andon.transport.probes.lookup import walk_cells
from andon.transport.probes.lookup_facets import walk_facets

if TYPE_CHECKING:
    from andon.transport.probes.space import ProbeSpace

__all__ = ["StartGrid", "grid_index", "start_grid"]

Float = NDArray[np.float64]
Int = NDArray[np.int32]
Whole = NDArray[np.int64]

# Boxes of a zone: 8 MB of starts.
MOST_BOXES = 1 << 21
# A walk that is not at its box's middle by then starts where it is.
WALK = 64


@dataclass(frozen=True)
class StartGrid:
    """Of one zone.

    Attributes
    ----------
    origin : (3,) lowest corner, metres.
    step : (3,) size of a box, metres, > 0.
    shape : (3,) int32 boxes along x, y, z.
    starts : (x·y·z,) int32, x fastest: a tetrahedron, or −1 − facet of a zone without volume.
    """

    origin: Float
    step: Float
    shape: Int
    starts: Int


def grid_index(points: Float, origin: Float, step: Float, shape: Int, /) -> Whole:
    """(q,) the box of each point (q, 3); outside, the nearest. Arguments broadcast."""
    place = np.clip(np.floor((points - origin) / step), 0, shape - 1).astype(np.int64)
    wide: Whole = np.broadcast_to(shape, place.shape).astype(np.int64)
    return place[..., 0] + wide[..., 0] * (place[..., 1] + wide[..., 1] * place[..., 2])


def start_grid(space: ProbeSpace, zone: int, /) -> StartGrid:
    """The grid of the zone with this number; the space's other arrays must be there."""
    (first, count), (facet, facets) = space.zone_cells[zone], space.zone_facets[zone]
    of = space.corners[first : first + count] if count else space.facets[facet : facet + facets]
    corners = space.positions[of]
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    shape = _shape(high - low, min(len(corners), MOST_BOXES))
    step = np.where(high > low, (high - low) / shape, 1.0)
    place = grid_index(corners.mean(axis=1), low, step, shape)
    seeds: Int = np.full(int(shape.prod()), -1, np.int32)
    seeds[place] = np.arange(len(corners), dtype=np.int32)
    x, y, z = (int(boxes) for boxes in shape)
    seeds = _filled(seeds.reshape(z, y, x)).ravel()
    middles = low + step * (_boxes(shape) + 0.5)
    if count:
        starts, _ = walk_cells(space, middles, seeds + first, WALK)
    else:
        starts = -1 - walk_facets(space, middles, seeds + facet)[0]
    return StartGrid(low, step, shape, starts.astype(np.int32))


def _boxes(shape: Int) -> Whole:
    """(x·y·z, 3) places of all boxes, x fastest."""
    number = np.arange(int(shape.prod()))
    x, y = int(shape[0]), int(shape[1])
    return np.column_stack([number % x, number // x % y, number // (x * y)])


def _shape(size: Float, boxes: int) -> Int:
    """(3,) numbers of about cubic boxes, about so many; 1 along an axis without extent."""
    counts = np.ones(3)
    order = np.argsort(size)
    for axes in (3, 2, 1):
        long = order[3 - axes :]
        if size[long[0]] <= 0:
            continue
        relative = size[long] / size[long[-1]]
        counts = np.ones(3)
        counts[long] = relative * float(boxes / relative.prod()) ** (1 / axes)
        if counts.min() >= 1:
            break
    return np.clip(np.floor(counts), 1, MOST_BOXES).astype(np.int32)


def _filled(seeds: Int) -> Int:
    """(z, y, x) where −1 is replaced by a value near along an axis."""
    for axis in (2, 1, 0):
        for _ in range(2):
            seeds = np.flip(seeds, axis)
            own = np.indices((seeds.shape[axis],), np.int64)[0]
            own = own.reshape(tuple(-1 if i == axis else 1 for i in range(3)))
            last: Whole = np.maximum.accumulate(np.where(seeds < 0, 0, own), axis=axis)
            seeds = np.take_along_axis(seeds, last, axis)
    return seeds
