"""How wide the pupil is.

============== ============================================== ==================================
model          depends on                                     spread
============== ============================================== ==================================
moon-spencer   luminance                                      of one curve through old data
watson-yellott luminance, field, age, one or two eyes         0.5…1 mm from person to person
============== ============================================== ==================================

Both are of a steady, wide-open view of photopic light; arousal, drugs, near focus (the pupil
narrows by some tenths of a millimetre) and the first seconds after a change of light are not in
them.

Sources: Moon & Spencer 1944; Stanley & Davies 1995; Watson & Yellott 2012, equations 13, 20, 21.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from andon.errors import InputError
from andon.scene.eye import Observer

__all__ = [
    "FIELD_DEG2",
    "moon_spencer_mm",
    "pupil_mm",
    "stanley_davies_mm",
    "watson_yellott_mm",
]

Float = NDArray[np.float64]

# A field that fills both eyes' binocular view: a disc of 60° (Watson & Yellott 2012, figure 16
# shows fields up to 60°); in the formula a larger field acts as the same share of more light.
FIELD_DEG2 = np.pi * 30.0**2
SPHERE_DEG2 = 4 * np.pi * np.degrees(1.0) ** 2
# Mean age of the observers of Stanley & Davies 1995, and the ages of those of Winn et al. 1994,
# whose slopes the formula fits. Beyond them the nearest age that was measured is used.
REFERENCE_AGE = 28.58
YOUNGEST, OLDEST = 20.0, 83.0
# Light into one eye acts on both pupils as a tenth of the light into both.
ONE_EYE = 0.1


def moon_spencer_mm(luminance_cd_m2: ArrayLike, /) -> Float:
    """(...) pupil diameter in mm, 1.9…7.9, of luminance ≥ 0 in cd/m².

    Moon & Spencer 1944, in millilamberts: D = 4.9 − 3·tanh(0.4·(log₁₀ B + ½)). One mL is 10/π
    cd/m², so log₁₀ B + ½ = log₁₀ L − 0.00285, which is why the constant in cd/m² is 0.00114.
    """
    luminance = _luminance(luminance_cd_m2)
    with np.errstate(divide="ignore"):
        return 4.9 - 3 * np.tanh(0.4 * np.log10(luminance) - 0.00114)


def stanley_davies_mm(
    luminance_cd_m2: ArrayLike, /, *, field_deg2: float = FIELD_DEG2, eyes: int = 2
) -> Float:
    """(...) pupil diameter in mm, 2…7.75, at 28.58 years.

    Stanley & Davies 1995 with Watson & Yellott's effect of one eye (2012, equation 20):
    F = (L·a·M/846)^0.41, D = 7.75 − 5.75·F/(F + 2).
    """
    luminance = _luminance(luminance_cd_m2)
    if not 0 < field_deg2 <= SPHERE_DEG2:
        raise InputError(
            f"must be > 0 and ≤ {SPHERE_DEG2:.0f} deg², got {field_deg2:g}", field="field_deg2"
        )
    if eyes not in (1, 2):
        raise InputError(f"must be 1 or 2, got {eyes}", field="eyes")
    share = 1.0 if eyes == 2 else ONE_EYE
    power = (luminance * (field_deg2 * share / 846)) ** 0.41
    return 7.75 - 5.75 * power / (power + 2)


def watson_yellott_mm(
    luminance_cd_m2: ArrayLike,
    /,
    *,
    age_years: float = REFERENCE_AGE,
    field_deg2: float = FIELD_DEG2,
    eyes: int = 2,
) -> Float:
    """(...) pupil diameter in mm, 1.9…8.2.

    D + (age − 28.58)·(0.021323 − 0.0095623·D), D of `stanley_davies_mm`: Watson & Yellott 2012,
    equation 21. Ages are clipped to 20…83, those of the data.

    Parameters
    ----------
    luminance_cd_m2 : (...) ≥ 0, of the field that the eyes are adapted to.
    field_deg2 : area of that field in square degrees, > 0, at most the sphere.
    eyes : 1 or 2, that the light enters.
    """
    if not 0 <= age_years <= 120:
        raise InputError(f"must be 0…120 years, got {age_years:g}", field="age_years")
    middle = stanley_davies_mm(luminance_cd_m2, field_deg2=field_deg2, eyes=eyes)
    years = float(np.clip(age_years, YOUNGEST, OLDEST)) - REFERENCE_AGE
    return middle + years * (0.021323 - 0.0095623 * middle)


def pupil_mm(
    observer: Observer, luminance_cd_m2: float, /, *, field_deg2: float = FIELD_DEG2, eyes: int = 2
) -> float:
    """Diameter of the observer's pupil in mm: fixed, or by the model that [observer] names.

    Parameters
    ----------
    luminance_cd_m2 : mean luminance of what the eyes are adapted to, ≥ 0; not used where
        `observer.pupil_mm` is given.
    """
    if observer.pupil_mm is not None:
        return observer.pupil_mm
    if observer.pupil_model == "moon-spencer":
        return float(moon_spencer_mm(luminance_cd_m2))
    return float(
        watson_yellott_mm(luminance_cd_m2, age_years=observer.age, field_deg2=field_deg2, eyes=eyes)
    )


def _luminance(luminance_cd_m2: ArrayLike) -> Float:
    luminance = np.asarray(luminance_cd_m2, np.float64)
    if not np.all(np.isfinite(luminance) & (luminance >= 0)):
        raise InputError("must be ≥ 0 cd/m² and finite", field="luminance_cd_m2")
    return luminance
