"""Against the tables of `glare_references`, made by others from the same formulas.

Its column of the CIE's complete equation lacks the denominator, and its Stiles–Holladay column is
empty outside 1…30°.
"""

import csv
import os
from pathlib import Path

import numpy as np
import pytest

from andon.observer.spread import cie146, spencer
from andon.observer.spread.cie135 import cie135
from requirements import missing


@pytest.fixture(scope="module")
def table():
    folder = os.environ.get("ANDON_DATA")
    path = Path(folder or "") / "glare_references" / "glare_functions_tabulated.csv"
    if not folder or not path.is_file():
        missing("ANDON_DATA has no glare_references")
    with path.open(encoding="utf-8") as file:
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]


def eyes(table):
    return sorted({(row["age_y"], row["pigment_p"]) for row in table})


@pytest.mark.parametrize(
    ("column", "function", "rows"),
    [
        ("CIE_general_Leq_over_Egl_per_sr", cie146.general, 22),
        (
            "stiles_holladay_age_adj_per_sr",
            lambda theta, age, pigment: cie146.stiles_holladay(theta, age),
            12,
        ),
        (
            "spencer95_photopic_psf_per_sr",
            lambda theta, age, pigment: spencer.spencer(theta, "photopic"),
            22,
        ),
    ],
)
def test_tables(table, column, function, rows):
    assert len(eyes(table)) > 6
    for age, pigment in eyes(table):
        here = [r for r in table if (r["age_y"], r["pigment_p"]) == (age, pigment)]
        theirs = np.array([r[column] for r in here])
        theta = np.array([r["theta_deg"] for r in here])
        stated = np.isfinite(theirs)
        assert stated.sum() == rows
        ours = function(theta[stated], age, pigment)
        # Six digits are given.
        np.testing.assert_allclose(ours, theirs[stated], rtol=1e-5)


def test_the_column_that_lacks_its_denominator(table):
    """It is what the complete equation would be without 1 + p(0.0417 + 0.055·(A/70)⁴)."""
    for row in table:
        age, pigment = row["age_y"], row["pigment_p"]
        ours = cie135(row["theta_deg"], age, pigment)
        denominator = 1 + pigment * (0.0417 + 0.055 * (age / 70) ** 4)
        theirs = row["CIE_total_glare_function_per_sr"]
        np.testing.assert_allclose(ours * denominator, theirs, rtol=1e-5)
