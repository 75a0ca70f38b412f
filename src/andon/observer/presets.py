"""Observers that have a name, and the eye of the observer that a scene states."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

from andon.errors import InputError
from andon.observer.pupil import pupil_mm
from andon.observer.spread.model import Adaptation, Eye, Glasses
from andon.scene.eye import Atmosphere, Observer

__all__ = [
    "AGES",
    "EYE_COLOURS",
    "MESOPIC_CD_M2",
    "WORN",
    "adaptation_of",
    "eye_of",
    "observer_preset",
]

AGES = {"young": 20.0, "middle": 45.0, "old": 70.0}
# The CIE's pigment of irises: CIE 146:2002 has 0 for very dark, 0.5 for brown, 1 for blue and green
# and 1.2 for very light blue eyes.
EYE_COLOURS = {"black": 0.0, "brown": 0.5, "green": 1.0, "blue": 1.0, "light-blue": 1.2}
# What is worn and its power in dioptres; −4 D is a common short sight.
WORN: dict[str, tuple[Glasses, float]] = {
    "none": ("none", 0.0),
    "short-sighted": ("spectacles", -4.0),
    "contact-lenses": ("contact-lenses", -4.0),
}
# Mesopic vision by CIE 191:2010: rods and cones both see. Below is scotopic, above photopic vision.
MESOPIC_CD_M2 = (0.005, 5.0)


def observer_preset(age: str = "middle", /, *, eyes: str = "brown", worn: str = "none") -> Observer:
    """[observer] of names: of `AGES`, `EYE_COLOURS` and `WORN`. Raises `InputError` for others."""
    glasses, dioptres = WORN[_known(WORN, worn, "worn")]
    return Observer(
        age=AGES[_known(AGES, age, "age")],
        pigment=EYE_COLOURS[_known(EYE_COLOURS, eyes, "eyes")],
        glasses=glasses,
        glasses_dioptres=dioptres,
    )


def adaptation_of(luminance_cd_m2: float, /) -> Adaptation:
    """What sees at this luminance, ≥ 0 cd/m², by CIE 191:2010: 5 and 0.005 cd/m² are mesopic."""
    least, most = MESOPIC_CD_M2
    if luminance_cd_m2 > most:
        return "photopic"
    return "mesopic" if luminance_cd_m2 >= least else "scotopic"


def eye_of(
    observer: Observer | None,
    atmosphere: Atmosphere | None,
    adaptation_luminance_cd_m2: float,
    /,
    adaptation: Literal["auto"] | Adaptation = "auto",
) -> Eye:
    """The eye of [observer] in the air of [atmosphere]; without them their defaults.

    Parameters
    ----------
    adaptation_luminance_cd_m2 : mean luminance of what the eye is adapted to, ≥ 0. The pupil
        follows from it, where [observer] does not fix it, and so does an adaptation of ``auto``.

    Raises `InputError` for a luminance that is negative or not finite.
    """
    observer = Observer() if observer is None else observer
    if not 0 <= adaptation_luminance_cd_m2 < float("inf"):
        raise InputError(
            f"must be ≥ 0 cd/m² and finite, got {adaptation_luminance_cd_m2:g}",
            field="adaptation_luminance_cd_m2",
        )
    return Eye(
        age_years=observer.age,
        pigment=observer.pigment,
        pupil_mm=pupil_mm(observer, adaptation_luminance_cd_m2),
        glasses=observer.glasses,
        glasses_dioptres=observer.glasses_dioptres,
        mist=0.0 if atmosphere is None else atmosphere.mist,
        adaptation=adaptation_of(adaptation_luminance_cd_m2)
        if adaptation == "auto"
        else adaptation,
    )


def _known(names: Mapping[str, object], name: str, field: str) -> str:
    if name not in names:
        raise InputError(f"must be one of {', '.join(names)}, got {name!r}", field=field)
    return name
