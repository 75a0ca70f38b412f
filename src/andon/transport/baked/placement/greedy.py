"""Greedy set cover over places.

The best camera is the one that adds most to what the chosen ones see well; then the next. No
polynomial method does better than its 1 − 1/e of the best possible (Nemhauser, Wolsey & Fisher
1978; Feige 1998). Gains only shrink while cameras are chosen, so that a candidate whose old gain is
below another's present one need not be looked at (Minoux 1978).

Gains are whole numbers: the samples a camera adds, each counted more the smaller the texels are
in which it is seen. Ties go to the first candidate; there is nothing to round.

Found maps go all around (latlong). Square pictures of 113° from the same places, in 26 directions,
need as many cameras in a room and half as many again in large buildings, at more than twice the
texels (cameras for 0.97 of the surface, and million texels for 0.95, where texels may be as long as
a 25th of the typical distance):

==================  ==============  ==============
maps                384 × 192 px    384 × 384 px
                    all around      113°
==================  ==============  ==============
tatami room         10, 0.52        10, 1.18
Sponza              20, 1.25        27, 3.10
Sibenik             20, 1.18        31, 3.54
==================  ==============  ==============
"""

from __future__ import annotations

import heapq
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.spaces import View, look_at
from andon.transport.baked.placement.sight import Sight, texels_m

__all__ = ["Looks", "best_place", "first_queue", "found_view", "looks_from"]

Float = NDArray[np.float64]

# The middle of found maps.
FORWARD: Float = np.array([0.0, 0.0, -1.0])
# A sample in texels of the limit's length counts 4, in those of half of it or less 8.
FULL_VALUE = 8
WELL_VALUE = 4


@dataclass(frozen=True, eq=False)
class Looks:
    """What is seen well from one place.

    Attributes
    ----------
    place : (3,) metres.
    sides : (m,) numbers of the sides.
    value : (m,) int64, what each counts, `WELL_VALUE` … `FULL_VALUE`.
    """

    place: Float
    sides: NDArray[np.int64]
    value: NDArray[np.int64]


def found_view(place: Float, map_size_px: int, name: str = "found") -> View:
    """A picture all around `place` (3,), twice as wide as high."""
    height = max(1, map_size_px // 2)
    pose = look_at(place, place + FORWARD)
    return View("latlong", map_size_px, height, world_from_camera=pose, name=name)


def looks_from(place: Float, sight: Sight, limit_m: Float, map_size_px: int, /) -> Looks:
    """What is seen from `place` (3,) in texels up to `limit_m` (2n,), for all sides."""
    texels = texels_m(found_view(place, map_size_px), sight.points, sight.cosine)
    ratio = limit_m[sight.sides] / np.maximum(texels, 1e-300)
    well = ratio >= 1
    value = np.floor(np.minimum(ratio[well] * WELL_VALUE, FULL_VALUE)).astype(np.int64)
    return Looks(place, sight.sides[well], value)


def first_queue(looks: Sequence[Looks], covered: NDArray[np.bool_], /) -> list[tuple[int, int]]:
    """(−gain, place) of all places that add something, as a heap."""
    gains = [_gain(look, covered) for look in looks]
    queue = [(-gain, place) for place, gain in enumerate(gains) if gain]
    heapq.heapify(queue)
    return queue


def best_place(
    looks: Sequence[Looks], covered: NDArray[np.bool_], queue: list[tuple[int, int]], /
) -> int | None:
    """The place with the largest gain, None where none has any; brings `queue` up to date."""
    while queue:
        old, place = queue[0]
        gain = _gain(looks[place], covered)
        if gain == 0:
            heapq.heappop(queue)
        elif -gain == old:
            return place
        else:
            heapq.heapreplace(queue, (-gain, place))
    return None


def _gain(look: Looks, covered: NDArray[np.bool_]) -> int:
    return int(look.value[~covered[look.sides]].sum())
