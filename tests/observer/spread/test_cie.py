"""The CIE's equations: its values, how they grow with age, where they hold."""

import numpy as np
import pytest

from andon.observer.spread import cie146
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


def test_values_of_cie_146():
    """At 1° of an observer of no age: 10 + 5 + 0.1p + 0.0025p; 15; 10."""
    assert bloom("cie146-general", 1.0, age_years=0, pigment=1.0) == pytest.approx(15.1025)
    assert bloom("cie146-small-angle", 1.0, age_years=0) == pytest.approx(15)
    assert bloom("cie146-stiles-holladay", 1.0, age_years=0) == pytest.approx(10)
    assert bloom("cie146-stiles-holladay", 2.0, age_years=70) == pytest.approx(5)
    assert cie146.ageing(62.5) == 2


def test_the_small_angle_equation_is_the_general_one_nearby():
    theta = np.geomspace(0.1, 3, 50)
    ratio = bloom("cie146-small-angle", theta) / bloom("cie146-general", theta)
    assert (ratio <= 1).all()
    assert ratio.min() > 0.94
    assert bloom("cie146-small-angle", 30.0) < 0.85 * bloom("cie146-general", 30.0)
