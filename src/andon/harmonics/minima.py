"""The smallest value that a sum of harmonics takes on the sphere.

Up to band 2 it is a quadratic on a sphere, q(n) = nᵀQn + 2bᵀn + c, and its minimum is that of a
concave function of one number (Lagrange's dual; there is no gap): the largest, over λ below Q's
smallest eigenvalue, of c + λ − bᵀ(Q − λ)⁻¹b. Any λ gives a lower bound, so the answer errs to one
side only. Above band 2 it is looked for: the best of 2,562 directions, then parabolas fitted around
them.

Source: Moré & Sorensen 1983 (the same dual, for trust regions).
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.harmonics.basis import MAX_ORDER, basis, order_of

__all__ = ["lowest", "minimum", "quadratic_forms", "quadratic_minimum", "sampled"]

Float = NDArray[np.float64]

# The dual is flat at its maximum: λ to 2⁻³⁰ of its range gives the value to rounding.
_HALVINGS = 30
# Rows of values at all directions that are made at once: 40 MB.
_ROWS = 2000
# Starting points that are followed; how often parabolas are fitted, each time 4 × finer, and the
# first one's step in radians, below the spacing of the starting points.
_STARTS, _FITS, _STEP = 3, 7, 0.05


def minimum(series: NDArray[Any], /) -> Float:
    """(...) the smallest value over the sphere of Σ series·Y, of coefficients (..., k).

    Up to order 2 a lower bound that is exact to rounding; above, the value at the best direction
    found: exact to about 1e-10 of the largest coefficient.
    """
    given = np.asarray(series, np.float64)
    order = order_of(given.shape[-1])
    rows = given.reshape(-1, given.shape[-1])
    if order <= 2 or not rows[:, 9:].any():
        constant, linear, values = quadratic_forms(rows)
        found = quadratic_minimum(constant, linear, values)
    else:
        found = np.concatenate([_searched(rows[i : i + _ROWS]) for i in range(0, len(rows), _ROWS)])
    return found.reshape(given.shape[:-1])


def quadratic_forms(rows: Float, /) -> tuple[Float, Float, Float]:
    """c (n,), b (n, 3) in Q's frame and Q's eigenvalues (n, 3), rising, of series (n, 1, 4 or 9).

    Q is band 2 alone and has no trace.
    """
    full = np.zeros((len(rows), 9))
    full[:, : min(9, rows.shape[1])] = rows[:, :9]
    scale = basis(np.eye(3))  # x, y, z
    constant = full[:, 0] * scale[0, 0]
    linear = full[:, [3, 1, 2]] * (scale[0, 3] / 2)
    form = np.empty((len(rows), 3, 3))
    cross = np.sqrt(15 / (16 * np.pi))
    form[:, 0, 1] = form[:, 1, 0] = full[:, 4] * cross
    form[:, 1, 2] = form[:, 2, 1] = full[:, 5] * cross
    form[:, 0, 2] = form[:, 2, 0] = full[:, 7] * cross
    on_axes = full[:, [6, 8]] @ scale[:, [6, 8]].T
    for axis in range(3):
        form[:, axis, axis] = on_axes[:, axis]
    values, vectors = np.linalg.eigh(form)
    return constant, np.einsum("ni,nij->nj", linear, vectors), values


def quadratic_minimum(constant: Float, linear: Float, values: Float, /) -> Float:
    """(n,) a lower bound, exact to rounding, of Σ values·n² + 2 linear·n + constant on |n| = 1.

    `values` (n, 3) rise. The distance of λ below the first lies between |b₁| and |b|, where the
    derivative of the dual, 1 − |(Q − λ)⁻¹b|², changes its sign.
    """
    above = values - values[:, :1]
    square = linear * linear
    near: Float = np.abs(linear[:, 0])
    far: Float = np.linalg.norm(linear, axis=1)
    for _ in range(_HALVINGS):
        middle = (near + far) / 2
        too_near = (_over(square, (above + middle[:, None]) ** 2)).sum(axis=1) > 1
        near, far = np.where(too_near, middle, near), np.where(too_near, far, middle)
    return constant + values[:, 0] - far - _over(square, above + far[:, None]).sum(axis=1)


def _over(square: Float, divisor: Float) -> Float:
    """Quotients, 0 where the numerator is."""
    return np.divide(square, divisor, out=np.zeros_like(square), where=square > 0)


def sampled(rows: Float, /) -> tuple[Float, Float]:
    """(n, m) values of series (n, k) at the (m, 3) directions that a search starts from."""
    grid, values = _spiral()
    return rows @ values[:, : rows.shape[1]].T, grid


def lowest(rows: Float, starts: Float, /) -> tuple[Float, Float]:
    """(n,) smallest values of series (n, k) found from `starts` (n, j, 3), and (n, 3) where."""
    count = starts.shape[1]
    series, at, step = np.repeat(rows, count, axis=0), starts.reshape(-1, 3), _STEP
    for _ in range(_FITS):
        at = _fitted(series, at, step)
        step /= 4
    order = order_of(rows.shape[1])
    value = np.einsum("nk,nk->n", basis(at, order), series).reshape(-1, count)
    best, each = value.argmin(axis=1), np.arange(len(rows))
    return value[each, best], at.reshape(-1, count, 3)[each, best]


def _searched(rows: Float) -> Float:
    """(n,) smallest values found of series (n, k)."""
    values, grid = sampled(rows)
    starts = np.argpartition(values, _STARTS, axis=1)[:, :_STARTS]
    return np.minimum(lowest(rows, grid[starts])[0], values.min(axis=1))


def _fitted(series: Float, at: Float, step: float) -> Float:
    """(n, 3) directions at the vertex of the parabola through nine points around `at` (n, 3).

    Held within two steps; where it is no bowl, the best of the nine.
    """
    side = np.cross(at, np.eye(3)[np.abs(at).argmin(axis=1)])
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    frame = np.stack([side, np.cross(at, side)], axis=1)
    grid = np.array([(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1)], np.float64)
    around = _unit(at[:, None] + step * np.einsum("si,nij->nsj", grid, frame))
    values = basis(around, order_of(series.shape[1]))
    value = np.einsum("nsk,nk->ns", values, series)
    # Least squares on 3 × 3 points: slopes p, q; curvatures a, b and the mixed one m.
    p, q = (value @ grid / 6).T
    a, b = (value @ (grid * grid - 2 / 3)).T
    m = value @ (grid[:, 0] * grid[:, 1]) / 4
    determinant = a * b - m * m
    bowl = (determinant > 0) & (a > 0)
    safe = np.where(bowl, determinant, 1.0)
    move = np.stack([m * q - b * p, m * p - a * q], axis=1) / safe[:, None]
    best = grid[value.argmin(axis=1)]
    move = np.where(bowl[:, None], np.clip(move, -2, 2), best)
    return _unit(at + step * np.einsum("ni,nij->nj", move, frame))


def _unit(vectors: Float) -> Float:
    length: Float = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / length


@cache
def _spiral() -> tuple[Float, Float]:
    """(n, 3) directions on a Fibonacci spiral, 4° apart, and (n, 25) their harmonics."""
    count = 2562
    height = 1 - (2 * np.arange(count) + 1) / count
    azimuth = np.arange(count) * (np.pi * (3 - np.sqrt(5)))
    radius = np.sqrt(1 - height * height)
    points = np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), height], axis=1)
    return points, basis(points, MAX_ORDER)
