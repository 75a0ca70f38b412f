"""The CIE's complete equation for the standard observer."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from andon.observer.spread.angles import angles

__all__ = ["VALID_DEGREES", "cie135"]

VALID_DEGREES = (0.0, 100.0)


def cie135(
    theta_degrees: ArrayLike, age: float = 25.0, pigment: float = 0.5, wide: float = 1.0
) -> NDArray[np.float64]:
    """(...) point-spread function of the eye in sr⁻¹.

    Source: CIE 135/1-1999, complete equation, with its denominator. Its integral over the
    hemisphere is 1.010 (24 years, brown eyes) to 1.026 (70 years, very light ones), not 1.

    Parameters
    ----------
    theta_degrees : (...) 0…180.
    age, pigment : years 0…120; of CIE, 0…1.2.
    wide : multiplies what age raises, 1: as the CIE has it.
    """
    theta = angles(theta_degrees)
    aged = (age / 70) ** 4
    core = 9.2e6 / (1 + (theta / 0.0046) ** 2) ** 1.5 + 1.5e5 / (1 + (theta / 0.045) ** 2) ** 1.5
    near = 1 + (theta / 0.1) ** 2
    skirt = 400 / near + 3e-8 * theta**2 + pigment * (1300 / near**1.5 + 0.8 / near**0.5)
    skirt = (1 + 1.6 * aged) * skirt + 2.5e-3 * pigment
    total = (1 - 0.08 * aged) * core + wide * skirt
    return total / (1 + pigment * (0.0417 + 0.055 * aged))
