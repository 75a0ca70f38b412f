"""The quadratic B-spline of light and veil on a lattice, and the filter between them.

A point at a fractional index adds to three cells an axis and a place reads three: seen together, a
level's point-spread function is ``B ∗ P ∗ B``, of variance ½ + var P cells². A spline of one level
*is* a sum of splines of the next, [1 3 3 1]/4 (Unser, Aldroubi and Eden 1993), so light that goes in
at level 1 and is reduced lies as if it had gone in at any level.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["SPLINE_VARIANCE", "TAPS", "TAPS_FIRST", "sigma_cells", "spline_weights", "taps"]

Float = NDArray[np.float64]

# Of the spline that light is put in by and of the one it is read by.
SPLINE_VARIANCE = 0.25


def spline_weights(places: Float, /) -> tuple[NDArray[np.int64], Float]:
    """First index (...) and weights (..., 3) of the cells around fractional indices (...).

    Weights sum to 1, and their first moment is the place itself.
    """
    middle = np.floor(places + 0.5)
    off = places - middle
    weights = np.stack([(0.5 - off) ** 2 / 2, 0.75 - off**2, (0.5 + off) ** 2 / 2], -1)
    return middle.astype(np.int64) - 1, weights


def _half(variance: float, radius: int) -> tuple[float, ...]:
    values = np.exp(-(np.arange(radius + 1) ** 2) / (2 * variance))
    return tuple(float(v) for v in values / (values[0] + 2 * values[1:].sum()))


# P along each axis, the middle tap and those to one side: of level 1, and of all others.
TAPS_FIRST = _half(0.5, 2)
TAPS = _half(1.25, 4)


def taps(level: int, /) -> tuple[float, ...]:
    """The middle tap of P and those to one side, of a level ≥ 1."""
    return TAPS_FIRST if level == 1 else TAPS


def sigma_cells(level: int, /) -> float:
    """σ of a level's point-spread function in its own cells."""
    side = taps(level)[1:]
    return float(
        np.sqrt(2 * SPLINE_VARIANCE + 2 * sum(t * (i + 1) ** 2 for i, t in enumerate(side)))
    )
