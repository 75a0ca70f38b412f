"""Rising sequences nearest to ones that do not rise everywhere, and smooth curves through them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["LEAST_STEP", "isotonic", "smooth_between", "strictly_rising"]

Float = NDArray[np.float64]

# Steps of a curve that must rise, as a share of its range: above the noise of float32.
LEAST_STEP = 1e-6


def isotonic(values: Float, weights: Float, /) -> tuple[Float, NDArray[np.int64]]:
    """The least-squares rising sequence (n,), and the block (n,) that each value was pooled into.

    Pools adjacent violators: neighbours that fall, or are equal, become their weighted mean.
    `weights` > 0. Source: Ayer et al. 1955.
    """
    means: list[float] = []
    totals: list[float] = []
    sizes: list[int] = []
    for value, weight in zip(values.tolist(), weights.tolist(), strict=True):
        mean, total, size = value, weight, 1
        while means and means[-1] >= mean:
            mean = (means.pop() * totals[-1] + mean * total) / (totals[-1] + total)
            total, size = total + totals.pop(), size + sizes.pop()
        means.append(mean)
        totals.append(total)
        sizes.append(size)
    return np.repeat(means, sizes), np.repeat(np.arange(len(sizes)), sizes)


def strictly_rising(x: Float, y: Float, weights: Float, /) -> Float:
    """(n,) y at x, strictly rising: through the middles of the blocks that isotonic pools.

    A level block would have no inverse; its neighbours say how steeply to cross it.
    """
    means, blocks = isotonic(y, weights)
    total = np.bincount(blocks, weights)
    middles = np.bincount(blocks, weights * x) / total
    levels = np.bincount(blocks, weights * means) / total
    risen = np.interp(x, middles, levels) if len(levels) > 1 else means
    steps = np.maximum(np.diff(risen), LEAST_STEP * max(float(np.ptp(y)), float(np.abs(y).max())))
    return np.concatenate([risen[:1], risen[0] + np.cumsum(steps)])


def smooth_between(x: Float, y: Float, parts: int, /) -> tuple[Float, Float]:
    """Knots (n,), strictly rising in both, with `parts` − 1 more between each two.

    Piecewise cubic through the knots, rising wherever they rise, and straight where they lie on a
    line: slopes are weighted harmonic means of their neighbours'. Source: Fritsch & Butland 1984.
    """
    if len(x) < 3:
        return x, y
    steps, rises = np.diff(x), np.diff(y) / np.diff(x)
    before, after = 2 * steps[1:] + steps[:-1], steps[1:] + 2 * steps[:-1]
    inner = (before + after) / (before / rises[:-1] + after / rises[1:])
    slopes = np.concatenate(
        [[_end_slope(steps, rises)], inner, [_end_slope(steps[::-1], rises[::-1])]]
    )
    share = np.arange(parts) / parts
    low, high = (1 - share) ** 2, share**2
    ends = low * (1 + 2 * share), high * (3 - 2 * share)
    values = y[:-1, None] * ends[0] + y[1:, None] * ends[1]
    turns = slopes[:-1, None] * low * share - slopes[1:, None] * high * (1 - share)
    places = x[:-1, None] + steps[:, None] * share
    values = values + steps[:, None] * turns
    return np.append(places.ravel(), x[-1]), np.append(values.ravel(), y[-1])


def _end_slope(steps: Float, rises: Float) -> float:
    """Of the parabola through the first three knots, where it keeps the curve rising."""
    slope = ((2 * steps[0] + steps[1]) * rises[0] - steps[0] * rises[1]) / (steps[0] + steps[1])
    return float(np.clip(slope, 0, 3 * rises[0]))
