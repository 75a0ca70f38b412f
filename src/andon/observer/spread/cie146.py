"""The CIE's three equations for disability glare: simpler, and of limited ranges of angles.

::

    general          10/θ³ + (5/θ² + 0.1p/θ)(1 + (A/62.5)⁴) + 0.0025p    0.1…100°
    small angle      10/θ³ + 5/θ²·(1 + (A/62.5)⁴)                        0.1…30°
    Stiles–Holladay  10/θ²·(1 + (A/70)⁴)                                 1…30°

A in years, p the pigment, θ in degrees, sr⁻¹. They grow without end towards 0 and go on as written
where they are not valid.

Source: CIE 146:2002; Vos 2003.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from andon.observer.spread.angles import angles

__all__ = [
    "GENERAL_DEGREES",
    "SMALL_ANGLE_DEGREES",
    "STILES_HOLLADAY_DEGREES",
    "ageing",
    "general",
    "small_angle",
    "stiles_holladay",
]

Float = NDArray[np.float64]

GENERAL_DEGREES = (0.1, 100.0)
SMALL_ANGLE_DEGREES = (0.1, 30.0)
STILES_HOLLADAY_DEGREES = (1.0, 30.0)


def ageing(age: float, /) -> float:
    """How much more the eye's lens scatters at `age` years than at birth: 1 + (A/62.5)⁴."""
    return 1 + (age / 62.5) ** 4


def general(
    theta_degrees: ArrayLike, age: float = 25.0, pigment: float = 0.5, wide: float = 1.0
) -> Float:
    """(...) sr⁻¹ by the general equation; `wide` multiplies all but 10/θ³."""
    theta = angles(theta_degrees)
    with np.errstate(divide="ignore"):
        aged = (5 / theta**2 + 0.1 * pigment / theta) * ageing(age)
        return 10 / theta**3 + wide * (aged + 0.0025 * pigment)


def small_angle(theta_degrees: ArrayLike, age: float = 25.0, wide: float = 1.0) -> Float:
    """(...) sr⁻¹ by the small-angle equation; `wide` multiplies all but 10/θ³."""
    theta = angles(theta_degrees)
    with np.errstate(divide="ignore"):
        return 10 / theta**3 + wide * 5 / theta**2 * ageing(age)


def stiles_holladay(theta_degrees: ArrayLike, age: float = 25.0, wide: float = 1.0) -> Float:
    """(...) sr⁻¹ by the age-adjusted Stiles–Holladay equation, times `wide`."""
    theta = angles(theta_degrees)
    with np.errstate(divide="ignore"):
        return wide * 10 / theta**2 * (1 + (age / 70) ** 4)
