"""A filter with a memory of when it last saw something: never a NaN, always a state.

::

    good samples  ▪▪▪▪▪▪▪▪▪                          ▪▪▪▪▪
    rejected               ▫▫▫▫▫▫▫▫▫▫▫▫▫▫▫▫▫▫▫▫▫▫▫▫▫
    state         seen     held (hold_seconds) fallback  seen
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.observer.gaze.filters import RESTING_DIOPTRES, Filter
from andon.observer.model import GazeState

__all__ = ["SEEN_SECONDS", "Smoothed", "Smoother", "smoothed", "state_of"]

Float = NDArray[np.float64]

# A good sample stands for what is seen now until it is as old as this: slow trackers (7 Hz) do not
# flicker between seen and held. The eyes need as long to move elsewhere.
SEEN_SECONDS = 0.2
# After as long without a good sample a filter starts anew: what was looked at then says nothing.
FORGET_SECONDS = 0.5
# A clock that goes back by more was set anew; by less, the sample came late and is passed over.
CLOCK_RESET_SECONDS = 1.0


def state_of(age_seconds: float, hold_seconds: float, *, last_was_good: bool) -> GazeState:
    """What a fixation is worth `age_seconds` after its last good sample."""
    if age_seconds > hold_seconds:
        return "fallback"
    return "seen" if last_was_good and age_seconds <= SEEN_SECONDS else "held"


class Smoother:
    """Takes samples as they come, good or NaN, and answers for any later time.

    Attributes
    ----------
    ignored : samples whose time was repeated, went back a little, or was no number.
    restarts : how often the clock was set back.
    """

    def __init__(self, form: Filter, hold_seconds: float = 0.5) -> None:
        self._filter, self._hold = form, hold_seconds
        self._time = self._last_good = -math.inf
        self._was_good = False
        self.dioptres = RESTING_DIOPTRES
        self.ignored = self.restarts = 0

    @property
    def last_good(self) -> float:
        """Time of the last good sample; −∞ before the first."""
        return self._last_good

    def push(self, time_seconds: float, dioptres: float, /) -> float:
        """The smoothed vergence after a sample; NaN and infinity are no samples."""
        if not self._passes(time_seconds):
            self.ignored += 1
            return self.dioptres
        self._was_good = math.isfinite(dioptres)
        if self._was_good:
            if time_seconds - self._last_good > max(self._hold, FORGET_SECONDS):
                self._filter.reset()
            self._last_good = time_seconds
            self.dioptres = self._filter.update(time_seconds, dioptres)
        return self.dioptres

    def _passes(self, time_seconds: float) -> bool:
        if not math.isfinite(time_seconds):
            return False
        if time_seconds <= self._time:
            if self._time - time_seconds <= CLOCK_RESET_SECONDS:
                return False
            self.restarts += 1
            self._last_good = -math.inf
        self._time = time_seconds
        return True

    def at(self, time_seconds: float, /) -> tuple[float | None, GazeState]:
        """The vergence in dioptres, None where the state is ``fallback``."""
        age = max(time_seconds - self._last_good, 0.0)
        state = state_of(age, self._hold, last_was_good=self._was_good)
        return (None if state == "fallback" else self.dioptres), state


@dataclass(frozen=True, eq=False)
class Smoothed:
    """A smoothed series.

    Attributes
    ----------
    times_seconds : (n,) rising.
    dioptres : (n,) finite, after each sample; `RESTING_DIOPTRES` before the first good one.
    good : (n,) bool, which samples were.
    last_good : (n,) time of the last good sample so far; −∞ before the first.
    hold_seconds : for `at`.
    """

    times_seconds: Float
    dioptres: Float
    good: NDArray[np.bool_]
    last_good: Float
    hold_seconds: float

    def at(self, time_seconds: float, /) -> tuple[float | None, GazeState]:
        """The vergence and its state, of the samples up to that time; None: ``fallback``."""
        index = int(np.searchsorted(self.times_seconds, time_seconds, side="right")) - 1
        if index < 0:
            return None, "fallback"
        age = time_seconds - float(self.last_good[index])
        state = state_of(age, self.hold_seconds, last_was_good=bool(self.good[index]))
        return (None if state == "fallback" else float(self.dioptres[index])), state


def smoothed(
    times_seconds: Float, dioptres: Float, form: Filter, /, *, hold_seconds: float = 0.5
) -> Smoothed:
    """The whole of a (n,) rising series at once, NaN where there is no sample.

    The same as pushing the samples one by one: what is known at a time rests on the past alone.
    """
    smoother = Smoother(form, hold_seconds)
    out, last = np.empty(len(times_seconds)), np.empty(len(times_seconds))
    for index, (time, value) in enumerate(
        zip(times_seconds.tolist(), dioptres.tolist(), strict=True)
    ):
        out[index] = smoother.push(time, value)
        last[index] = smoother.last_good
    return Smoothed(times_seconds, out, np.isfinite(dioptres), last, hold_seconds)
