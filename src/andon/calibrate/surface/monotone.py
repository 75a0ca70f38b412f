"""Isotonic regression: the rising sequence nearest to one that does not rise everywhere."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["isotonic", "strictly_rising"]

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
