"""Amounts of light from pictures of them: robust least squares in linear light.

Each cell i and channel c of the reference is to be

    y_ic = b_ic + Σ_j a_jc · A_jic ,   a_jc ≥ 0

with b what is not fitted and A_j the picture of one unit of term j. Channels share a parameter
where a lamp keeps its colour or dimming is one number.

=============  ====================================================================================
weights        of the noise of both photographs, shot and quantisation: 1/(α + β·L) of the
               reference, plus the same of the photograph, amplified as the light is
outliers       what moved, mirrors or was not modelled: Huber 1964, then Tukey's biweight (Beaton &
               Tukey 1974), in units of the median error of the cells that a unit of light
               changes about as much. With one scale for all, the many cells that no lamp reaches
               would decide that those it does reach, with the errors of any model, are outliers
white end      of the reference only bounds from below: it counts while the prediction is darker
a ≥ 0          non-negative least squares from the normal equations (Lawson & Hanson 1974, chapter
               23; Bro & De Jong 1997)
errors         what is left of a model errs in whole regions: squares of the picture are the
               clusters of a sandwich (Liang & Zeger 1986)
=============  ====================================================================================
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.calibrate.lamps.nonnegative import nonnegative_least_squares

__all__ = ["Problem", "Solution", "noise_variance", "solve"]

Float = NDArray[np.float64]

# Variance of linear values, of white 1: within a factor of 1.9 that of 1.5 codes of 8 bits sRGB,
# what quantisation, compression and a good exposure leave.
NOISE_AT_BLACK, NOISE_PER_LIGHT = 1.3e-7, 1e-4
# Tuning constants with 95 % efficiency for normal errors.
HUBER, TUKEY = 1.345, 4.685
NORMAL_MEDIAN = 0.6745
# Rounds with Huber's weights, which have one solution, before Tukey's, which start from it.
HUBER_ROUNDS, MOST_ROUNDS, END = 12, 60, 1e-6
GROUPS = 12
# Keeps correlations of equal pictures invertible.
LEAST_RIDGE = 1e-9
# Least eigenvalue of the correlations of the terms' pictures, and the least part in its vector:
# two pictures with a correlation of 0.9999 differ by 1.4 %, which no model of a room is good for.
LEAST_EIGENVALUE, LEAST_PART = 1e-4, 0.25


@dataclass(frozen=True, eq=False)
class Problem:
    """Pictures as n cells.

    Attributes
    ----------
    pictures : (J, n, 3) linear values of one unit of each term.
    offset : (n, 3) of what is not fitted.
    wanted : (n, 3) of the reference.
    photograph : (n, 3) of the photograph.
    counts : (n, 3) pixels of each mean.
    is_white : (n,) bool, the reference is at its white end.
    tiles : (n,) int, the square of the picture in which the cell lies.
    free : (J, 3, P), 1 where parameter p is the amount of term j in channel c.
    ridge : (J,) of the diagonal of the normal equations; of terms that make the same picture the
        one with the least gets it.
    """

    pictures: Float
    offset: Float
    wanted: Float
    photograph: Float
    counts: Float
    is_white: NDArray[np.bool_]
    tiles: NDArray[np.intp]
    free: Float
    ridge: Float

    def predicted(self, amounts: Float, /) -> Float:
        """(n, 3) linear values of `amounts` (J, 3)."""
        return self.offset + np.einsum("jnc,jc->nc", self.pictures, amounts)


@dataclass(frozen=True, eq=False)
class Solution:
    """Amounts and what is known of them.

    Attributes
    ----------
    amounts : (J, 3) ≥ 0.
    errors : (J, 3) standard errors; NaN where no cell tells anything.
    told_apart : (J,) bool.
    kept : (n, 3) bool, cells with a number that have any weight.
    rejected_share : of the cells with a number, the others.
    """

    amounts: Float
    errors: Float
    told_apart: NDArray[np.bool_]
    kept: NDArray[np.bool_]
    rejected_share: float


def noise_variance(linear: Float, /) -> Float:
    """Variance of the noise of linear camera values, of white 1."""
    return NOISE_AT_BLACK + NOISE_PER_LIGHT * np.maximum(linear, 0)


def solve(problem: Problem, /) -> Solution:
    """The amounts that explain the reference."""
    groups = _groups(problem)
    amounts = np.zeros(problem.pictures.shape[::2])
    # Cells at the white end wait for a first prediction.
    robust = np.repeat(~problem.is_white[:, None], 3, axis=1).astype(np.float64)
    light = problem.wanted
    for round_ in range(MOST_ROUNDS):
        weights = _weights(problem, light) * robust
        before, amounts = amounts, _least_squares(problem, weights)
        light = problem.predicted(amounts)
        off = _residuals(problem, light) * np.sqrt(_weights(problem, light))
        robust = _robust(off, groups, problem, tukey=round_ >= HUBER_ROUNDS)
        robust[problem.is_white[:, None] & (light >= problem.wanted)] = 0
        if round_ > HUBER_ROUNDS and np.abs(amounts - before).max() < END * amounts.max():
            break
    weights = _weights(problem, light) * robust
    errors, told = _told(problem, weights, _residuals(problem, light))
    numbers = (problem.counts > 0) & ~problem.is_white[:, None]
    kept = numbers & (robust > 0)
    rejected = 1 - float(kept.sum() / max(numbers.sum(), 1))
    return Solution(amounts, errors, told, kept, rejected)


def _residuals(problem: Problem, light: Float) -> Float:
    """Reference less prediction; 0 where a cell at the white end is predicted as bright."""
    off = problem.wanted - light
    return np.where(problem.is_white[:, None], np.maximum(off, 0), off)


def _weights(problem: Problem, light: Float) -> Float:
    """1/variance of the means, with the noise of both photographs."""
    floor = np.sqrt(NOISE_AT_BLACK)
    gain = np.maximum(light, 0) / np.maximum(problem.photograph, floor)
    variance = noise_variance(light) + gain**2 * noise_variance(problem.photograph)
    return problem.counts / variance


def _groups(problem: Problem) -> NDArray[np.intp]:
    """(n, 3) cells in twelve groups of equal size, by how much a unit of all terms changes them."""
    reach = np.abs(problem.pictures).sum(axis=0) / np.sqrt(noise_variance(problem.photograph))
    edges = np.quantile(reach, np.arange(1, GROUPS) / GROUPS)
    return np.asarray(np.searchsorted(edges, reach), np.intp)


def _robust(off: Float, groups: NDArray[np.intp], problem: Problem, /, *, tukey: bool) -> Float:
    """(n, 3) factors 0…1 of the weights, by errors `off` in units of the noise."""
    numbers = (problem.counts > 0) & ~problem.is_white[:, None]
    scale = np.ones(GROUPS)
    for group in range(GROUPS):
        own = numbers & (groups == group)
        if own.any():
            # Never finer than the noise: quantisation has no tails to cut.
            scale[group] = max(1.0, float(np.median(np.abs(off[own]))) / NORMAL_MEDIAN)
    away = np.abs(off) / scale[groups]
    if tukey:
        return np.maximum(1 - (away / TUKEY) ** 2, 0) ** 2
    return HUBER / np.maximum(away, HUBER)


def _normal(problem: Problem, weights: Float) -> tuple[Float, Float]:
    """Gram matrix (P, P) and right side (P,) of the weighted equations."""
    pictures, free = problem.pictures, problem.free
    off = problem.wanted - problem.offset
    gram = np.zeros((free.shape[2],) * 2)
    right = np.zeros(free.shape[2])
    for channel in range(3):
        weighed = pictures[:, :, channel] * weights[:, channel]
        own = free[:, channel]
        gram += own.T @ (weighed @ pictures[:, :, channel].T) @ own
        right += own.T @ (weighed @ off[:, channel])
    return gram, right


def _least_squares(problem: Problem, weights: Float) -> Float:
    gram, right = _normal(problem, weights)
    ridge = np.einsum("jcp,j->p", problem.free, problem.ridge) / problem.free.sum(axis=(0, 1))
    found = nonnegative_least_squares(gram + np.diag(ridge * np.diag(gram)), right)
    return problem.free @ found


def _told(problem: Problem, weights: Float, off: Float) -> tuple[Float, NDArray[np.bool_]]:
    """Standard errors (J, 3), and which terms are told apart from all others (J,)."""
    gram, _ = _normal(problem, weights)
    own = np.sqrt(np.diag(gram))
    known = own > 0
    size = np.where(known, own, 1.0)
    correlations = gram / size / size[:, None] + np.diag(np.where(known, LEAST_RIDGE, 1.0))
    values, vectors = np.linalg.eigh(correlations)
    mixed = (np.abs(vectors[:, values < LEAST_EIGENVALUE]) > LEAST_PART).any(axis=1)
    inverse = np.linalg.inv(correlations) / size / size[:, None]
    scores = _scores(problem, weights * off)
    tiles = len(scores)
    spread = inverse @ (scores.T @ scores) @ inverse * tiles / max(tiles - 1, 1)
    errors = np.where(known, np.sqrt(np.maximum(np.diag(spread), 0)), np.nan)
    is_free = problem.free > 0
    apart: NDArray[np.bool_] = ~np.asarray((is_free & mixed).any(axis=(1, 2)), bool)
    return np.where(is_free, errors, 0).sum(axis=2), apart


def _scores(problem: Problem, pull: Float) -> Float:
    """(tiles, P) derivatives of half the squares, of each tile; `pull` is weight × residual."""
    tiles = int(problem.tiles.max()) + 1 if len(problem.tiles) else 1
    scores = np.zeros((tiles, problem.free.shape[2]))
    for channel in range(3):
        for term, picture in enumerate(problem.pictures[:, :, channel]):
            sums = np.bincount(problem.tiles, picture * pull[:, channel], minlength=tiles)
            scores += sums[:, None] * problem.free[term, channel]
    return scores
