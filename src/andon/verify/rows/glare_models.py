"""Rows of the eye's spread functions: the CIE's values, all light in its place, others' tables."""

from __future__ import annotations

import csv
import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from andon.observer.spread import cie146, ijspeert, paper, spencer
from andon.observer.spread.angles import integral
from andon.observer.spread.family import scattered_share, spread_function
from andon.observer.spread.model import Eye
from andon.verify.registry import NotShown, Row

__all__ = ["ROWS"]

Float = NDArray[np.float64]

# θ in degrees and sr⁻¹ of CIE 135 at 25 years and p = 0.5.
VALUES = {0.1: 11441.4, 1.0: 18.8647, 3.0: 1.01208, 10.0: 0.0603211, 30.0: 0.00760722}
RATIO_DEGREES = (1.0, 3.0, 10.0, 30.0)
# Of 70 to 25 years.
RATIOS = {
    "cie146-general": (1.5149, 1.9241, 2.2583, 2.2384),
    "cie135": (1.2857, 1.6482, 2.0674, 2.1193),
}
# (age, pigment) → light of CIE 135 on the hemisphere.
WHOLE = {(24.0, 0.5): 1.010, (70.0, 1.2): 1.026}
# Columns of the table that say what they claim to: that of the complete equation does not.
COLUMNS: dict[str, Callable[[float, float, float], Float]] = {
    "CIE_general_Leq_over_Egl_per_sr": cie146.general,
    "stiles_holladay_age_adj_per_sr": lambda theta, age, pigment: cie146.stiles_holladay(
        theta, age
    ),
    "spencer95_photopic_psf_per_sr": lambda theta, age, pigment: spencer.spencer(theta, "photopic"),
}


def _values() -> float:
    """Largest relative error of the CIE's values."""
    ours = spread_function("cie135").bloom_per_sr(list(VALUES))
    return float(np.abs(ours / list(VALUES.values()) - 1).max())


def _ages() -> float:
    worst = 0.0
    for name, ratios in RATIOS.items():
        old, young = (
            spread_function(name, Eye(age)).bloom_per_sr(RATIO_DEGREES) for age in (70.0, 25.0)
        )
        worst = max(worst, float(np.abs(old / young / ratios - 1).max()))
    return worst


def _integrals() -> float:
    """Largest error of what is to be all of the light."""
    errors = [
        scattered_share(spread_function("cie135", Eye(*eye)), 0.0) - whole
        for eye, whole in WHOLE.items()
    ]
    terms = (spencer.core, spencer.narrow_skirt, spencer.wide_skirt)
    errors += [integral(term) - 1 for term in terms]
    for halo in (spencer.halo, paper.halo):
        errors += [integral(_channel(halo, i)) - 1 for i in range(3)]
    for age in (0.0, 25.0, 70.0, 120.0):
        for pupil_mm in (2.0, 5.0, 8.0):
            errors.append(integral(_ijspeert(age, pupil_mm)) - 1)
    return float(np.abs(errors).max())


def _ijspeert(age: float, pupil_mm: float) -> Callable[[ArrayLike], Float]:
    return lambda theta: ijspeert.ijspeert(theta, age, 0.5, pupil_mm)


def _channel(halo: Callable[[ArrayLike], Float], index: int) -> Callable[[ArrayLike], Float]:
    return lambda theta: halo(theta)[..., index]


def _tables() -> float:
    """Largest relative difference of the columns to the same functions here."""
    folder = os.environ.get("ANDON_DATA")
    if not folder:
        raise NotShown("ANDON_DATA is not set: the folder that holds glare_references")
    path = Path(folder) / "glare_references" / "glare_functions_tabulated.csv"
    if not path.is_file():
        raise NotShown(f"{path} is missing")
    worst = 0.0
    with path.open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            theta, age, pigment = (float(row[k]) for k in ("theta_deg", "age_y", "pigment_p"))
            for column, function in COLUMNS.items():
                theirs = float(row[column])
                if np.isfinite(theirs):
                    ours = float(function(theta, age, pigment))
                    worst = max(worst, abs(ours / theirs - 1))
    return worst


ROWS: tuple[Row, ...] = (
    Row(
        "glare.models.values",
        "glare",
        0.001,
        "relative, the worst",
        "CIE 135/1 at 25 years and p = 0.5, from 0.1 to 30°",
        _values,
    ),
    Row(
        "glare.models.ages",
        "glare",
        0.001,
        "relative, the worst",
        "70 to 25 years in CIE 146 and CIE 135/1, from 1 to 30°",
        _ages,
    ),
    Row(
        "glare.models.integrals",
        "glare",
        0.001,
        "of the light, the worst",
        "the hemisphere: CIE 135/1's 1.010 and 1.026; 1 of IJspeert, of Spencer's terms, of rings",
        _integrals,
    ),
    Row(
        "glare.models.tables",
        "glare",
        0.001,
        "relative, the worst",
        "others' tables of CIE 146, Stiles-Holladay and Spencer, 20 to 83 years",
        _tables,
    ),
)
