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
from typing import TYPE_CHECKING

from andon.errors import InputError
from andon.glow.model import Glow
from andon.observer.spread.family import scattered_share, spread_function
from andon.observer.spread.model import Eye

if TYPE_CHECKING:
    from andon.scene.eye import Glare, Observer

__all__ = ["glow_from_table", "standard_share"]

# The same energy is asked for within this angle.
WITHIN_DEGREES = 1.0


def standard_share(eye: Eye, beyond_degrees: float, /) -> float:
    """Share of a point's light in [0, 1] that CIE 135 puts farther than `beyond_degrees`, 0…90.

    Of its own integral over the hemisphere, 1.010 to 1.026, so that all shares sum to 1: a glow
    keeps the light that it takes. A veil is in sr⁻¹ as the CIE has it, and takes that share.
    """
    spread = spread_function("cie135", eye)
    return scattered_share(spread, beyond_degrees) / scattered_share(spread, 0.0)


def glow_from_table(table: Glare | None, observer: Observer | None = None) -> Glow | None:
    """The glow that [glare] and [observer] of a scene ask for; None where there is none of it.

    Without `glow_fraction` it is the share that this observer scatters by more than
    `minimum_angle_degrees`; without `glow_sigma_degrees` as much of it as CIE 135 says stays
    within 1°.

    Raises `InputError` where no Gaussian of that fraction has so much light beyond 1°.
    """
    if table is None or table.model != "glow":
        return None
    eye = Eye(observer.age, observer.pigment) if observer else Eye()
    fraction = table.glow_fraction
    if fraction is None:
        fraction = standard_share(eye, table.minimum_angle_degrees)
    if fraction == 0:
        return None
    sigma_degrees = table.glow_sigma_degrees or _automatic_sigma(fraction, eye)
    return Glow(math.radians(sigma_degrees), fraction)


def _automatic_sigma(fraction: float, eye: Eye) -> float:
    """σ in degrees."""
    beyond = standard_share(eye, WITHIN_DEGREES)
    if fraction <= beyond:
        raise InputError(
            f"scatters {fraction:.3g} of the light, but CIE 135 puts {beyond:.3g} beyond 1°, so "
            "no σ follows from it",
            field="glare.glow_fraction",
            remedy="state glow_sigma_degrees, or a larger glow_fraction",
        )
    return WITHIN_DEGREES / math.sqrt(2 * math.log(fraction / beyond))
