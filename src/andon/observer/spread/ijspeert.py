"""IJspeert's model: how the spread depends on age, pigment and pupil; of unit integral.

::

    PSF(φ) = Σ cᵢ·βᵢ/(2π(sin²φ + βᵢ²cos²φ)^1.5)        i = 1, 2: small angles, 3, 4: large ones

With A in years, P the pupil in mm, m the pigment (below), AF = 1 + (A/70)⁴ and d = 3.2 mm::

    c_sa = 1/(1 + AF/(1/m − 1))    c_la = 1 − c_sa    b = 9000 − 936√AF    e = √AF/2000
    c1 = c_sa/(1 + (P/d)²)         β1 = (1 + (P/d)²)/(bP)
    c2 = c_sa/(1 + (d/P)²)         β2 = (1 + (d/P)²)(e − 1/(bP))
    c3 = c_la/((1 + 25m)(1 + 1/AF))    β3 = 1/(10 + 60m − 5/AF)
    c4 = c_la − c3                     β4 = 1

Pigment
    m is not the CIE's p. It is 0.056 for dark, 0.106 for brown and 0.16 for blue eyes; here it is
    taken from p = 0, 0.5 and 1, linear in between and constant beyond 1, which is a choice.

Source: IJspeert et al. 1993.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from andon.observer.spread.angles import angles

__all__ = ["VALID_DEGREES", "Terms", "ijspeert", "pigmentation", "terms_of"]

Float = NDArray[np.float64]

VALID_DEGREES = (0.0, 90.0)
# Pupil in mm at which both terms of small angles have the same share.
EQUAL_MM = 3.2
CIE_PIGMENT, PIGMENTATION = (0.0, 0.5, 1.0), (0.056, 0.106, 0.16)


@dataclass(frozen=True)
class Terms:
    """Shares c, which sum to 1, and widths β, about radians; small angles first."""

    shares: tuple[float, float, float, float]
    widths: tuple[float, float, float, float]


def pigmentation(cie_pigment: float, /) -> float:
    """IJspeert's m from the CIE's p, 0…1.2; never falls with it."""
    return float(np.interp(cie_pigment, CIE_PIGMENT, PIGMENTATION))


def terms_of(age: float, pigment: float, pupil_mm: float) -> Terms:
    """The four terms, of an age in years, the CIE's pigment and a pupil's diameter in mm."""
    m, aged = pigmentation(pigment), 1 + (age / 70) ** 4
    small = 1 / (1 + aged / (1 / m - 1))
    large = 1 - small
    near = 1 / ((9000 - 936 * np.sqrt(aged)) * pupil_mm)
    wider, narrower = 1 + (pupil_mm / EQUAL_MM) ** 2, 1 + (EQUAL_MM / pupil_mm) ** 2
    middle = large / ((1 + 25 * m) * (1 + 1 / aged))
    return Terms(
        (small / wider, small / narrower, middle, large - middle),
        (
            float(wider * near),
            float(narrower * (np.sqrt(aged) / 2000 - near)),
            1 / (10 + 60 * m - 5 / aged),
            1.0,
        ),
    )


def ijspeert(
    theta_degrees: ArrayLike,
    age: float = 25.0,
    pigment: float = 0.5,
    pupil_mm: float = 5.0,
    wide: float = 1.0,
) -> Float:
    """(...) sr⁻¹; `wide` multiplies both terms of large angles.

    Beyond 90°, where the formula would turn back, it has the value of 90°.
    """
    theta = np.radians(np.minimum(angles(theta_degrees), 90.0))
    terms = terms_of(age, pigment, pupil_mm)
    total = np.zeros(theta.shape)
    for index, (share, width) in enumerate(zip(terms.shares, terms.widths, strict=True)):
        spread = width / (np.sin(theta) ** 2 + (width * np.cos(theta)) ** 2) ** 1.5
        total += (wide if index >= 2 else 1.0) * share * spread / (2 * np.pi)
    return total
