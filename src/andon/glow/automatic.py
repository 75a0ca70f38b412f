"""Fraction and σ from the eye: what the CIE's standard observer scatters.

With S(θ) the share of a point's light that CIE 135 leaves within the angle θ, and a Gaussian that
leaves ``1 − exp(−θ²/2σ²)`` (the closed form of its integral on the plane; 1° is plane enough):

::

    fraction = 1 − S(0.1°)                                   scattered out of the point itself
    1 − fraction·exp(−(1°)²/2σ²) = S(1°)                     the same energy within 1°

so σ = 1°/√(2·ln(fraction/(1 − S(1°)))): 0.59° with a fraction of 0.32 for an observer of 25 years
with brown eyes, and 0.44° if all light is scattered, as in the paper.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from andon.errors import InputError
from andon.glow.model import Glow

if TYPE_CHECKING:
    from andon.scene.eye import Glare, Observer

__all__ = ["cie135", "glow_from_table", "scattered_share"]

# The same energy is asked for within this angle.
WITHIN_DEGREES = 1.0
DEFAULT_AGE, DEFAULT_PIGMENT = 25.0, 0.5
# Quadrature in log θ: the spread function is a sum of powers. Below 1e-6° lies 1e-7 of the light;
# 4000 steps change no share by more than 1e-6.
SMALLEST_DEGREES, STEPS = 1e-6, 4000


def cie135(
    theta_degrees: ArrayLike, age: float = DEFAULT_AGE, pigment: float = DEFAULT_PIGMENT
) -> NDArray[np.float64]:
    """Point-spread function of the eye in sr⁻¹, 0…90°; `age` in years, `pigment` 0…1.2.

    Source: CIE 135/1-1999, complete equation, with its denominator. Its integral over the
    hemisphere is 1.010 to 1.026, not 1.
    """
    theta = np.asarray(theta_degrees, np.float64)
    aged = (age / 70) ** 4
    core = 9.2e6 / (1 + (theta / 0.0046) ** 2) ** 1.5 + 1.5e5 / (1 + (theta / 0.045) ** 2) ** 1.5
    wide: Any = 1 + (theta / 0.1) ** 2
    skirt = 400 / wide + 3e-8 * theta**2 + pigment * (1300 / wide**1.5 + 0.8 / wide**0.5)
    total = (1 - 0.08 * aged) * core + (1 + 1.6 * aged) * skirt + 2.5e-3 * pigment
    return np.asarray(total / (1 + pigment * (0.0417 + 0.055 * aged)))


def scattered_share(
    beyond_degrees: float, age: float = DEFAULT_AGE, pigment: float = DEFAULT_PIGMENT
) -> float:
    """Share of a point's light in [0, 1] that CIE 135 puts farther than `beyond_degrees`, 0…90.

    Of its own integral over the hemisphere, so that all shares sum to 1.
    """

    def light(least: float) -> float:
        logarithm = np.linspace(math.log(max(least, SMALLEST_DEGREES)), math.log(90), STEPS + 1)
        theta = np.exp(logarithm)
        ring = cie135(theta, age, pigment) * np.sin(np.radians(theta)) * theta
        return float(np.sum((ring[1:] + ring[:-1]) / 2 * np.diff(logarithm)))

    return light(beyond_degrees) / light(0.0) if beyond_degrees < 90 else 0.0


def glow_from_table(table: Glare | None, observer: Observer | None = None) -> Glow | None:
    """The glow that [glare] and [observer] of a scene ask for; None where there is none of it.

    Without `glow_fraction` it is the share that this observer scatters by more than
    `minimum_angle_degrees`; without `glow_sigma_degrees` as much of it as CIE 135 says stays
    within 1°.

    Raises `InputError` where no Gaussian of that fraction has so much light beyond 1°.
    """
    if table is None or table.model != "glow":
        return None
    age = observer.age if observer else DEFAULT_AGE
    pigment = observer.pigment if observer else DEFAULT_PIGMENT
    fraction = table.glow_fraction
    if fraction is None:
        fraction = scattered_share(table.minimum_angle_degrees, age, pigment)
    if fraction == 0:
        return None
    sigma_degrees = table.glow_sigma_degrees or _automatic_sigma(fraction, age, pigment)
    return Glow(math.radians(sigma_degrees), fraction)


def _automatic_sigma(fraction: float, age: float, pigment: float) -> float:
    """σ in degrees."""
    beyond = scattered_share(WITHIN_DEGREES, age, pigment)
    if fraction <= beyond:
        raise InputError(
            f"scatters {fraction:.3g} of the light, but CIE 135 puts {beyond:.3g} beyond 1°, so "
            "no σ follows from it",
            field="glare.glow_fraction",
            remedy="state glow_sigma_degrees, or a larger glow_fraction",
        )
    return WITHIN_DEGREES / math.sqrt(2 * math.log(fraction / beyond))
