"""Pupil and accommodation against published numbers and closed forms."""

import numpy as np
import pytest

from andon.errors import InputError
from andon.observer.accommodation import LEAST_DIOPTRES, accommodation_dioptres
from andon.observer.pupil import (
    moon_spencer_mm,
    pupil_mm,
    stanley_davies_mm,
    watson_yellott_mm,
)
from andon.scene.eye import Observer


def test_moon_and_spencer_in_millilamberts():
    millilamberts = np.logspace(-5, 4, 40)
    expected = 4.9 - 3 * np.tanh(0.4 * (np.log10(millilamberts) + 0.5))
    found = moon_spencer_mm(millilamberts * 10 / np.pi)
    np.testing.assert_allclose(found, expected, atol=1e-5)


def test_moon_and_spencer_at_its_ends():
    assert moon_spencer_mm(0.0) == pytest.approx(7.9)
    assert moon_spencer_mm(1e12) == pytest.approx(1.9, abs=1e-3)


def test_stanley_and_davies_at_the_flux_where_f_is_1_and_2():
    # F = 1 where L·a = 846, F = 2 where L·a = 846·2^(1/0.41).
    assert stanley_davies_mm(8.46, field_deg2=100.0) == pytest.approx(7.75 - 5.75 / 3, abs=1e-12)
    twice = 8.46 * 2 ** (1 / 0.41)
    assert stanley_davies_mm(twice, field_deg2=100.0) == pytest.approx(7.75 - 5.75 / 2, abs=1e-12)


def test_watson_and_yellott_by_hand():
    # L = 100 cd/m², 60° disc, 60 years, two eyes: F = (100·2827.43/846)^0.41
    power = (100 * np.pi * 900 / 846) ** 0.41
    middle = 7.75 - 5.75 * power / (power + 2)
    expected = middle + (60 - 28.58) * (0.021323 - 0.0095623 * middle)
    found = watson_yellott_mm(100.0, age_years=60.0, field_deg2=np.pi * 900)
    assert found == pytest.approx(expected, abs=1e-12)


def test_watson_and_yellott_agrees_with_its_one_fraction():
    # The paper's appendix (equation 27) multiplies the formula out for two eyes and ages 20…83,
    # to six digits, with f = (L·a)^0.41 and y the age.
    luminance, ages = np.logspace(-3, 4, 30)[:, None], np.linspace(20, 83, 8)
    f = (luminance * 1000.0) ** 0.41
    expected = (18.5172 + 0.122165 * f - 0.105569 * ages + 0.000138645 * f * ages) / (
        2 + 0.0630635 * f
    )
    found = np.stack(
        [watson_yellott_mm(luminance[:, 0], age_years=a, field_deg2=1000.0) for a in ages], axis=1
    )
    np.testing.assert_allclose(found, expected, atol=2e-3)


def test_one_eye_is_a_tenth_of_the_light():
    one = watson_yellott_mm(50.0, eyes=1)
    assert one == pytest.approx(watson_yellott_mm(5.0, eyes=2), abs=1e-12)
    assert one > watson_yellott_mm(50.0)


def test_pupils_narrow_with_light_field_and_age():
    light = watson_yellott_mm(np.logspace(-4, 5, 100), age_years=40.0)
    assert (np.diff(light) < 0).all()
    assert watson_yellott_mm(10.0, field_deg2=100.0) > watson_yellott_mm(10.0, field_deg2=1000.0)
    assert watson_yellott_mm(1.0, age_years=70.0) < watson_yellott_mm(1.0, age_years=25.0)
    extremes = [watson_yellott_mm(L, age_years=y) for L in (0.0, 1e9) for y in (0.0, 120.0)]
    assert min(extremes) > 1.9
    assert max(extremes) < 8.3


def test_ages_beyond_the_data_are_those_of_its_ends():
    assert watson_yellott_mm(1.0, age_years=3.0) == watson_yellott_mm(1.0, age_years=20.0)
    assert watson_yellott_mm(1.0, age_years=99.0) == watson_yellott_mm(1.0, age_years=83.0)


@pytest.mark.parametrize(
    "wrong",
    [
        lambda: moon_spencer_mm(-1.0),
        lambda: watson_yellott_mm([1.0, np.nan]),
        lambda: watson_yellott_mm(np.inf),
        lambda: watson_yellott_mm(1.0, field_deg2=0.0),
        lambda: watson_yellott_mm(1.0, field_deg2=5e4),
        lambda: watson_yellott_mm(1.0, eyes=3),
        lambda: watson_yellott_mm(1.0, age_years=-1.0),
        lambda: accommodation_dioptres(130.0),
    ],
)
def test_impossible_observers_are_refused(wrong):
    with pytest.raises(InputError):
        wrong()


def test_the_observer_chooses():
    assert pupil_mm(Observer(pupil_mm=6.0), 1e4) == 6.0
    young, bright = Observer(age=20.0), 200.0
    assert pupil_mm(young, bright) == watson_yellott_mm(bright, age_years=20.0)
    spencer = Observer(pupil_model="moon-spencer")
    assert pupil_mm(spencer, bright) == moon_spencer_mm(bright)
    assert pupil_mm(young, bright, eyes=1) > pupil_mm(young, bright)


@pytest.mark.parametrize(
    ("age", "minimum", "mean", "maximum"),
    [(20, 10.0, 12.5, 17.0), (40, 5.0, 6.5, 9.0), (50, 2.5, 3.5, 5.0)],
)
def test_hofstetter(age, minimum, mean, maximum):
    assert accommodation_dioptres(age, "minimum") == pytest.approx(minimum)
    assert accommodation_dioptres(age) == pytest.approx(mean)
    assert accommodation_dioptres(age, "maximum") == pytest.approx(maximum)


def test_the_old_keep_their_depth_of_focus():
    assert accommodation_dioptres(60.0) == pytest.approx(0.5)
    assert accommodation_dioptres(80.0) == LEAST_DIOPTRES == 0.5
