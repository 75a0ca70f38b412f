"""Smoothing of vergence over time, one sample after the other.

========== ============================================================ ===========================
filter     what                                                         why
========== ============================================================ ===========================
none       the last sample                                              to compare
paper      mean of the last 20 depths in *metres*                       the paper, equation 8
mean       mean of the last 20 in dioptres                              to compare
one-euro   low pass whose cutoff rises with speed, in dioptres          still at rest, quick on a
                                                                        change; any sampling rate
========== ============================================================ ===========================

In dioptres, since that is what noise is symmetric in: ±0.5° of vergence at 1 m is 0.88…1.16 m but
±0.14 D on both sides. A mean in metres lies too far away, and one sample near infinity moves it for
20 samples. The mean of N samples lags (N − 1)/2 of their intervals, 0.317 s for 20 at 30 Hz.

Every filter takes NaN as "no sample", never gives one, and starts anew after `reset`.

Sources: the paper on glass by gaze, equation 8; Casiez et al. 2012.
"""

from __future__ import annotations

import math
from collections import deque
from typing import Literal, Protocol

from andon.errors import InputError
from andon.scene.eye import Gaze

__all__ = [
    "FILTERS",
    "RESTING_DIOPTRES",
    "Filter",
    "FilterName",
    "MovingMean",
    "OneEuro",
    "Unfiltered",
    "filter_of",
    "make_filter",
]

FilterName = Literal["none", "paper", "mean", "one-euro"]
FILTERS: tuple[FilterName, ...] = ("none", "paper", "mean", "one-euro")
# What is said before anything was seen: eyes without a target converge on about a metre.
RESTING_DIOPTRES = 1.0
# Cutoff of the speed that opens the filter, Hz: Casiez et al. 2012 keep it at 1.
SPEED_CUTOFF_HZ = 1.0


class Filter(Protocol):
    """Something that smooths a series."""

    def update(self, time_seconds: float, dioptres: float, /) -> float:
        """The smoothed vergence after a sample at a later time; NaN: there was none."""
        ...

    def reset(self) -> None:
        """Forget all samples; what was given last is held until the next one."""
        ...


class Unfiltered:
    """The last sample."""

    def __init__(self) -> None:
        self._last = RESTING_DIOPTRES

    def update(self, time_seconds: float, dioptres: float, /) -> float:
        """The sample, or the last one for NaN."""
        if not math.isnan(dioptres):
            self._last = dioptres
        return self._last

    def reset(self) -> None:
        """Nothing to forget."""


class MovingMean:
    """Mean of the last `samples` good samples, in metres or in dioptres.

    In metres it is the paper's equation 8. Rejected samples are left out, so it is of the last 20
    that were good; in the beginning of those that there are. A sample at infinity makes a mean in
    metres infinite, 0 D, for as long as it is among them.
    """

    def __init__(self, samples: int = 20, *, in_metres: bool = False) -> None:
        if samples < 1:
            raise InputError(f"must be ≥ 1, got {samples}", field="samples")
        self._in_metres = in_metres
        self._window: deque[float] = deque(maxlen=samples)
        self._last = RESTING_DIOPTRES

    def update(self, time_seconds: float, dioptres: float, /) -> float:
        """The mean in dioptres, with this sample."""
        if math.isnan(dioptres):
            return self._last
        self._window.append(_turned(dioptres) if self._in_metres else dioptres)
        mean = sum(self._window) / len(self._window)
        self._last = _turned(mean) if self._in_metres else mean
        return self._last

    def reset(self) -> None:
        """Empty the window."""
        self._window.clear()


def _turned(value: float) -> float:
    """Dioptres to metres and back; 0 is infinity."""
    return 1 / value if value else math.inf


class OneEuro:
    """The 1 € filter (Casiez et al. 2012, algorithm 1) on irregular samples.

    x̂ ← x̂ + α(fc)·(x − x̂), α(f) = 1/(1 + 1/(2π·f·Δt)), fc = `minimum_cutoff_hz` +
    `speed_coefficient`·|speed|, and the speed (x − x̂)/Δt is itself low-passed at 1 Hz. Δt is that
    since the last *good* sample, so gaps and changing rates need no case of their own.
    """

    def __init__(self, minimum_cutoff_hz: float = 1.0, speed_coefficient: float = 0.5) -> None:
        if not minimum_cutoff_hz > 0 or not speed_coefficient >= 0:
            raise InputError(
                f"needs a cutoff > 0 Hz and a coefficient ≥ 0, got {minimum_cutoff_hz:g} and "
                f"{speed_coefficient:g}",
                field="one-euro",
            )
        self._minimum_cutoff_hz, self._coefficient = minimum_cutoff_hz, speed_coefficient
        self._last, self._speed = RESTING_DIOPTRES, 0.0
        self._time: float | None = None

    def update(self, time_seconds: float, dioptres: float, /) -> float:
        """The smoothed vergence, with this sample."""
        if math.isnan(dioptres):
            return self._last
        passed = 0.0 if self._time is None else time_seconds - self._time
        if self._time is None:
            self._last, self._speed = dioptres, 0.0
        elif passed > 0:
            change = dioptres - self._last
            self._speed += _share(SPEED_CUTOFF_HZ, passed) * (change / passed - self._speed)
            cutoff = self._minimum_cutoff_hz + self._coefficient * abs(self._speed)
            self._last += _share(cutoff, passed) * change
        self._time = time_seconds
        return self._last

    def reset(self) -> None:
        """The next sample is taken as it is."""
        self._time = None


def _share(cutoff_hz: float, seconds: float) -> float:
    """α of a first-order low pass."""
    return 1 / (1 + 1 / (2 * math.pi * cutoff_hz * seconds))


def make_filter(
    name: str,
    /,
    *,
    samples: int = 20,
    minimum_cutoff_hz: float = 1.0,
    speed_coefficient: float = 0.5,
) -> Filter:
    """A new filter by its name, with the scene file's defaults. Raises `InputError`."""
    if name not in FILTERS:
        raise InputError(f"must be one of {', '.join(FILTERS)}, got {name!r}", field="filter")
    if name == "none":
        return Unfiltered()
    if name == "one-euro":
        return OneEuro(minimum_cutoff_hz, speed_coefficient)
    return MovingMean(samples, in_metres=name == "paper")


def filter_of(gaze: Gaze, /) -> Filter:
    """A new filter as [gaze] asks for."""
    return make_filter(
        gaze.filter,
        samples=gaze.samples,
        minimum_cutoff_hz=gaze.minimum_cutoff_hz,
        speed_coefficient=gaze.speed_coefficient,
    )
