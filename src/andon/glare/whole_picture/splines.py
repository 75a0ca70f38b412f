"""The quadratic B-spline of light and veil on a lattice, and the filter between them.

A point at a fractional index adds to three cells an axis and a place reads three: seen together, a
level's point-spread function is ``B ∗ P ∗ B``, of variance ½ + var P cells². A spline of one level
*is* a sum of splines of the next, [1 3 3 1]/4 (Unser, Aldroubi and Eden 1993), so light that goes
in at level 1 and is reduced lies as if it had gone in at any level.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["SPLINES_VARIANCE", "level_profile", "sigma_cells", "spline_weights", "taps"]

Float = NDArray[np.float64]

# Cells², of the spline that light is put in by and of the one it is read by, together.
SPLINES_VARIANCE = 0.5
# Cells² of level 1: light comes from blocks of two pixels and is read by blocks, with the same
# spline, of a lattice about as fine as level 1.
BLOCKS_VARIANCE = 0.375


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


# P along each axis, the middle tap and those to one side. Of all with taps to three cells these
# make the veil of a point (θ⁻², θ⁻²·⁵, θ⁻³; random places) roundest and steadiest: 1 % of it in
# all. Level 1 needs less, since blocks spread already.
TAPS = _half(1.19, 3)
TAPS_FIRST = _half(0.8, 2)


def taps(level: int, /) -> tuple[float, ...]:
    """The middle tap of P and those to one side, of a level ≥ 1."""
    return TAPS_FIRST if level == 1 else TAPS


def sigma_cells(level: int, /) -> float:
    """σ of a level's point-spread function in its own cells."""
    filtered = 2 * sum(tap * (i + 1) ** 2 for i, tap in enumerate(taps(level)[1:]))
    return float(np.sqrt(SPLINES_VARIANCE + filtered + BLOCKS_VARIANCE / 4 ** (level - 1)))


def level_profile(radii: Float, /) -> Float:
    """(n,) density per cell² of ``B ∗ P ∗ B`` at radii (n,) in cells, mean over all azimuths."""
    azimuth = (np.arange(16) + 0.5) * (np.pi / 4 / 16)
    x, y = radii[:, None] * np.cos(azimuth), radii[:, None] * np.sin(azimuth)
    return np.mean(_along(x) * _along(y), 1)


def _along(x: Float) -> Float:
    sums = [TAPS[abs(n)] * _quintic(x - n) for n in range(-len(TAPS) + 1, len(TAPS))]
    return np.sum(sums, 0)


def _quintic(x: Float) -> Float:
    """B ∗ B: the B-spline of degree 5, of six boxes."""
    binomial = (1, -6, 15, -20, 15, -6, 1)
    powers = [b * np.maximum(x + 3 - k, 0) ** 5 for k, b in enumerate(binomial)]
    # The sum of powers loses what lies beyond its support to rounding.
    return np.where(np.abs(x) < 3, np.sum(powers, 0) / 120, 0.0)
