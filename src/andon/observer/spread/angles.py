"""Angles that a spread function is asked for, and its integrals over the hemisphere."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from andon.errors import InputError

__all__ = ["angles", "integral"]

Float = NDArray[np.float64]

# Quadrature in log θ: spread functions are sums of powers. Below 1e-6° lies 1e-7 of the light of
# those that are finite at 0; 4000 steps change no integral by more than 1e-6.
SMALLEST_DEGREES, STEPS = 1e-6, 4000


def angles(theta_degrees: ArrayLike, /) -> Float:
    """(...) the angles as float64; raises `InputError` where one is not in 0…180°."""
    theta = np.asarray(theta_degrees, np.float64)
    if not np.all((theta >= 0) & (theta <= 180)):
        raise InputError("must be 0…180°", field="theta_degrees")
    return theta


def integral(
    per_sr: Callable[[ArrayLike], Float], least_degrees: float = 0.0, most_degrees: float = 90.0
) -> float:
    """∫ f dω of a function of θ in degrees in sr⁻¹ (...) over a ring, 0 ≤ least, most ≤ 180.

    Light within 1e-6° is left out, so that of functions that grow without end at 0 it is finite
    but means nothing unless `least_degrees` is where the function begins to hold.
    """
    least = max(least_degrees, SMALLEST_DEGREES)
    if least >= most_degrees:
        return 0.0
    logarithm = np.linspace(math.log(least), math.log(most_degrees), STEPS + 1)
    theta = np.minimum(np.exp(logarithm), 180.0)
    # Multiplying by θ makes it an integral over log θ.
    ring = per_sr(theta) * 2 * np.pi * np.sin(np.radians(theta)) * np.radians(theta)
    return float(np.sum((ring[1:] + ring[:-1]) / 2 * np.diff(logarithm)))
