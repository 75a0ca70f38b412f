"""What conventions multiply coefficients with."""

from __future__ import annotations

from math import pi, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.harmonics.basis import to_order
from andon.harmonics.irradiance import cosine_factors

__all__ = ["CONDON_SHORTLEY", "FOLDED", "checked", "up_to_band_2"]

Float = NDArray[np.float64]

# (9,) −1 where m is odd.
CONDON_SHORTLEY = np.array([1, -1, 1, -1, 1, -1, 1, -1, 1], np.float64)

# (9,) of 1, y, z, x, xy, yz, 3z² − 1, xz, x² − y²: the constants of Y_lm.
_CONSTANTS = np.array(
    [
        sqrt(1 / (4 * pi)),
        *[sqrt(3 / (4 * pi))] * 3,
        *[sqrt(15 / (4 * pi))] * 2,
        sqrt(5 / (16 * pi)),
        sqrt(15 / (4 * pi)),
        sqrt(15 / (16 * pi)),
    ]
)

# (9,) of those polynomials in E/π, per coefficient of luminance.
FOLDED = cosine_factors(2) * _CONSTANTS / pi


def up_to_band_2(coefficients: NDArray[Any], /) -> Float:
    """(..., 9, 3) of coefficients (..., k, 3)."""
    return to_order(coefficients, 2)


def checked(values: NDArray[Any] | list[Any], shape: tuple[int, ...], what: str, /) -> Float:
    """`values` as a finite array (..., *shape)."""
    try:
        result = np.asarray(values, np.float64)
    except (TypeError, ValueError) as error:
        raise InputError("must be numbers", field=what) from error
    if result.shape[-len(shape) :] != shape:
        wanted = ", ".join(str(n) for n in shape)
        raise InputError(f"must be (..., {wanted}), got {result.shape}", field=what)
    if not np.isfinite(result).all():
        raise InputError("must be finite", field=what)
    return result
