"""Real spherical harmonics of bands 0 to 4 as polynomials of the direction.

Order L00, L1−1, L10, L11, L2−2, …: the coefficient of band l and degree m is number l² + l + m.
No Condon–Shortley sign: band 1 is +y, +z, +x. The polar axis of the degrees is z; the world's up
is y; nothing depends on that but the numbering.
"""

from __future__ import annotations

from math import isqrt, pi, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError

__all__ = ["MAX_ORDER", "added", "basis", "coefficient_count", "order_of", "to_order"]

Float = NDArray[np.float64]

MAX_ORDER = 4


def coefficient_count(order: int, /) -> int:
    """(order + 1)², the coefficients of bands 0…`order`; `order` in 0…4."""
    if not 0 <= order <= MAX_ORDER:
        raise InputError(f"must be 0…{MAX_ORDER}, got {order}", field="order")
    return (order + 1) ** 2


def order_of(count: int, /) -> int:
    """The highest band of `count` coefficients: 1 → 0, 4 → 1, 9 → 2, 16 → 3, 25 → 4."""
    order = isqrt(max(count, 0)) - 1
    if not 0 <= order <= MAX_ORDER or (order + 1) ** 2 != count:
        raise InputError(f"must be 1, 4, 9, 16 or 25, got {count}", field="number of coefficients")
    return order


def basis(directions: NDArray[Any], order: int = 2, /) -> Float:
    """Y_lm (..., (order + 1)²) of *unit* directions (..., 3); orthonormal over the sphere.

    Source: Ramamoorthi & Hanrahan 2001, equation 3 (bands 0 to 2); the roots are those of
    √((2l+1)/4π · (l−|m|)!/(l+|m|)!), with √2 for m ≠ 0, applied to Legendre's functions.
    """
    count = coefficient_count(order)
    x, y, z = np.moveaxis(np.asarray(directions, np.float64), -1, 0)
    values = np.empty((*x.shape, count))
    values[..., 0] = sqrt(1 / (4 * pi))
    for band, terms in enumerate((_band_1, _band_2, _band_3, _band_4)[:order], start=1):
        for degree, term in enumerate(terms(x, y, z)):
            values[..., band * band + degree] = term
    return values


def _band_1(x: Float, y: Float, z: Float) -> tuple[Float, ...]:
    root = sqrt(3 / (4 * pi))
    return root * y, root * z, root * x


def _band_2(x: Float, y: Float, z: Float) -> tuple[Float, ...]:
    root = sqrt(15 / (4 * pi))
    return (
        root * x * y,
        root * y * z,
        sqrt(5 / (16 * pi)) * (3 * z * z - 1),
        root * x * z,
        root / 2 * (x * x - y * y),
    )


def _band_3(x: Float, y: Float, z: Float) -> tuple[Float, ...]:
    outer, middle, inner = sqrt(35 / (32 * pi)), sqrt(105 / (4 * pi)), sqrt(21 / (32 * pi))
    return (
        outer * y * (3 * x * x - y * y),
        middle * x * y * z,
        inner * y * (5 * z * z - 1),
        sqrt(7 / (16 * pi)) * z * (5 * z * z - 3),
        inner * x * (5 * z * z - 1),
        middle / 2 * z * (x * x - y * y),
        outer * x * (x * x - 3 * y * y),
    )


def _band_4(x: Float, y: Float, z: Float) -> tuple[Float, ...]:
    r35, r70 = sqrt(35 / (16 * pi)), sqrt(35 / (32 * pi))
    r5, r10 = sqrt(5 / (16 * pi)), sqrt(5 / (32 * pi))
    xx, yy, zz = x * x, y * y, z * z
    return (
        3 * r35 * x * y * (xx - yy),
        3 * r70 * y * z * (3 * xx - yy),
        3 * r5 * x * y * (7 * zz - 1),
        3 * r10 * y * z * (7 * zz - 3),
        sqrt(9 / (256 * pi)) * (35 * zz * zz - 30 * zz + 3),
        3 * r10 * x * z * (7 * zz - 3),
        1.5 * r5 * (xx - yy) * (7 * zz - 1),
        3 * r70 * x * z * (xx - 3 * yy),
        0.75 * r35 * (xx * (xx - 3 * yy) - yy * (3 * xx - yy)),
    )


def to_order(coefficients: NDArray[Any], order: int, /) -> Float:
    """Coefficients (..., k, 3) with bands 0…`order`: higher ones are cut, missing ones are 0.

    To cut is the best approximation of that order in the mean square, since Y_lm are orthonormal.
    """
    given = np.asarray(coefficients, np.float64)
    order_of(given.shape[-2])
    count = coefficient_count(order)
    kept = min(count, given.shape[-2])
    result = np.zeros((*given.shape[:-2], count, given.shape[-1]))
    result[..., :kept, :] = given[..., :kept, :]
    return result


def added(*coefficients: NDArray[Any]) -> Float:
    """The sum of lights (..., k, 3), which may be of different orders: that of the highest."""
    if not coefficients:
        raise InputError("needs at least one set of coefficients", field="added")
    highest = max(order_of(part.shape[-2]) for part in coefficients)
    total = to_order(coefficients[0], highest)
    for part in coefficients[1:]:
        total = total + to_order(part, highest)
    return total
