"""1/f: slopes of the flicker's spectrum, and how long it does without a period.

2¹⁹ iterations, Welch's method with segments of 2¹⁶ under Hann's window that overlap by half, a
straight line through log power over log frequency from 1e-4 to 1e-2 per iteration; the mean power
of four orbits, whose single slopes scatter by 0.03. The stated slopes are the specification's.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.lamps.flicker import Flicker, invariant_density
from andon.verify.registry import Row

__all__ = ["ROWS"]

Float = NDArray[np.float64]

ITERATIONS, SEGMENT, BAND = 1 << 19, 1 << 16, (1e-4, 1e-2)
STATED = {1.6: -0.50, 1.8: -0.72}


def _orbits(z: float, streams: int, iterations: int) -> Float:
    """(streams, iterations) states themselves: at whole iterations a second, without spline."""
    return Flicker(1, z, 1.0, streams).states(np.arange(iterations))


def _slope(z: float) -> float:
    signal = _orbits(z, 4, ITERATIONS)
    starts = range(0, ITERATIONS - SEGMENT + 1, SEGMENT // 2)
    window = np.hanning(SEGMENT + 1)[:-1]
    power = np.zeros(SEGMENT // 2 + 1)
    for start in starts:
        part = signal[:, start : start + SEGMENT]
        spectrum = np.fft.rfft(window * (part - part.mean(axis=1, keepdims=True)))
        power += (np.abs(spectrum) ** 2).sum(axis=0)
    frequency = np.arange(len(power)) / SEGMENT
    band = (frequency >= BAND[0]) & (frequency <= BAND[1])
    return float(np.polyfit(np.log(frequency[band]), np.log(power[band]), 1)[0])


def _from_stated(z: float) -> float:
    return abs(_slope(z) - STATED[z])


def _least_period() -> float:
    """Iterations after which a state comes again; those that were looked at where none does."""
    orbit = _orbits(1.8, 1, ITERATIONS)[0]
    order = np.argsort(orbit, kind="stable")
    same = np.diff(orbit[order]) == 0
    return float(np.diff(order)[same].min()) if same.any() else float(ITERATIONS)


def _mean() -> float:
    states = Flicker(1, 1.6, 1.0, 4000).states(np.arange(0, 2000, 4))
    return abs(float(states.mean()) / invariant_density(1.6).mean - 1)


ROWS = (
    *(
        Row(
            f"glare.flicker.slope.z{z:g}",
            "glare",
            0.15,
            "of the slope",
            f"the stated slope {slope:g} of the spectrum",
            lambda z=z: _from_stated(z),
        )
        for z, slope in STATED.items()
    ),
    Row(
        "glare.flicker.period",
        "glare",
        1e5,
        "iterations",
        "no state comes again",
        _least_period,
        at_least=True,
    ),
    Row(
        "glare.flicker.mean",
        "glare",
        0.01,
        "of the mean",
        "the mean of 4000 orbits",
        _mean,
    ),
)
