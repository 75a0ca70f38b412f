"""Robust nonlinear least squares of few unknowns: Levenberg–Marquardt with Huber's weights.

Levenberg 1944, Marquardt 1963; weights by Huber 1964, renewed at every step. Problems here have at
most four unknowns and residuals that cost next to nothing, so the Jacobian is by central
differences: an error of 1e-9 in it slows convergence, and does not move the solution.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Solution", "huber_cost", "jacobian", "minimise"]

Float = NDArray[np.float64]
Residuals = Callable[[Float], Float]

# Where a residual in standard deviations begins to count by its size instead of its square: 95 %
# as efficient as squares where errors are normal (Huber 1981, section 4.5).
HUBER = 1.345
MOST_STEPS = 100
IMPOSSIBLE = 1e100
STEP_TOLERANCE, COST_TOLERANCE = 1e-14, 1e-13
DIFFERENCE = 1e-6


@dataclass(frozen=True)
class Solution:
    """Unknowns (n,), residuals (m,) and Jacobian (m, n) there, and half the robust cost."""

    values: Float
    residuals: Float
    jacobian: Float
    cost: float


def huber_cost(residuals: Float, /) -> float:
    """Σρ of residuals in standard deviations; ∞ where one is not finite."""
    size = np.abs(residuals)
    if not (size < IMPOSSIBLE).all():
        return float("inf")
    return float(np.where(size <= HUBER, size**2 / 2, HUBER * (size - HUBER / 2)).sum())


def jacobian(residuals: Residuals, at: Float, /) -> Float:
    """(m, n) by central differences."""
    columns: list[Float] = []
    for index in range(len(at)):
        step = np.zeros(len(at))
        step[index] = DIFFERENCE * max(1.0, abs(at[index]))
        columns.append((residuals(at + step) - residuals(at - step)) / (2 * step[index]))
    return np.stack(columns, axis=1)


def minimise(residuals: Residuals, start: Float, /) -> Solution:
    """The unknowns (n,) near `start` at which the robust sum of `residuals` (m,) is least.

    Residuals are in standard deviations; NaN says that unknowns are impossible, and is stepped
    back from. `start` must be possible.
    """
    at, damping = np.asarray(start, np.float64), 1e-3
    now = residuals(at)
    cost, slope = huber_cost(now), jacobian(residuals, at)
    for _ in range(MOST_STEPS):
        weight = np.minimum(1, HUBER / np.maximum(np.abs(now), 1e-300))
        normal = slope.T @ (weight[:, None] * slope)
        gradient = slope.T @ (weight * now)
        if not np.isfinite(normal).all():  # at the very edge of what is possible
            break
        # An unknown that nothing depends on stays where it is.
        scale = np.maximum(np.diag(normal), 1e-12 * normal.max() + 1e-300)
        step = np.linalg.solve(normal + damping * np.diag(scale), -gradient)
        found = residuals(at + step)
        better = huber_cost(found)
        if not better < cost:
            if damping > 1e10 or np.abs(step).max() <= STEP_TOLERANCE * (1 + np.abs(at).max()):
                break
            damping *= 10
            continue
        done = cost - better <= COST_TOLERANCE * cost
        at, now, cost, damping = at + step, found, better, max(damping / 10, 1e-14)
        if done:
            break
        slope = jacobian(residuals, at)
    return Solution(at, now, jacobian(residuals, at), cost)
