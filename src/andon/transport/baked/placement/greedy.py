"""Greedy set cover over places and directions.

The best camera is the one that adds most to what the chosen ones see well; then the next. No
polynomial method does better than its 1 − 1/e of the best possible (Nemhauser, Wolsey & Fisher
1978; Feige 1998). Gains only shrink while cameras are chosen, so that a candidate whose old gain is
below another's present one need not be looked at (Minoux 1978).

Gains are whole numbers: the samples a camera adds, each counted more the smaller the texels are
in which it is seen. Ties go to the first candidate; there is nothing to round.
"""

from __future__ import annotations

import heapq
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.spaces import View, look_at
from andon.transport.baked.placement.sight import Sight

__all__ = [
    "DIRECTIONS",
    "HALF_WIDTH",
    "WELL_VALUE",
    "Looks",
    "best_looks",
    "first_queue",
    "found_view",
    "looks_from",
]

Float = NDArray[np.float64]

# Towards the 26 neighbours of a die among dice: every 45°, with pictures of 100°.
DIRECTIONS: Float = np.array(
    [
        (x, y, z)
        for x in (-1, 0, 1)
        for y in (-1, 0, 1)
        for z in (-1, 0, 1)
        if (x, y, z) != (0, 0, 0)
    ],
    float,
)
# Tangent of half the angle of pictures that are found: 100.4°.
HALF_WIDTH = 1.2
# A sample in texels of the limit's length counts 4, in those of half of it or less 8.
FULL_VALUE = 8
WELL_VALUE = 4


@dataclass(frozen=True, eq=False)
class Looks:
    """What can be seen from one place, for each of the directions.

    Attributes
    ----------
    place : (3,) metres.
    sides : (m,) numbers of the sides that are seen.
    value : (26, m) uint8, 0 where a side is not in the picture, or in too large texels.
    """

    place: Float
    sides: NDArray[np.int64]
    value: NDArray[np.uint8]


def _up(direction: Float) -> tuple[float, float, float]:
    """Which way is up in a picture towards `direction` (3,)."""
    return (0, 1, 0) if direction[0] or direction[2] else (0, 0, -1)


# (26, 3, 3) what is right, down and forward, as columns.
_AXES: Float = np.stack([look_at(np.zeros(3), way, _up(way))[:3, :3] for way in DIRECTIONS])


def found_view(place: Float, direction: Float, map_size_px: int, name: str = "found") -> View:
    """A square picture of about 100° from `place` (3,) towards `direction` (3,)."""
    pose = look_at(place, place + direction, _up(direction))
    focal, middle = map_size_px / 2 / HALF_WIDTH, (map_size_px - 1) / 2
    return View("pinhole", map_size_px, map_size_px, focal, focal, middle, middle, (), pose, name)


def looks_from(place: Float, sight: Sight, limit_m: Float, map_size_px: int, /) -> Looks:
    """All directions from `place` (3,); `limit_m` is the longest texel for each side."""
    relative = sight.points - place
    value = np.zeros((len(DIRECTIONS), len(sight.sides)), np.uint8)
    focal = map_size_px / 2 / HALF_WIDTH
    inner = HALF_WIDTH * (1 - 3 / map_size_px)  # as `in_picture`: half a pixel and a whole one
    best_depth = limit_m[sight.sides] * sight.cosine * focal
    for index, axes in enumerate(_AXES):
        across, down, depth = (relative @ axes).T
        inside = (depth > 0) & (np.maximum(np.abs(across), np.abs(down)) <= inner * depth)
        depth = depth[inside]
        ratio = np.minimum(best_depth[inside] / (2 * depth), 1)
        level = np.floor(ratio * FULL_VALUE).astype(np.uint8)
        value[index, inside] = np.where(level >= WELL_VALUE, level, 0)
    return Looks(place, sight.sides, value)


def best_looks(
    looks: Sequence[Looks], covered: NDArray[np.bool_], queue: list[tuple[int, int, int]]
) -> tuple[int, int]:
    """(place, direction) of the candidate with the largest gain, (−1, −1) where none has any.

    `queue` holds old gains: (−gain, place, direction).
    """
    fresh: dict[int, NDArray[np.int64]] = {}
    while queue:
        _, place, direction = queue[0]
        if place not in fresh:
            here = looks[place]
            open_ones = ~covered[here.sides]
            fresh[place] = here.value[:, open_ones].sum(axis=1, dtype=np.int64)
        gain = int(fresh[place][direction])
        if gain == 0:
            heapq.heappop(queue)
        elif -gain == queue[0][0]:
            return place, direction
        else:
            heapq.heapreplace(queue, (-gain, place, direction))
    return -1, -1


def first_queue(looks: Sequence[Looks], covered: NDArray[np.bool_]) -> list[tuple[int, int, int]]:
    """Gains of all candidates, as a heap."""
    queue: list[tuple[int, int, int]] = []
    for place, here in enumerate(looks):
        gains = here.value[:, ~covered[here.sides]].sum(axis=1, dtype=np.int64)
        queue += [(-int(gain), place, direction) for direction, gain in enumerate(gains) if gain]
    heapq.heapify(queue)
    return queue
