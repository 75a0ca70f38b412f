"""The pointer as a gaze: what lies under it is looked at."""

from __future__ import annotations

import math

from andon.observer.gaze.filters import filter_of
from andon.observer.gaze.smoother import Smoother
from andon.observer.model import GazeState
from andon.scene.eye import Gaze

__all__ = ["MouseGaze"]

# A pointer that crosses an edge on its way elsewhere has left it by then; a hand that has arrived
# rests for longer. About the length of a short fixation.
SETTLE_SECONDS = 0.1
# Less is the same thing that is pointed at.
SAME_DIOPTRES = 0.1


class MouseGaze:
    """Turns distances under a pointer into a fixation.

    A pointer only speaks when it moves, and one that rests still points: `at` takes a sample of
    what it points at now. A change of more than 0.1 D counts after it has lasted 0.1 s.
    """

    def __init__(self, gaze: Gaze, /) -> None:
        self._smoother = Smoother(filter_of(gaze), gaze.hold_seconds)
        self._accepted = math.nan
        self._waiting = math.nan
        self._since = -math.inf

    def point(self, time_seconds: float, distance_m: float | None, /) -> None:
        """The pointer is over something `distance_m` away, or over nothing (None, NaN, ≤ 0)."""
        known = distance_m is not None and distance_m > 0
        dioptres = 1 / distance_m if known and distance_m is not None else math.nan
        self._settle(time_seconds)
        if _same(dioptres, self._accepted):
            self._accepted = self._waiting = dioptres
        elif not _same(dioptres, self._waiting) or _same(self._waiting, self._accepted):
            self._waiting, self._since = dioptres, time_seconds

    def _settle(self, time_seconds: float) -> None:
        if time_seconds - self._since >= SETTLE_SECONDS:
            self._accepted = self._waiting

    def at(self, time_seconds: float, /) -> tuple[float | None, GazeState]:
        """Vergence in dioptres and its state at a time that rises; None: ``fallback``."""
        self._settle(time_seconds)
        self._smoother.push(time_seconds, self._accepted)
        return self._smoother.at(time_seconds)


def _same(one: float, other: float) -> bool:
    if math.isnan(one) or math.isnan(other):
        return math.isnan(one) and math.isnan(other)
    return abs(one - other) <= SAME_DIOPTRES
