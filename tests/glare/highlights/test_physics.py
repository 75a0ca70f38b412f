"""Lobes: their integrals, white furnaces, limits, and Fresnel's terms."""

import numpy as np
import pytest

from andon.glare.highlights.albedo import albedo_table
from andon.glare.highlights.fresnel import dielectric, paper_condition, schlick, total_reflection
from andon.glare.highlights.lobes import edge_share, fan_share, ggx_slopes, phong_lobe
from andon.glare.highlights.model import Finish
from andon.glare.highlights.reference import even_reflectance
from glare.highlights.facets_for_tests import HEMISPHERE, STEP_SR, brute_force, facet, ggx


def polygon(points):
    return list(zip(points, np.roll(points, -1, axis=0), strict=True))


def test_slopes_of_a_disc_are_its_closed_form():
    turn = np.arange(4000) * (2 * np.pi / 4000)
    for radius in (0.1, 1.0, 30.0):
        corners = radius * np.stack([np.cos(turn), np.sin(turn)], -1)
        share = sum(edge_share(p, q) for p, q in polygon(corners))
        assert share == pytest.approx(radius**2 / (1 + radius**2), rel=1e-5)


@pytest.mark.parametrize("shift", [(0.0, 0.0), (0.7, -0.2), (-3.0, 1.0)])
def test_slopes_of_a_polygon_are_the_integral(shift):
    corners = np.array([[-0.5, -0.4], [0.6, -0.3], [0.4, 0.7], [-0.6, 0.5]]) + shift
    share = sum(edge_share(p, q) for p, q in polygon(corners))
    random = np.random.default_rng(0).uniform(-0.7, 0.7, (400_000, 2)) + shift
    inside = np.ones(len(random), bool)
    for p, q in polygon(corners):
        way = q - p
        inside &= way[0] * (random[:, 1] - p[1]) - way[1] * (random[:, 0] - p[0]) > 0
    brute = ggx_slopes(random[inside]).sum() / len(random) * 1.4**2
    assert share == pytest.approx(brute, rel=0.01)


def test_far_from_the_lobe_both_sums_are_one():
    square = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
    corners = square + np.array([7.0, 2.0])
    middle = corners.mean(axis=0)
    exact = sum(edge_share(p, q) for p, q in polygon(corners))
    fan = sum(fan_share(p, q, middle) for p, q in polygon(corners))
    assert fan == pytest.approx(exact, rel=2e-3)


@pytest.mark.parametrize("exponent", [1.0, 10.0, 40.0])
def test_phongs_lobe_is_normalised(exponent):
    lobe = phong_lobe(HEMISPHERE[:, 2], exponent).sum() * STEP_SR
    assert lobe == pytest.approx(1, rel=2e-3)


@pytest.mark.parametrize("finish", [
    ggx(0.1), ggx(0.4), ggx(1.0), ggx(0.6, 0.1), ggx(0.15, 0.5),
    Finish("phong", exponent=30.0, reflectance=(1, 1, 1)),
])  # fmt: skip
@pytest.mark.parametrize("view", [(0, 0, 1), (1, 0.3, 1), (4, -1, 1)])
def test_no_white_furnace_gives_more_than_it_gets(finish, view):
    assert brute_force(facet(view, finish)).max() <= 1.002


@pytest.mark.parametrize("alpha", [0.15, 0.4, 1.0])
@pytest.mark.parametrize("view", [(0, 0, 1), (1, 0, 1), (3, 0, 1)])
@pytest.mark.parametrize("base", [1.0, 0.3])
def test_even_light_gives_what_all_directions_give_together(alpha, view, base):
    one = facet(view, ggx(alpha), (base,) * 3)
    assert even_reflectance(one)[0, 0] == pytest.approx(brute_force(one)[0], abs=0.006)


def test_a_smooth_mirror_keeps_all_light():
    scale, offset = albedo_table()[-1, 0]
    assert scale + offset == pytest.approx(1, abs=1e-3)
    assert offset == pytest.approx(0, abs=1e-3)


def test_fresnel_straight_ahead_and_grazing():
    assert dielectric(1.0, 1.5) == pytest.approx(0.04)
    assert dielectric(1.0, 1 / 1.5) == pytest.approx(0.04)
    assert dielectric(0.0, 1.333) == pytest.approx(1)
    # Light at Brewster's angle: half of what the one polarisation has.
    brewster = np.cos(np.arctan(1.5))
    assert dielectric(brewster, 1.5) == pytest.approx(0.5 * ((1.5**2 - 1) / (1.5**2 + 1)) ** 2)
    cosines = np.linspace(0.05, 1, 200)
    assert np.abs(schlick(cosines, 0.04) - dielectric(cosines, 1.5)).max() < 0.05


def test_light_in_water_is_totally_reflected_from_the_critical_angle_on():
    critical = np.arcsin(1 / 1.333)
    angles = np.linspace(0.01, np.pi / 2 - 0.01, 400)
    total = total_reflection(np.cos(angles), 1.333)
    np.testing.assert_array_equal(total, angles > critical)
    np.testing.assert_array_equal(dielectric(np.cos(angles), 1 / 1.333) == 1, total)


def test_the_papers_condition_never_holds():
    """Its η is 1/n of the medium: then 1 − η²(1 − cos²θ) > 0 at every angle."""
    cosines = np.linspace(0, 1, 1001)
    for index in (1.0001, 1.333, 1.5, 2.4):
        assert not paper_condition(cosines, index).any()
        assert not (dielectric(cosines[1:], index) == 1).any()
