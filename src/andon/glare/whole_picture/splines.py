"""The quadratic B-spline of light and veil on a lattice, and the filter between them.

A point at a fractional index adds to three cells an axis and a place reads three: seen together, a
level's point-spread function is ``B ∗ P ∗ B``, of variance ½ + var P cells². A spline of one level
*is* a sum of splines of the next, [1 3 3 1]/4 (Unser 1999), so light that goes
in at level 1 and is reduced lies as if it had gone in at any level.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "BLOCKS_VARIANCE",
    "SPLINES_VARIANCE",
    "filters",
    "level_profile",
    "quintic",
    "sigma_cells",
    "spline_weights",
]

Float = NDArray[np.float64]

# Cells², of the spline that light is put in by and of the one it is read by, together.
SPLINES_VARIANCE = 0.5
# Pixels²: [1 3 3 1]/4 to blocks of two pixels and [3 1]/4 back, together.
BLOCKS_VARIANCE = 1.5


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


# P along each axis, the middle tap and those to one side. The first level has one that does
# nothing, for what lies within two pixels. From level 3 on there are two, the wider √2 of the other
# all in all: a ratio of 2 makes a ripple of 1.2 % (θ⁻²·⁷), one of √2 of 0.1 %, and these levels are
# cheap. The less wide P is, the more a point's veil depends on where in a cell it lies: with these
# by 1 %.
NONE = (1.0,)
FIRST = _half(0.8, 2)
SECOND = _half(1.0, 3)
NARROW = _half(0.8, 3)
WIDE = _half(2.0, 4)


def filters(level: int, /) -> tuple[tuple[float, ...], ...]:
    """One P or two of a level ≥ 1, each as the middle tap and those to one side; each sums to 1."""
    return ((NONE, FIRST), (SECOND,))[level - 1] if level < 3 else (NARROW, WIDE)


def sigma_cells(level: int, which: int, /) -> float:
    """σ of a level's point-spread function with one of its filters, in its own cells; no blocks."""
    side = filters(level)[which][1:]
    filtered = 2 * sum(tap * (i + 1) ** 2 for i, tap in enumerate(side))
    return float(np.sqrt(SPLINES_VARIANCE + filtered))


def level_profile(radii: Float, /) -> Float:
    """(n,) density per cell² of ``B ∗ NARROW ∗ B`` at radii (n,) in cells, mean over azimuths."""
    azimuth = (np.arange(16) + 0.5) * (np.pi / 4 / 16)
    x, y = radii[:, None] * np.cos(azimuth), radii[:, None] * np.sin(azimuth)
    return np.mean(_along(x) * _along(y), 1)


def _along(x: Float) -> Float:
    sums = [NARROW[abs(n)] * quintic(x - n) for n in range(-len(NARROW) + 1, len(NARROW))]
    return np.sum(sums, 0)


def quintic(x: Float, /) -> Float:
    """B ∗ B: the B-spline of degree 5, of six boxes."""
    binomial = (1, -6, 15, -20, 15, -6, 1)
    powers = [b * np.maximum(x + 3 - k, 0) ** 5 for k, b in enumerate(binomial)]
    # The sum of powers loses what lies beyond its support to rounding.
    return np.where(np.abs(x) < 3, np.sum(powers, 0) / 120, 0.0)
