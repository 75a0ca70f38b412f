"""How the eyes' focus follows what they look at: at a rate, not at once.

After a reaction time that the measured gaze already has in it, accommodation nears its new state
roughly exponentially and is there after 0.56 to 0.64 s (Campbell & Westheimer 1960): a time
constant of a quarter of a second.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Iterable

__all__ = ["Refocusing"]


class Refocusing:
    """The focus in dioptres over time, for targets that are told in the order of their times.

    `seconds` is the time constant; 0: at once. Before the first target is told there is none; the
    eyes start focused on it.
    """

    def __init__(self, seconds: float, targets: Iterable[tuple[float, float]] = ()) -> None:
        self._seconds = seconds
        self._times: list[float] = []
        # Of each change of target: the focus that it starts from, and the target.
        self._changes: list[tuple[float, float]] = []
        for time_seconds, dioptres in targets:
            self.look(time_seconds, dioptres)

    def look(self, time_seconds: float, dioptres: float, /) -> None:
        """From `time_seconds` on the eyes want to focus on `dioptres`."""
        if not self._changes:
            self._add(time_seconds, dioptres, dioptres)
        elif dioptres != self._changes[-1][1]:
            self._add(time_seconds, self.at(time_seconds), dioptres)

    def at(self, time_seconds: float, /) -> float:
        """The focus in dioptres at a time; before the first target that target."""
        number = max(bisect_right(self._times, time_seconds) - 1, 0)
        start, target = self._changes[number]
        passed = max(time_seconds - self._times[number], 0.0)
        left = 0.0 if self._seconds == 0 else math.exp(-passed / self._seconds)
        return target + (start - target) * left

    def _add(self, time_seconds: float, start: float, target: float) -> None:
        self._times.append(time_seconds)
        self._changes.append((start, target))
