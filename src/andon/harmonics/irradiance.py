"""Irradiance from coefficients: a convolution with the cosine, band by band.

In photometric units: coefficients in cd/m², irradiance (here: illuminance) in lux. A diffuse
surface then has the luminance ρ·E/π; nothing here divides by π.
"""

from __future__ import annotations

from math import pi, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.harmonics.basis import basis, order_of, to_order

__all__ = [
    "COSINE",
    "convolved",
    "cosine_factors",
    "irradiance",
    "irradiance_matrix",
    "irradiance_polynomial",
]

Float = NDArray[np.float64]

# A_l of Ramamoorthi & Hanrahan 2001, equations 8 and 9: the cosine's own coefficients.
COSINE = (pi, 2 * pi / 3, pi / 4, 0.0, -pi / 24)

# Their equation 12, as roots: 0.429043, 0.511664, 0.743125, 0.886227, 0.247708.
_C1 = COSINE[2] * sqrt(15 / (16 * pi))
_C2 = COSINE[1] * sqrt(3 / (16 * pi))
_C3 = COSINE[2] * sqrt(45 / (16 * pi))
_C4 = COSINE[0] * sqrt(1 / (4 * pi))
_C5 = COSINE[2] * sqrt(5 / (16 * pi))


def cosine_factors(order: int, /) -> Float:
    """((order + 1)²,) A_l of each coefficient."""
    return np.repeat(COSINE[: order + 1], 2 * np.arange(order + 1) + 1)


def convolved(coefficients: NDArray[Any], /) -> Float:
    """Coefficients (..., k, 3) of irradiance in lx from those of luminance in cd/m².

    Σ convolved·Y(n) is the irradiance of a surface that faces n.
    """
    given = np.asarray(coefficients, np.float64)
    return given * cosine_factors(order_of(given.shape[-2]))[:, None]


def irradiance(coefficients: NDArray[Any], normals: NDArray[Any], /) -> Float:
    """Irradiance (..., 3) in lx of surfaces that face unit `normals` (..., 3).

    The leading shapes of `coefficients` (..., k, 3), in cd/m², and of `normals` broadcast. Not cut
    off at 0: ringing shows (see `deringed`).

    Source: Ramamoorthi & Hanrahan 2001, equation 7.
    """
    light = convolved(coefficients)
    values = basis(normals, order_of(light.shape[-2]))
    if light.ndim == 2:
        return values @ light
    return (values[..., None, :] @ light)[..., 0, :]


def irradiance_polynomial(coefficients: NDArray[Any], normals: NDArray[Any], /) -> Float:
    """As `irradiance` with bands 0 to 2 alone, by the polynomial of equation 13."""
    light = np.moveaxis(to_order(coefficients, 2), -2, 0)
    x, y, z = np.moveaxis(np.asarray(normals, np.float64)[..., None], -2, 0)
    return (
        _C1 * light[8] * (x * x - y * y)
        + _C3 * light[6] * z * z
        + _C4 * light[0]
        - _C5 * light[6]
        + 2 * _C1 * (light[4] * x * y + light[7] * x * z + light[5] * y * z)
        + 2 * _C2 * (light[3] * x + light[1] * y + light[2] * z)
    )


def irradiance_matrix(coefficients: NDArray[Any], /) -> Float:
    """M (..., 3, 4, 4), one symmetric matrix a channel: E(n) = nᵀ M n with n = (x, y, z, 1).

    Of bands 0 to 2; of coefficients (..., k, 3) with more, the others are left out.

    Source: Ramamoorthi & Hanrahan 2001, equations 11 and 12.
    """
    given = np.asarray(coefficients, np.float64)
    if given.shape[-1] != 3:
        raise InputError(f"must be (..., k, 3), got {given.shape}", field="coefficients")
    light = np.moveaxis(to_order(given, 2), -2, 0)
    matrix = np.empty((*light.shape[1:], 4, 4))
    rows = (
        (_C1 * light[8], _C1 * light[4], _C1 * light[7], _C2 * light[3]),
        (_C1 * light[4], -_C1 * light[8], _C1 * light[5], _C2 * light[1]),
        (_C1 * light[7], _C1 * light[5], _C3 * light[6], _C2 * light[2]),
        (_C2 * light[3], _C2 * light[1], _C2 * light[2], _C4 * light[0] - _C5 * light[6]),
    )
    for i, row in enumerate(rows):
        for j, entry in enumerate(row):
            matrix[..., i, j] = entry
    return matrix
