"""Deringing: the least smoothing that keeps a light from going negative, probe by probe.

A few bands cannot draw a small bright light: they overshoot, and opposite to a lamp irradiance
goes below zero. To dim high bands cures it, but how much is needed depends on the light. So each
probe gets its own: the factor of band l is s^(l(l+1)/2), and s the largest in 0…1 that keeps the
minimum over the sphere, of all three channels, at or above 0.

==================== ============ ============ ===================================================
way to dim           irradiance   at its peak  why (not)
                     of a delta   (closed: 1)
                     light, least
==================== ============ ============ ===================================================
none                 −0.040       1.06         rings
Hann, 3 bands wide   −0.047       0.70         dims band 2, which had filled part of band 1's dip
Hann of own width    0            0.50         only 2 bands: its minimum falls again in between, so
                                               that a search for the width may stop anywhere
**heat, own s**      0            0.84         the minimum never falls as s does
==================== ============ ============ ===================================================

These factors are those of the heat equation on the sphere, s = exp(−2·time). Its kernel is
positive, so an average is taken over directions: the minimum can only rise, the maximum only fall,
and halving finds s. Nothing is dimmed that needs it not: such a probe comes back bit for bit.

Sources: Sloan 2017 (a window for each probe, the minimum of its quadratic); Sloan 2008 (windows).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.harmonics.basis import basis, order_of
from andon.harmonics.irradiance import cosine_factors
from andon.harmonics.minima import (
    lowest,
    minimum,
    quadratic_forms,
    quadratic_minimum,
    sampled,
)

__all__ = ["Target", "deringed", "heat_factors", "smallest", "smoothing"]

Float = NDArray[np.float64]
Target = Literal["irradiance", "luminance"]

# A minimum this much below 0, as a share of the mean, is rounding.
ROUNDING = 1e-12
_HALVINGS = 44
# Times that a direction is looked for anew, and series that are looked at together: 40 MB.
_ROUNDS = 5
_ROWS = 2000


def heat_factors(smoothing: NDArray[Any] | float, order: int, /) -> Float:
    """(..., (order + 1)²) factors s^(l(l+1)/2) of each coefficient, of `smoothing` (...) in 0…1.

    1 leaves all as it is, 0 leaves the mean.
    """
    bands = np.repeat(np.arange(order + 1), 2 * np.arange(order + 1) + 1)
    return np.asarray(smoothing, np.float64)[..., None] ** (bands * (bands + 1) // 2)


def smallest(coefficients: NDArray[Any], /, target: Target = "irradiance") -> Float:
    """(..., 3) the smallest irradiance in lx, or luminance in cd/m², of light (..., k, 3)."""
    return minimum(np.swapaxes(_series(coefficients, target), -1, -2))


def deringed(coefficients: NDArray[Any], /, target: Target = "irradiance") -> Float:
    """Coefficients (..., k, 3), each probe smoothed as little as keeps its target ≥ 0 everywhere.

    `target` is what must not go negative: irradiance, or the luminance that the series itself
    draws (which needs more). Channels are smoothed alike, so that no colour appears. A probe that
    needs nothing is returned bit for bit. Means (band 0) must be ≥ 0.
    """
    given = np.asarray(coefficients, np.float64)
    factors = heat_factors(smoothing(given, target), order_of(given.shape[-2]))
    return given * factors[..., None]


def smoothing(coefficients: NDArray[Any], /, target: Target = "irradiance") -> Float:
    """(...) s of each probe (..., k, 3): 1 where nothing is needed, 0 where the mean is left."""
    series = np.swapaxes(_series(coefficients, target), -1, -2)
    rows = np.ascontiguousarray(series).reshape(-1, series.shape[-1])
    if not np.isfinite(rows).all():
        raise InputError("must be finite", field="coefficients")
    if (rows[:, 0] < 0).any():
        raise InputError(
            "the mean (band 0) must be ≥ 0, got a negative one",
            field="coefficients",
            remedy="dering lights, not their differences",
        )
    needed = minimum(rows) < -ROUNDING * rows[:, 0]
    result = np.ones(len(rows))
    if needed.any():
        if rows[:, 9:].any():
            parts = [_largest_of_any(part) for part in _parts(rows[needed])]
            result[needed] = np.concatenate(parts)
        else:
            result[needed] = _largest_of_quadratics(rows[needed])
    return result.reshape(series.shape[:-1]).min(axis=-1)


def _series(coefficients: NDArray[Any], target: Target) -> Float:
    """(..., k, 3) what must be ≥ 0, as a series."""
    given = np.asarray(coefficients, np.float64)
    order = order_of(given.shape[-2])
    if target == "irradiance":
        return given * cosine_factors(order)[:, None]
    if target == "luminance":
        return given
    raise InputError(f"must be irradiance or luminance, got {target!r}", field="target")


def _parts(rows: Float) -> Iterator[Float]:
    return (rows[start : start + _ROWS] for start in range(0, len(rows), _ROWS))


def _largest_of_quadratics(rows: Float) -> Float:
    """(n,) the largest s that keeps series (n, ≤ 9), whose minima are negative, at or above 0."""
    constant, linear, values = quadratic_forms(rows)

    def holds(s: Float) -> NDArray[np.bool_]:
        dimmed = s[:, None] * linear, (s * s * s)[:, None] * values
        return quadratic_minimum(constant, *dimmed) >= 0

    return _halved(holds, len(rows))


def _largest_of_any(rows: Float) -> Float:
    """As `_largest_of_quadratics` for series (n, k) of any order.

    First for fixed directions alone; then the direction is found where that is not enough, s is
    lowered until it is there, and so on. Every s is too large, by less each time.
    """
    order = order_of(rows.shape[1])
    s = _halved(lambda s: sampled(rows * heat_factors(s, order))[0].min(axis=1) >= 0, len(rows))
    values, grid = sampled(rows * heat_factors(s, order))
    at = grid[np.argpartition(values, 2, axis=1)[:, :2]]
    for _ in range(_ROUNDS):
        _, where = lowest(rows * heat_factors(s, order), at)
        terms = rows * basis(where, order)
        found = _halved(
            lambda s, terms=terms: (terms * heat_factors(s, order)).sum(axis=1) >= 0, len(rows)
        )
        s = np.minimum(s, found)
    return s


def _halved(holds: Callable[[Float], NDArray[np.bool_]], count: int) -> Float:
    """(count,) the largest s in 0…1 that holds; what holds at s holds below it."""
    low, high = np.zeros(count), np.ones(count)
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        good = holds(middle)
        low, high = np.where(good, middle, low), np.where(good, high, middle)
    return low
