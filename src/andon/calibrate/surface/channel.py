"""One channel of a surface: texture and curve in turn, robust, in relative errors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["ChannelFit", "fit_channel"]

Float = NDArray[np.float64]
Mask = NDArray[np.bool_]

# Of the brightest value: below, noise does not shrink with the signal any more.
FLOOR = 0.05
# Bisquare: 95 % efficient for Gaussian noise (Beaton & Tukey 1974).
BISQUARE, MAD_TO_SIGMA = 4.685, 1.4826
# Where the data say nothing, and only there, the curve is as straight as it can be.
STRAIGHTNESS = 1e-4
# Texture and curve in turn, until f moves by less of its range.
ROUNDS, SETTLED = 200, 1e-6


@dataclass(frozen=True)
class ChannelFit:
    """f at the knots as it was fitted, not yet made to rise.

    Attributes
    ----------
    values, errors : (knots,), f and its standard error.
    weights : (knots,) what the data say of each; > 0.
    texture : (pixels,), mean 1 over pixels that several photographs know.
    relative : (pixels, photographs) residual; NaN where nothing is known.
    outliers : (pixels, photographs) without weight.
    rms : of `relative`, outliers left out, corrected for the parameters.
    """

    values: Float
    errors: Float
    weights: Float
    texture: Float
    relative: Float
    outliers: Mask
    rms: float


def fit_channel(linear: Float, lux: Float, known: Mask, knots: Float, /) -> ChannelFit:
    """f at `knots` lx (n,), rising, from (pixels, photographs) of linear values and lx."""
    basis = _Basis(knots, np.where(known, lux, knots[0]))
    y = np.where(known, linear, 0.0)
    told = known.sum(axis=1) > 1
    if linear.shape[1] > 1:
        known = known & told[:, None]
    floor = FLOOR * float(np.percentile(y[known], 99))
    texture = np.ones(len(y))
    weight = known.astype(float)
    values, matrix = basis.solve(y, texture, weight / floor**2)
    for _ in range(ROUNDS):
        before = values
        shape = basis.at(values)
        if linear.shape[1] > 1:
            texture = _texture(y, shape, weight, floor, texture, told)
        predicted = texture[:, None] * shape
        noise = np.maximum(predicted, 0) + floor
        relative = (y - predicted) / noise
        weight = known * _bisquare(relative, known)
        values, matrix = basis.solve(y, texture, weight / noise**2)
        if np.abs(values - before).max() <= SETTLED * np.abs(values).max():
            break
    return _result(basis, y, known, texture, values, matrix, floor)


def _texture(
    y: Float, shape: Float, weight: Float, floor: float, texture: Float, told: Mask
) -> Float:
    """(pixels,) a of least relative squares; the mean over pixels that are told is 1."""
    trust = weight / (np.maximum(texture[:, None] * shape, 0) + floor) ** 2
    squares = (trust * shape**2).sum(axis=1)
    found = (trust * shape * y).sum(axis=1) / np.where(squares > 0, squares, 1.0)
    found = np.where(told & (squares > 0), np.maximum(found, 1e-6), 1.0)
    return np.where(told, found / found[told].mean(), 1.0)


def _bisquare(relative: Float, known: Mask) -> Float:
    spread = MAD_TO_SIGMA * float(np.median(np.abs(relative[known])))
    share = relative / (BISQUARE * max(spread, 1e-9))
    return np.where(np.abs(share) < 1, (1 - share**2) ** 2, 0.0)


def _result(
    basis: _Basis,
    y: Float,
    known: Mask,
    texture: Float,
    values: Float,
    matrix: Float,
    floor: float,
) -> ChannelFit:
    predicted = texture[:, None] * basis.at(values)
    relative = (y - predicted) / (np.maximum(predicted, 0) + floor)
    outliers = known & (_bisquare(relative, known) == 0)
    kept = known & ~outliers
    textures = int((kept.sum(axis=1) > 0).sum()) if y.shape[1] > 1 else 0
    free = max(int(kept.sum()) - textures - len(values), 1)
    rms = float(np.sqrt((relative[kept] ** 2).sum() / free))
    errors = rms * np.sqrt(np.diag(np.linalg.inv(matrix)))
    relative = np.where(known, relative, np.nan)
    weights = np.maximum(np.diag(matrix), 1e-12 * np.diag(matrix).max())
    return ChannelFit(values, errors, weights, texture, relative, outliers, rms)


class _Basis:
    """Hat functions over the knots at (pixels, photographs) illuminances."""

    def __init__(self, knots: Float, lux: Float) -> None:
        part = np.clip(np.searchsorted(knots, lux, side="right") - 1, 0, len(knots) - 2)
        self.knots, self.part = knots, part
        self.share = (lux - knots[part]) / (knots[part + 1] - knots[part])

    def at(self, values: Float) -> Float:
        """f, straight between knots."""
        return values[self.part] * (1 - self.share) + values[self.part + 1] * self.share

    def solve(self, y: Float, texture: Float, weight: Float) -> tuple[Float, Float]:
        """f (knots,) of least squares, and the normal matrix (knots, knots)."""
        count = len(self.knots)
        matrix, right = np.zeros((count, count)), np.zeros(count)
        low, high = texture[:, None] * (1 - self.share), texture[:, None] * self.share
        for i, a in ((self.part, low), (self.part + 1, high)):
            right += np.bincount(i.ravel(), (weight * a * y).ravel(), count)
            for j, b in ((self.part, low), (self.part + 1, high)):
                flat = np.bincount((i * count + j).ravel(), (weight * a * b).ravel(), count**2)
                matrix += flat.reshape(count, count)
        matrix += self._straight() * STRAIGHTNESS * np.trace(matrix) / count
        return np.asarray(np.linalg.solve(matrix, right), np.float64), matrix

    def _straight(self) -> Float:
        """Σ (second difference)² over the knots, as shares of their range; f(0) = 0 if dark."""
        place = self.knots / self.knots[-1]
        bend = np.zeros((len(place), len(place)))
        for row, i in enumerate(range(1, len(place) - 1)):
            left, right = place[i] - place[i - 1], place[i + 1] - place[i]
            bend[row, i - 1 : i + 2] = np.array([1 / left, -1 / left - 1 / right, 1 / right]) * min(
                left, right
            )
        return bend.T @ bend
