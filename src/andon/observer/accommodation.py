"""How near the eye can focus.

========= =================== ============================================================
estimate  dioptres            of
========= =================== ============================================================
mean      18.5 − 0.30·age     the people of Donders 1864 and Duane 1912
minimum   15.0 − 0.25·age     what nearly all of them reach
maximum   25.0 − 0.40·age     the best of them
========= =================== ============================================================

Hofstetter 1950. `mean` is the default, since a picture is made for an observer of a stated age and
not for the worst of that age. The old data are of a letter that is pushed towards the eye until it
blurs: the pupil narrows and blur is tolerated, so they are 1 to 3 D too much for those below 40
(14.9 − 0.24·age of 5433 people, Khan et al. 2022). The line ends at 61.7 years, where accommodation
as instruments measure it has long ended (Anderson et al. 2008) and people still read at about a
metre, by depth of focus. The limit therefore ends at `LEAST_DIOPTRES`, half of that, and is never 0
or less.

Spectacles and contact lenses are taken to correct the eye for infinity. The eye then focuses from 0
up to the limit, in air, from the eye; what the lens's distance from the eye changes, reading
additions and sight that is not corrected are left out.
"""

from __future__ import annotations

from typing import Literal

from andon.errors import InputError

__all__ = ["LEAST_DIOPTRES", "Estimate", "accommodation_dioptres"]

Estimate = Literal["minimum", "mean", "maximum"]

LEAST_DIOPTRES = 0.5
_LINES: dict[Estimate, tuple[float, float]] = {
    "minimum": (15.0, 0.25),
    "mean": (18.5, 0.30),
    "maximum": (25.0, 0.40),
}


def accommodation_dioptres(age_years: float, /, estimate: Estimate = "mean") -> float:
    """The nearest that an eye corrected for infinity can focus on, in dioptres ≥ 0.5.

    Hofstetter 1950. `age_years` is 0…120; below 8 years, where the data begin, it is the line drawn
    further. Raises `InputError` where it is outside.
    """
    if not 0 <= age_years <= 120:
        raise InputError(f"must be 0…120 years, got {age_years:g}", field="age_years")
    start, slope = _LINES[estimate]
    return max(start - slope * age_years, LEAST_DIOPTRES)
