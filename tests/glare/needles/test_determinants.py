"""Number, length, azimuths and gate of needles against their formulas."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from andon.errors import InputError
from andon.glare.gate import gate
from andon.glare.needles import NeedleModel, needles_of
from andon.glare.needles.determinants import number_of, reach_factor
from andon.glare.needles.frame import Elongation, elongation, lobed
from andon.glare.needles.pattern import pattern_of
from andon.observer.spread.model import Eye

from .stars import disc, ellipse, lamp

MODEL = NeedleModel()
EYE = Eye(pupil_mm=MODEL.pupil_mm)
SPECTACLES = replace(EYE, glasses="spectacles", glasses_dioptres=-6.0)


@pytest.mark.parametrize(
    ("lux", "ambient", "eye", "radius", "factor"),
    [
        (1.0, 0.0, EYE, 1e-4, 1.0),
        (0.3, 0.0, EYE, 1e-4, 0.3),
        (1.0, 3.0, EYE, 1e-4, 1 / 4),
        (1.0, 0.0, replace(EYE, mist=1.5), 1e-4, 1 / 2.5),
        (1.0, 0.0, SPECTACLES, 1e-4, 1 + 6 / 4),
        (1.0, 0.0, replace(SPECTACLES, glasses="contact-lenses"), 1e-4, 1.0),
        (1.0, 0.0, replace(SPECTACLES, glasses_dioptres=2.0), 1e-4, 1.0),
        # A disc of half a degree is S0.
        (1.0, 0.0, EYE, 0.25, 1 / 2),
        (1.0, 0.0, replace(EYE, age_years=70.0), 1e-4, 1.0),
    ],
)
def test_the_number_is_the_formula(lux, ambient, eye, radius, factor):
    source = lamp(lux, outline=disc(radius))
    for gaussian in (-1.0, 0.0, 2.0):
        expected = MODEL.number * abs(1 + MODEL.number_spread * gaussian) * factor
        number = number_of(source, eye, ambient, gaussian, MODEL)
        assert number == pytest.approx(min(expected, MODEL.most), rel=2e-3)


def test_there_are_as_many_needles_as_the_number_says():
    for lux in (0.05, 0.5, 2.0):
        number = number_of(lamp(lux), EYE, 0.1, pattern_of(3, "mono", MODEL.most).number, MODEL)
        assert len(needles_of(lamp(lux), EYE, 0.1, 3)) == np.ceil(number)


def test_length_grows_as_the_root_of_light_and_shrinks_with_the_pupil():
    lengths = {
        (lux, pupil): needles_of(
            lamp(lux), replace(EYE, pupil_mm=pupil), 0.0, model=replace(MODEL, number=1e4)
        ).length_radians
        for lux in (0.5, 1.0)
        for pupil in (3.0, 6.0)
    }
    first = lengths[1.0, 6.0]
    assert lengths[0.5, 6.0] == pytest.approx(first * 0.5 ** (1 / MODEL.power))
    assert lengths[1.0, 3.0] == pytest.approx(first / 2)
    # Half-normal: the mean of |g| is √(2/π).
    mean = np.degrees(first.mean()) / MODEL.length_degrees
    assert mean == pytest.approx(np.sqrt(2 / np.pi), abs=3 * 0.6 / np.sqrt(MODEL.most))
    assert reach_factor(lamp(2.0), EYE, 1.0, MODEL) == pytest.approx(1.0)


def test_needles_end_at_the_longest():
    bright = needles_of(lamp(1e6), EYE, 0.0)
    assert np.degrees(bright.length_radians.max()) == pytest.approx(MODEL.longest_degrees)


def test_azimuths_around_a_circle_are_stratified():
    turn = pattern_of(5, "left", 256).turn
    for bits in range(9):
        count = 1 << bits
        assert sorted(np.floor(turn[:count] * count)) == list(range(count))
    # … and not a grid.
    assert np.std(turn * 256 % 1) == pytest.approx(np.sqrt(1 / 12), abs=0.03)


def test_lobes_are_gaussian_and_antipodal():
    turn = (np.arange(20000) + 0.5) / 20000
    axis, sigma = 0.4, np.radians(25)
    azimuth = lobed(turn, Elongation(1.0, axis), sigma)
    from_axis = np.mod(azimuth - axis + np.pi / 2, 2 * np.pi)
    first = from_axis < np.pi
    assert first.mean() == pytest.approx(0.5, abs=1e-3)
    for lobe in (from_axis[first] - np.pi / 2, from_axis[~first] - 3 * np.pi / 2):
        assert lobe.mean() == pytest.approx(0, abs=1e-3)
        # Cut off at 3.6 σ.
        assert lobe.std() == pytest.approx(sigma, rel=0.01)
        assert np.mean(np.abs(lobe) < sigma) == pytest.approx(0.683, abs=2e-3)


def test_a_circle_has_no_lobes_and_nothing_jumps():
    turn = pattern_of(1, "mono", 64).turn
    around = lobed(turn, Elongation(0.0, 1.1), 0.4)
    assert np.allclose(np.exp(1j * around), np.exp(2j * np.pi * turn))
    for axis in np.linspace(0, np.pi, 60):
        here, there = (lobed(turn, Elongation(0.6, axis + d), 0.4) for d in (0, 1e-4))
        assert np.abs(np.exp(1j * here) - np.exp(1j * there)).max() < 1e-3


@pytest.mark.parametrize("turned", [0.0, 30.0, 80.0])
def test_elongation_of_an_ellipse(turned):
    found = elongation(lamp(outline=ellipse(0.3, 0.1, turned)))
    assert found.degree == pytest.approx((9 - 1) / (9 + 1), abs=1e-3)
    # An axis has no sign.
    assert np.sin(found.axis_radians - np.radians(turned)) == pytest.approx(0, abs=2e-3)


def test_needles_of_an_ellipse_lie_about_its_axis():
    star = needles_of(lamp(4.0, outline=ellipse(0.2, 0.04, 30)), EYE, 0.0)
    doubled = np.exp(2j * star.azimuth_radians).mean()
    assert np.degrees(np.angle(doubled)) / 2 == pytest.approx(30, abs=8)
    assert abs(doubled) > 0.5
    circle = needles_of(lamp(4.0), EYE, 0.0)
    assert abs(np.exp(2j * circle.azimuth_radians).mean()) < 0.1
    # They begin at the outline.
    along = np.abs(np.cos(star.azimuth_radians - np.radians(30)))
    assert np.degrees(star.start_radians[along > 0.999]) == pytest.approx(0.2, rel=0.05)


def test_the_gate():
    assert gate(39.9, 1.0) == 0
    assert gate(50.0, 1.0) == 1
    assert gate(45.0, 1.0) == pytest.approx(0.5)
    assert gate(1e-6, 0.0) == 1
    assert gate(0.0, 0.0) == 0
    steps = np.diff(gate(np.linspace(35, 55, 2001), 1.0))
    assert steps.min() >= 0
    assert steps.max() < 0.002


def test_no_needles_below_the_contrast():
    source = lamp(1.0)
    luminance = float(source.luminance_cd_m2[0])
    assert len(needles_of(source, EYE, luminance / 39)) == 0
    assert len(needles_of(source, EYE, luminance / 60)) > 0


def test_light_that_changes_moves_no_needle():
    """Needles fade by index: what is there stays where it is, the share has no steps."""
    stars = [needles_of(lamp(lux), EYE, 0.1, 2) for lux in np.linspace(0.2, 0.6, 400)]
    for before, after in pairwise(stars):
        both = min(len(before), len(after))
        assert np.array_equal(before.azimuth_radians[:both], after.azimuth_radians[:both])
    shares = np.array([star.share for star in stars])
    assert np.diff(shares).min() >= 0
    assert np.diff(shares).max() < 0.02 * shares.max()


def test_eyes_and_seeds():
    source = lamp(3.0)

    def azimuths(seed, which):
        return needles_of(source, EYE, 0.1, seed, which=which).azimuth_radians[:20]

    assert np.array_equal(azimuths(1, "left"), azimuths(1, "left"))
    assert not np.allclose(azimuths(1, "left"), azimuths(1, "right"))
    assert not np.allclose(azimuths(1, "left"), azimuths(2, "left"))


def test_the_share_is_small_and_falls_with_the_pupil():
    bright = needles_of(lamp(1e5), EYE, 0.0)
    assert len(bright) == MODEL.most
    assert bright.share == pytest.approx(MODEL.share)
    assert bright.illuminance_lux.sum(axis=0) == pytest.approx(MODEL.share * 1e5 * np.ones(3))
    narrow = needles_of(lamp(1e5), replace(EYE, pupil_mm=2.0), 0.0)
    assert narrow.share == pytest.approx(MODEL.share / 9)
    wide = needles_of(lamp(1e5), replace(EYE, pupil_mm=8.0), 0.0)
    assert wide.share == pytest.approx(MODEL.share)


@pytest.mark.parametrize("ambient", [-1.0, np.nan, np.inf])
def test_bad_ambient(ambient):
    with pytest.raises(InputError, match="ambient_cd_m2"):
        needles_of(lamp(), EYE, ambient)


@pytest.mark.parametrize(
    "wrong", [{"most": 100}, {"power": 1.0}, {"share": 1.0}, {"taper": 0.0}, {"most": 0}]
)
def test_bad_models(wrong):
    with pytest.raises(InputError, match=f"needles.{next(iter(wrong))}"):
        NeedleModel(**wrong)
