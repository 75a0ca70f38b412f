"""The CIE's equations: its values, how they grow with age, where they hold."""

import numpy as np
import pytest

from andon.errors import InputError
from andon.observer.spread.family import scattered_share, spread_function
from andon.observer.spread.model import Eye
from comparison import assert_agree

ANGLES = [1.0, 3.0, 10.0, 30.0]


def bloom(name, theta, **eye):
    return spread_function(name, Eye(**eye)).bloom_per_sr(theta)


def test_values_of_cie_135():
    values = bloom("cie135", [0.1, 1, 3, 10, 30], age_years=25, pigment=0.5)
    assert_agree(values, [11441.4, 18.8647, 1.01208, 0.0603211, 0.00760722], rtol=1e-5)


@pytest.mark.parametrize(
    ("name", "ratios"),
    [
        ("cie135", [1.2857, 1.6482, 2.0674, 2.1193]),
        ("cie146-general", [1.5149, 1.9241, 2.2583, 2.2384]),
    ],
)
def test_seventy_years_over_twenty_five(name, ratios):
    old, young = bloom(name, ANGLES, age_years=70), bloom(name, ANGLES, age_years=25)
    assert_agree(old / young, ratios, rtol=1e-4)


@pytest.mark.parametrize(("age", "pigment", "whole"), [(24, 0.5, 1.010), (70, 1.2, 1.026)])
def test_all_the_light_of_cie_135(age, pigment, whole):
    spread = spread_function("cie135", Eye(age_years=age, pigment=pigment))
    assert scattered_share(spread, 0.0) == pytest.approx(whole, abs=1e-3)


def test_other_names():
    for name, known in (("cie-total", "cie135"), ("cie-general", "cie146-general")):
        assert spread_function(name).name == known
        assert_agree(bloom(name, ANGLES), bloom(known, ANGLES))


@pytest.mark.parametrize("theta", [-0.1, 180.1, np.nan, np.inf, [1, -1]])
@pytest.mark.parametrize("name", ["cie135", "cie146-general"])
def test_angles_that_are_none(name, theta):
    with pytest.raises(InputError, match="theta_degrees: must be 0…180°"):
        bloom(name, theta)
