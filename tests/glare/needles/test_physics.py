"""The drawn needles: their light, where it lies, its colour, and that it is steady in motion."""

from dataclasses import replace

import numpy as np
import pytest

from andon.glare.needles import NeedleModel, needles_of, reference
from andon.glare.needles.frame import eye_axes
from andon.observer.spread.model import Eye

from .stars import AHEAD, FINE, close_up, disc, fisheye, lamp, latlong, light_of, unit, wide

MODEL = NeedleModel(longest_degrees=1.5)
EYE = Eye(pupil_mm=6.0)


def one_needle(azimuth, *, width_degrees=0.2, length_degrees=1.0, direction=AHEAD):
    """A needle of 1 lx at `azimuth`, 1° long in light of 568 nm."""
    model = replace(MODEL, most=1, number=1e9)
    star = needles_of(lamp(2.0, direction), EYE, 0.0, model=model)
    right, down = eye_axes(direction)
    return replace(
        star,
        azimuth_radians=np.array([azimuth]),
        along=(np.cos(azimuth) * right + np.sin(azimuth) * down)[None],
        length_radians=np.radians([length_degrees]),
        half_width_radians=np.radians([width_degrees / 2]),
        illuminance_lux=np.ones((1, 3)),
    )


@pytest.mark.parametrize(
    ("view", "direction"),
    [
        (close_up(), AHEAD),
        (close_up(), unit(0.01, -0.006, 1)),
        (wide(), unit(0.9, -0.3, 1)),
        (fisheye(), unit(0.7, 0.5, 0.1)),
        (latlong(), unit(0.1, 0.4, -1)),
    ],
)
def test_pixels_hold_the_needles_light(view, direction):
    """Within 0.7 % wherever the source is; of thin needles and pixels of 0.03° to 1.5° alike."""
    star = needles_of(lamp(5.0, direction), EYE, 0.1, model=MODEL)
    expected = star.illuminance_lux.sum(axis=0)
    assert light_of(reference.draw([star], view), view) == pytest.approx(expected, rel=7e-3)


def test_the_profile_along_and_across():
    """Of a needle that is many pixels wide, the luminance is the formula at the pixel."""
    view = close_up(200, 0.01)
    star = one_needle(0.0)
    picture = reference.draw([star], view)
    m, knee = MODEL.power, MODEL.knee
    end = (1 + 1 / knee) ** -m
    reach = np.radians(549 / 568)
    x = np.linspace(0, 1, 20001)
    scale = np.trapezoid((1 + x / knee) ** -m - end, x) * reach
    directions = view.directions()
    for row, column in ((99, 140), (103, 150), (100, 170)):
        x, y, z = directions[row, column]
        rho = np.arctan2(x, z) - star.start_radians[0]
        half = np.radians(0.1) * (1 - (1 - MODEL.taper) * rho / np.radians(1.0))
        tent = max(0.0, 1 - abs(y) / half) / half
        expected = ((1 + rho / reach / knee) ** -m - end) / scale * tent
        assert picture[row, column, 1] == pytest.approx(expected, rel=0.02)


def test_tips_are_red_and_feet_blue():
    view = close_up(200, 0.01)
    picture = reference.draw([one_needle(0.0)], view)
    foot, tip = picture[99:101, 110].mean(axis=0), picture[99:101, 190].mean(axis=0)
    assert foot[2] > foot[1] > foot[0]
    assert tip[0] > tip[1] > tip[2]
    # Each channel has the same light, so the needle as a whole is as white as its source.
    assert light_of(picture, view) == pytest.approx(np.ones(3), rel=5e-3)


def test_thin_needles_are_a_pixel_wide_with_the_same_light():
    view = close_up(100, 0.03)
    thin, thinner = (reference.draw([one_needle(0.3, width_degrees=w)], view) for w in (1e-3, 1e-5))
    assert np.allclose(thin, thinner)
    assert light_of(thin, view) == pytest.approx(np.ones(3), rel=0.01)


@pytest.mark.parametrize("degrees_per_pixel", [0.01, FINE, 0.1])
def test_light_is_steady_between_pixels(degrees_per_pixel):
    """The bar: 1 % of the needles' light, peak to peak, wherever the source lies in a pixel."""
    view = close_up(100, degrees_per_pixel)
    model = replace(MODEL, longest_degrees=40 * degrees_per_pixel)
    generator = np.random.default_rng(0)
    found = []
    for x, y in np.radians(generator.uniform(-0.5, 0.5, (10, 2)) * degrees_per_pixel):
        star = needles_of(lamp(1.0, unit(x, y, 1)), EYE, 0.1, model=model)
        found.append(light_of(reference.draw([star], view), view) / star.illuminance_lux.sum(0))
    assert np.ptp(found, axis=0).max() < 0.01


def test_pictures_move_with_their_source():
    """Half a pixel further is half way between: no pixel lights up at once."""
    view, length = close_up(80), np.radians(FINE)
    here, half, there = (
        reference.draw([needles_of(lamp(1.0, unit(s * length, 0, 1)), EYE, 0.1, model=MODEL)], view)
        for s in (0, 0.5, 1)
    )
    assert np.allclose(here[:, 5:-6], there[:, 6:-5], rtol=1e-2, atol=1e-4 * here.max())
    mean = (here + there) / 2
    assert np.abs(half - mean).sum() < 0.15 * mean.sum()


def test_needles_roll_with_the_head():
    """The same source in the world, seen by a head upright and rolled by 90°: the same star."""
    view = close_up(121)
    ahead = needles_of(lamp(1.0), EYE, 0.1, 4, model=MODEL)
    # The rolled head sees a source that was to the right now above; its star is not turned.
    aside = unit(0.01, 0, 1)
    rolled = unit(0, -0.01, 1)
    stars = [needles_of(lamp(1.0, d), EYE, 0.1, 4, model=MODEL) for d in (aside, rolled)]
    for star in stars:
        assert np.array_equal(star.azimuth_radians, ahead.azimuth_radians)
    picture = reference.draw([ahead], view)
    quarter = np.rot90(picture)
    assert np.abs(picture - quarter).sum() > 0.5 * picture.sum()


def test_the_pattern_does_not_depend_on_where_the_source_is():
    for direction in (unit(0.3, 0.2, 1), unit(-1, 0.4, 0.1), unit(0.2, -1, -0.5)):
        right, down = eye_axes(direction)
        assert np.cross(direction, right) == pytest.approx(down)
        assert right @ direction == pytest.approx(0)
        # Without twist: x and y, carried along the great circle from straight ahead.
        turn = np.cross(AHEAD, direction)
        turn /= np.linalg.norm(turn)
        assert right @ turn == pytest.approx(turn[0])
        assert down @ turn == pytest.approx(turn[1])
    near, nearer = (np.array(eye_axes(unit(1, s, 0.2))) for s in (0, 1e-6))
    assert near == pytest.approx(nearer, abs=1e-5)


def test_straight_behind():
    star = needles_of(lamp(2.0, np.array([0.0, 0, -1])), EYE, 0.1, model=MODEL)
    assert np.isfinite(star.along).all()
    assert star.along @ star.direction == pytest.approx(np.zeros(len(star)), abs=1e-9)
    assert not reference.draw([star], close_up(20)).any()


def test_no_needles():
    dim = needles_of(lamp(1e-9, outline=disc(1.0)), EYE, 100.0)
    assert len(dim) == 0
    assert dim.share == dim.reach_radians == 0
    assert not reference.draw([dim], close_up(8)).any()
