"""Which cameras are taken, until enough is seen."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from andon.spaces import View
from andon.transport.baked.placement.greedy import Looks, best_place, first_queue, found_view
from andon.transport.baked.placement.model import Ended

__all__ = ["Chosen"]

# A camera that adds less than this share of the reachable area is not worth its time.
LEAST_GAIN = 1e-3


class Chosen:
    """The cameras so far, and the sides that each of them sees well.

    Parameters
    ----------
    sides : of the samples, seen or not.
    reachable : how many of them anything sees.
    coverage : share of those that shall be covered.
    most : cameras.
    """

    def __init__(self, sides: int, reachable: int, coverage: float, most: int) -> None:
        self.views: list[View] = []
        self.well: list[NDArray[np.int64]] = []
        self._times = np.zeros(sides, np.int64)
        self._enough, self._least = coverage * reachable, LEAST_GAIN * reachable
        self._most = most

    @property
    def _covered(self) -> NDArray[np.bool_]:
        return self._times > 0

    @property
    def is_enough(self) -> bool:
        """As much is covered as shall be."""
        return bool(np.count_nonzero(self._times) >= self._enough)

    def add(self, view: View, sides: NDArray[np.int64], /) -> None:
        """Takes a view that sees `sides` well."""
        self.views.append(view)
        self.well.append(sides)
        self._times[sides] += 1

    def fill(self, looks: Sequence[Looks], map_size_px: int, /) -> Ended:
        """Adds the best places, until enough is covered; why it ended."""
        queue = first_queue(looks, self._covered)
        while not self.is_enough:
            place = best_place(looks, self._covered, queue)
            if place is None:
                return "nothing gained"
            look = looks[place]
            if np.count_nonzero(~self._covered[look.sides]) < self._least:
                return "nothing gained"
            if len(self.views) >= self._most:
                return "most cameras"
            self.add(found_view(look.place, map_size_px), look.sides)
        return "reached"

    def prune(self, first: int, /) -> int:
        """Leaves out views from number `first` on that the others make superfluous; how many.

        Superfluous is what alone sees too little, where enough is covered without it.
        """
        before = len(self.views)
        for number in reversed(range(first, before)):
            own = self.well[number]
            lost = np.count_nonzero(self._times[own] == 1)
            left = np.count_nonzero(self._times) - lost
            if lost == 0 or (lost < self._least and left >= self._enough):
                self._times[own] -= 1
                del self.views[number], self.well[number]
        return before - len(self.views)
