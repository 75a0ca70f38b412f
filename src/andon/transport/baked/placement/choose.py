"""Which cameras are taken, until enough is seen."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from andon.spaces import View
from andon.transport.baked.placement.greedy import (
    DIRECTIONS,
    WELL_VALUE,
    Looks,
    best_looks,
    first_queue,
    found_view,
)
from andon.transport.baked.placement.model import Ended

__all__ = ["Chosen"]

# A camera that adds less than this share of the reachable area is not worth its time.
LEAST_GAIN = 1e-3


class Chosen:
    """The cameras so far, and the sides that each of them sees well."""

    def __init__(self, reachable: int, coverage: float, most: int, map_size_px: int) -> None:
        self.views: list[View] = []
        self.well: list[NDArray[np.int64]] = []
        self._reachable, self._coverage = reachable, coverage
        self._most, self._size_px = most, map_size_px

    def add(self, view: View, sides: NDArray[np.int64], /) -> None:
        """Takes a view that sees `sides` well."""
        self.views.append(view)
        self.well.append(sides)

    def fill(self, looks: Sequence[Looks], /) -> Ended:
        """Adds the best of what can be seen, until enough is covered; why it ended."""
        count = 1 + max(int(look.sides.max(initial=-1)) for look in looks)
        covered = np.zeros(count, bool)
        for sides in self.well:
            covered[sides] = True
        queue = first_queue(looks, covered)
        while np.count_nonzero(covered) < self._coverage * self._reachable:
            if len(self.views) >= self._most:
                return "most cameras"
            place, direction = best_looks(looks, covered, queue)
            if place < 0:
                return "nothing gained"
            look = looks[place]
            sides = look.sides[look.value[direction] >= WELL_VALUE]
            if np.count_nonzero(~covered[sides]) < LEAST_GAIN * self._reachable:
                return "nothing gained"
            self.add(found_view(look.place, DIRECTIONS[direction], self._size_px), sides)
            covered[sides] = True
        return "reached"

    def prune(self, first: int, /) -> None:
        """Leaves out cameras from number `first` on that later ones have made superfluous."""
        times: dict[int, int] = {}
        for sides in self.well:
            for side in sides.tolist():
                times[side] = times.get(side, 0) + 1
        for number in reversed(range(first, len(self.views))):
            own = self.well[number].tolist()
            lost = sum(times[side] == 1 for side in own)
            if lost == 0 or (
                lost < LEAST_GAIN * self._reachable
                and len(times) - lost >= self._coverage * self._reachable
            ):
                for side in own:
                    times[side] -= 1
                    if times[side] == 0:
                        del times[side]
                del self.views[number], self.well[number]
