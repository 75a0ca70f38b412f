"""Non-negative least squares from the normal equations."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["nonnegative_least_squares"]

Float = NDArray[np.float64]

# Of the right side: a gradient below it is rounding.
GRADIENT_END = 1e-10


def nonnegative_least_squares(gram: Float, right: Float, /) -> Float:
    """(P,) x ≥ 0 with the least xᵀ·gram·x/2 − rightᵀ·x.

    Lawson & Hanson 1974, algorithm NNLS, on `gram` = AᵀA (P, P) and `right` = Aᵀb (P,) as Bro &
    De Jong 1997. A parameter that no equation has, with 0 on the diagonal, stays 0.
    """
    scale = np.sqrt(np.diag(gram))
    known = scale > 0
    scale = np.where(known, scale, 1.0)
    unit_gram, unit_right = gram / scale / scale[:, None], right / scale
    end = GRADIENT_END * max(float(np.abs(unit_right).max(initial=0.0)), 1e-300)
    x, passive = np.zeros(len(right)), np.zeros(len(right), bool)
    for _ in range(3 * len(right)):
        gradient = unit_right - unit_gram @ x
        waiting = known & ~passive & (gradient > end)
        if not waiting.any():
            break
        passive[int(np.argmax(np.where(waiting, gradient, -np.inf)))] = True
        x = _inner(unit_gram, unit_right, x, passive)
    return x / scale


def _inner(gram: Float, right: Float, x: Float, passive: NDArray[np.bool_]) -> Float:
    """The best x of the passive parameters that keeps all ≥ 0; those that reach 0 leave the set."""
    while True:
        wanted = np.zeros_like(x)
        inside = np.flatnonzero(passive)
        wanted[inside] = np.linalg.solve(gram[np.ix_(inside, inside)], right[inside])
        negative = passive & (wanted <= 0)
        if not negative.any():
            return wanted
        step = np.min(x[negative] / (x[negative] - wanted[negative]))
        x = x + step * (wanted - x)
        passive &= ~(negative & (x <= 1e-15 * max(1.0, float(np.abs(x).max()))))
        x[~passive] = 0
