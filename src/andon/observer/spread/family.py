"""Spread functions by name, for any eye.

======================= ========== ===== ======= ===== ================================= =========
name                    valid      age   pigment pupil ``wide`` multiplies                integral
======================= ========== ===== ======= ===== ================================= =========
cie135                  0…100°     yes   yes     no    what age raises                   1.01…1.03
cie146-general          0.1…100°   yes   yes     no    all but 10/θ³                     infinite
cie146-small-angle      0.1…30°    yes   no      no    all but 10/θ³                     infinite
cie146-stiles-holladay  1…30°      yes   no      no    all of it                         infinite
spencer                 0…90°      no    no      no    f2                                1, 1.02
ijspeert                0…90°      yes   yes     yes   the terms of large angles         1
paper                   0…8°       yes   no      no    all of it                         0.2
======================= ========== ===== ======= ===== ================================= =========

``wide`` is what glasses and mist add (`wide`). Where a model is not valid its formula goes on as it
is written. Every model may have a lenticular ring, which belongs to the eye: Spencer's, or that of
the paper for the paper.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from andon.errors import InputError
from andon.observer.spread import cie135, cie146, ijspeert, paper, spencer
from andon.observer.spread.angles import integral
from andon.observer.spread.model import Eye, SpreadFunction
from andon.observer.spread.wide import wide_factor

__all__ = ["NAMES", "lenticular_halo", "scattered_share", "spread_function"]

Float = NDArray[np.float64]
PerSr = Callable[[ArrayLike], Float]


class Ring(Protocol):
    """Rings of red, green and blue in bands: θ in degrees (...) → sr⁻¹ (..., 3)."""

    def __call__(self, theta_degrees: ArrayLike, /, *, band_nm: float) -> Float: ...


Range = tuple[float, float]

# Names that people type for the equations of the CIE.
ALIASES = {"cie-total": "cie135", "cie-general": "cie146-general"}
# A veil's light is scattered by angles between these, and fills what is within them evenly.
VEIL_DEGREES = (0.1, 110.0)


def spread_function(name: str, eye: Eye | None = None, /, *, halo: bool = True) -> SpreadFunction:
    """The model `name` for `eye`, by default one of 25 years with brown pigment.

    With `halo` it has the ring of `lenticular_halo`, if that eye sees one.

    Raises `InputError` for a name that is none of `NAMES` nor ``cie-total``, ``cie-general``, and
    where the model scatters more light than there is: by thick mist, and beyond about 90 (paper) to
    110 years, far from the people that it was measured on.
    """
    eye = Eye() if eye is None else eye
    known = ALIASES.get(name, name)
    if known not in _MODELS:
        raise InputError(f"must be one of {', '.join(NAMES)}, got {name!r}", field="model")
    bloom, valid = _MODELS[known](eye, wide_factor(eye))
    ring = lenticular_halo(eye, paper.halo if known == "paper" else spencer.halo) if halo else None
    spread = SpreadFunction(known, bloom, ring, valid)
    share = _taken(spread, eye)
    if share >= 1:
        raise InputError(
            f"scatters {share:.3g} of the light at {eye.age_years:g} years with mist {eye.mist:g}, "
            "more than there is",
            field=f"model {known}",
            remedy="a younger eye, less mist" + ("" if known == "cie135" else ", or cie135"),
        )
    return spread


def lenticular_halo(eye: Eye, /, ring: Ring = spencer.halo) -> PerSr | None:
    """θ in degrees (...) → sr⁻¹ (..., 3): the ring that `eye` sees around a point.

    A `ring` of unit integral in the bands of the channels, times the share of its light, of
    Spencer et al. 1995: 0.016 in mesopic, 0.033 in scotopic light; None in photopic light.
    """
    share = spencer.WEIGHTS[eye.adaptation][3]
    if share == 0:
        return None
    return lambda theta: share * ring(theta, band_nm=spencer.BAND_NM)


def scattered_share(
    spread: SpreadFunction, beyond_degrees: float, until_degrees: float = 90.0, /
) -> float:
    """Share of a point's light, ∫ bloom dω between two angles from it, 0 ≤ beyond, until ≤ 180.

    Models that are not valid towards 0 have a meaning only beyond where they begin to be.
    """
    return integral(spread.bloom_per_sr, beyond_degrees, until_degrees)


def _taken(spread: SpreadFunction, eye: Eye) -> float:
    """Share of a point's light that a veil and its ring take from it, at most."""
    within = 2 * np.pi * (1 - np.cos(np.radians(VEIL_DEGREES[0])))
    near = within * float(spread.bloom_per_sr(VEIL_DEGREES[0]))
    ring = 0.0 if spread.halo_per_sr is None else spencer.WEIGHTS[eye.adaptation][3]
    return near + scattered_share(spread, *VEIL_DEGREES) + ring


def _cie135(eye: Eye, wide: float) -> tuple[PerSr, Range]:
    age, pigment = eye.age_years, eye.pigment
    return lambda theta: cie135.cie135(theta, age, pigment, wide), cie135.VALID_DEGREES


def _general(eye: Eye, wide: float) -> tuple[PerSr, Range]:
    age, pigment = eye.age_years, eye.pigment
    return lambda theta: cie146.general(theta, age, pigment, wide), cie146.GENERAL_DEGREES


def _small_angle(eye: Eye, wide: float) -> tuple[PerSr, Range]:
    age, valid = eye.age_years, cie146.SMALL_ANGLE_DEGREES
    return lambda theta: cie146.small_angle(theta, age, wide), valid


def _stiles_holladay(eye: Eye, wide: float) -> tuple[PerSr, Range]:
    age, valid = eye.age_years, cie146.STILES_HOLLADAY_DEGREES
    return lambda theta: cie146.stiles_holladay(theta, age, wide), valid


def _spencer(eye: Eye, wide: float) -> tuple[PerSr, Range]:
    adaptation = eye.adaptation
    return lambda theta: spencer.spencer(theta, adaptation, wide), spencer.VALID_DEGREES


def _ijspeert(eye: Eye, wide: float) -> tuple[PerSr, Range]:
    of = eye.age_years, eye.pigment, eye.pupil_mm, wide
    return lambda theta: ijspeert.ijspeert(theta, *of), ijspeert.VALID_DEGREES


def _paper(eye: Eye, wide: float) -> tuple[PerSr, Range]:
    age = eye.age_years
    return lambda theta: paper.point_bloom(theta, age, wide), paper.VALID_DEGREES


_MODELS: dict[str, Callable[[Eye, float], tuple[PerSr, Range]]] = {
    "cie135": _cie135,
    "cie146-general": _general,
    "cie146-small-angle": _small_angle,
    "cie146-stiles-holladay": _stiles_holladay,
    "spencer": _spencer,
    "ijspeert": _ijspeert,
    "paper": _paper,
}
NAMES = tuple(_MODELS)
