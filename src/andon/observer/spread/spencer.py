"""Spencer's model: a core, two skirts and the lenticular halo, each of unit integral.

::

    f0 = 2.61e6·exp(−(θ/0.02)²)               f1 = 20.91/(θ + 0.02)³
    f2 = 72.37/(θ + 0.02)²                    f3 = 436.9·(568/λ)·exp(−19.75(θ − 3λ/568)²)

             f0      f1      f2      f3
    photopic 0.384   0.478   0.138   0         θ in degrees, λ in nm, sr⁻¹
    mesopic  0.368   0.478   0.138   0.016
    scotopic 0.282   0.478   0.207   0.033

It is of a young eye: age and pigment are not in it. The ring is the lens's fibres, which are a
grating at the pupil's rim: narrow pupils of daylight cover them.

Source: Spencer et al. 1995.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from andon.observer.spread.angles import angles
from andon.observer.spread.model import Adaptation

__all__ = [
    "BAND_NM",
    "HALO_NM",
    "VALID_DEGREES",
    "WEIGHTS",
    "core",
    "halo",
    "narrow_skirt",
    "spencer",
    "wide_skirt",
]

Float = NDArray[np.float64]

VALID_DEGREES = (0.0, 90.0)
WEIGHTS: dict[Adaptation, tuple[float, float, float, float]] = {
    "photopic": (0.384, 0.478, 0.138, 0.0),
    "mesopic": (0.368, 0.478, 0.138, 0.016),
    "scotopic": (0.282, 0.478, 0.207, 0.033),
}
# What the ring is drawn for in red, green and blue.
HALO_NM = (611.0, 549.0, 467.0)
# Standard deviation of a channel's band. Lamps and skies have light of all wavelengths, of which a
# channel takes some 80 nm (full width at half maximum); a line each would be three hoops.
BAND_NM = 35.0


def core(theta_degrees: ArrayLike, /) -> Float:
    """(...) f0 in sr⁻¹: light that is hardly scattered."""
    return 2.61e6 * np.exp(-((angles(theta_degrees) / 0.02) ** 2))


def narrow_skirt(theta_degrees: ArrayLike, /) -> Float:
    """(...) f1 in sr⁻¹."""
    return 20.91 / (angles(theta_degrees) + 0.02) ** 3


def wide_skirt(theta_degrees: ArrayLike, /) -> Float:
    """(...) f2 in sr⁻¹."""
    return 72.37 / (angles(theta_degrees) + 0.02) ** 2


def halo(
    theta_degrees: ArrayLike, /, wavelength_nm: tuple[float, ...] = HALO_NM, band_nm: float = 0.0
) -> Float:
    """(..., n) f3 in sr⁻¹ of n wavelengths; each has a ring of its own radius, of one width.

    With `band_nm` it is the mean over a Gaussian band of that standard deviation around each.
    """
    theta = angles(theta_degrees)[..., None]
    ratio = np.asarray(wavelength_nm, np.float64) / 568
    # A Gaussian of radii over a Gaussian ring: variances add, and the integral stays.
    narrow = 1 / np.sqrt(1 + 2 * 19.75 * (3 * band_nm / 568) ** 2)
    return 436.9 * narrow / ratio * np.exp(-19.75 * (narrow * (theta - 3 * ratio)) ** 2)


def spencer(
    theta_degrees: ArrayLike, adaptation: Adaptation = "mesopic", wide: float = 1.0
) -> Float:
    """(...) core and skirts in sr⁻¹, without the ring; `wide` multiplies f2."""
    weights = WEIGHTS[adaptation]
    steep = weights[0] * core(theta_degrees) + weights[1] * narrow_skirt(theta_degrees)
    return steep + wide * weights[2] * wide_skirt(theta_degrees)
