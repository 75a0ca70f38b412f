"""Rotation of coefficients, exact for all bands.

The matrix of band l is D_jk = ∫ Y_j(d)·Y_k(R⁻¹d): a polynomial of degree 2l, so a Gauss–Legendre ×
Fourier sum of enough points is the integral itself. 45 points serve all bands up to 4. Recursions
over bands (Ivanic & Ruedenberg 1996, with the corrections of 1998) cost less where there are
hundreds of bands; for five of them they are more text and no more digits.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.harmonics.basis import MAX_ORDER, basis, order_of
from andon.spaces import ROTATION_TOLERANCE

__all__ = ["rotated", "rotation_matrix"]

Float = NDArray[np.float64]


def rotation_matrix(rotation: NDArray[Any], order: int = 2, /) -> Float:
    """D (..., k, k), k = (order + 1)², of rotations (..., 3, 3): c' = D·c.

    A light that arrives from d arrives from R·d afterwards. D is orthogonal, and block-diagonal:
    bands do not mix.
    """
    turn = np.asarray(rotation, np.float64)
    _check(turn)
    directions, weights = _quadrature()
    fixed = basis(directions, order) * weights[:, None]
    moved = basis(directions @ turn, order)
    matrix = fixed.T @ moved
    bands = np.repeat(np.arange(order + 1), 2 * np.arange(order + 1) + 1)
    return np.where(bands[:, None] == bands, matrix, 0.0)


def rotated(coefficients: NDArray[Any], rotation: NDArray[Any], /) -> Float:
    """Coefficients (..., k, 3) of the same light, turned by `rotation` (..., 3, 3).

    Leading shapes broadcast. Rotations are column matrices: d' = R·d.
    """
    given = np.asarray(coefficients, np.float64)
    return rotation_matrix(rotation, order_of(given.shape[-2])) @ given


def _check(turn: Float) -> None:
    if turn.shape[-2:] != (3, 3):
        raise InputError(f"must be (..., 3, 3), got {turn.shape}", field="rotation")
    # NaN fails as well.
    off = np.abs(turn @ np.swapaxes(turn, -1, -2) - np.eye(3))
    if not (off <= ROTATION_TOLERANCE).all() or not (np.linalg.det(turn) > 0).all():
        raise InputError("must be orthonormal and right-handed", field="rotation")


@cache
def _quadrature() -> tuple[Float, Float]:
    """(n, 3) directions and (n,) weights, exact for polynomials of degree 2·MAX_ORDER."""
    cosine, share = np.polynomial.legendre.leggauss(MAX_ORDER + 1)
    count = 2 * MAX_ORDER + 1
    azimuth = np.arange(count) * (2 * np.pi / count)
    sine = np.sqrt(1 - cosine * cosine)
    directions = np.stack(
        [
            np.outer(sine, np.cos(azimuth)),
            np.outer(sine, np.sin(azimuth)),
            np.outer(cosine, np.ones(count)),
        ],
        axis=-1,
    )
    weights = np.repeat(share * (2 * np.pi / count), count)
    return directions.reshape(-1, 3), weights
