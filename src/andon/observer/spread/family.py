"""Spread functions by name, for any eye."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from andon.errors import InputError
from andon.observer.spread import cie146
from andon.observer.spread.angles import integral
from andon.observer.spread.cie135 import VALID_DEGREES, cie135
from andon.observer.spread.model import Eye, SpreadFunction

__all__ = ["NAMES", "scattered_share", "spread_function"]

Float = NDArray[np.float64]
Bloom = Callable[[ArrayLike], Float]
Range = tuple[float, float]

# Names that people type for the equations of the CIE.
ALIASES = {"cie-total": "cie135", "cie-general": "cie146-general"}


def spread_function(name: str, eye: Eye | None = None, /) -> SpreadFunction:
    """The model `name` for `eye`, by default one of 25 years with brown pigment.

    Raises `InputError` for a name that is none of `NAMES` nor ``cie-total``, ``cie-general``.
    """
    eye = Eye() if eye is None else eye
    known = ALIASES.get(name, name)
    if known not in _MODELS:
        raise InputError(f"must be one of {', '.join(NAMES)}, got {name!r}", field="model")
    bloom, valid = _MODELS[known](eye)
    return SpreadFunction(known, bloom, None, valid)


def scattered_share(
    spread: SpreadFunction, beyond_degrees: float, until_degrees: float = 90.0, /
) -> float:
    """Share of a point's light, ∫ bloom dω between two angles from it, 0 ≤ beyond, until ≤ 180.

    Models that are not valid towards 0 have a meaning only beyond where they begin to be.
    """
    return integral(spread.bloom_per_sr, beyond_degrees, until_degrees)


def _cie135(eye: Eye) -> tuple[Bloom, Range]:
    return lambda theta: cie135(theta, eye.age_years, eye.pigment), VALID_DEGREES


def _general(eye: Eye) -> tuple[Bloom, Range]:
    age, pigment = eye.age_years, eye.pigment
    return lambda theta: cie146.general(theta, age, pigment), cie146.GENERAL_DEGREES


def _small_angle(eye: Eye) -> tuple[Bloom, Range]:
    return lambda theta: cie146.small_angle(theta, eye.age_years), cie146.SMALL_ANGLE_DEGREES


def _stiles_holladay(eye: Eye) -> tuple[Bloom, Range]:
    age, valid = eye.age_years, cie146.STILES_HOLLADAY_DEGREES
    return lambda theta: cie146.stiles_holladay(theta, age), valid


_MODELS: dict[str, Callable[[Eye], tuple[Bloom, Range]]] = {
    "cie135": _cie135,
    "cie146-general": _general,
    "cie146-small-angle": _small_angle,
    "cie146-stiles-holladay": _stiles_holladay,
}
NAMES = tuple(_MODELS)
