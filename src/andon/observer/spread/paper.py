"""The paper's bloom and halo of a point, and its bloom around an outline.

::

    point    bloom = A/(θ + θ0)^m                 A = 29, θ0 = 0.13°, m = 2.8, θ < 8°
             halo  = C·exp(−(θ − θ1·λ/568)²/α²)   θ1 = 2.95°, α = 0.225°
    outline  bloom = A·((β + θ1)⁻³ + B·(β + θ1)⁻²)   β: angle beyond the outline; inside: β = 0

Calibrated for points
    The exponents 3 and 2 are those of the CIE's small-angle equation, so A = 10 per lux at the eye,
    B = 0.5·(1 + (age/62.5)⁴), times glasses and mist; θ1, "empirical" in the paper, is 0.1°, where
    the CIE's equation begins.
Conditions of a point
    The paper lets age, glasses and mist act on A, without numbers. A is multiplied here by what
    multiplies the CIE's 5/θ², divided by that of 25 years, so that it is 29 for them.
Energy of the ring
    The paper gives C as ten times the ambient light, which is no share of the source's. 1/α² is
    Spencer's 19.75, so it is the same ring, a little narrower, and has the share of Spencer's.

Near an outline it is no convolution of the point: up to 23 times off it at a disc of 1°.

Sources: the glare paper, equations 1 to 5; Vos 1984; Hemenger 1992.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from andon.errors import InputError
from andon.observer.spread.angles import angles
from andon.observer.spread.cie146 import ageing
from andon.observer.spread.spencer import HALO_NM

__all__ = ["VALID_DEGREES", "halo", "outline_bloom", "point_bloom"]

Float = NDArray[np.float64]

VALID_DEGREES = (0.0, 8.0)
AMPLITUDE, CORE_DEGREES, EXPONENT = 29.0, 0.13, 2.8
REFERENCE_AGE = 25.0
RING_DEGREES, RING_WIDTH_DEGREES = 2.95, 0.225
OUTLINE_AMPLITUDE, OUTLINE_DEGREES = 10.0, 0.1


def point_bloom(theta_degrees: ArrayLike, age: float = 25.0, wide: float = 1.0) -> Float:
    """(...) equation 1 in sr⁻¹; `wide` multiplies all of it."""
    amplitude = AMPLITUDE * wide * ageing(age) / ageing(REFERENCE_AGE)
    return amplitude / (angles(theta_degrees) + CORE_DEGREES) ** EXPONENT


def halo(
    theta_degrees: ArrayLike, /, wavelength_nm: tuple[float, ...] = HALO_NM, band_nm: float = 0.0
) -> Float:
    """(..., n) equation 2 in sr⁻¹ of n wavelengths, each of unit integral (on the plane).

    With `band_nm` it is the mean over a Gaussian band of that standard deviation around each.
    """
    theta = angles(theta_degrees)[..., None]
    radius = RING_DEGREES * np.asarray(wavelength_nm, np.float64) / 568
    # A Gaussian of radii over a Gaussian ring of variance α²/2.
    width = np.hypot(RING_WIDTH_DEGREES, np.sqrt(2) * RING_DEGREES * band_nm / 568)
    # ∫ 2πθ·exp(−(θ − radius)²/α²) dθ in square degrees; what lies behind θ = 0 is below e⁻⁴⁰.
    area = 2 * np.pi * radius * np.sqrt(np.pi) * width
    return np.exp(-(((theta - radius) / width) ** 2)) / (area * np.radians(1) ** 2)


def outline_bloom(beyond_degrees: ArrayLike, age: float = 25.0, wide: float = 1.0) -> Float:
    """(...) the bloom around a shape, sr⁻¹: cd/m² for each lux that the whole shape gives the eye.

    `beyond_degrees` (...) is the angle from the outline, −180…180, negative inside, where it is
    constant; `wide` multiplies B.
    """
    beyond = np.asarray(beyond_degrees, np.float64)
    if not np.all(np.abs(beyond) <= 180):
        raise InputError("must be −180…180°", field="beyond_degrees")
    reach = np.maximum(beyond, 0) + OUTLINE_DEGREES
    return OUTLINE_AMPLITUDE * (reach**-3.0 + 0.5 * ageing(age) * wide * reach**-2.0)
