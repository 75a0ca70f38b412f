"""Closed forms of direct light, and of shadows that can be drawn with a ruler."""

import numpy as np
import pytest

from andon.lamps import DirectionalLamp, HemisphereLamp, PointLamp, SkyLamp, SpotLamp
from andon.quantities import Geometry
from andon.transport.direct.casters import REAL, Casters, ShadowRays
from andon.transport.direct.reference import illuminance, visibility
from andon.verify.rows.closed_forms import point_reference
from worlds import ball, block, unit

UP = np.array([0.0, 1.0, 0.0])
GREY = np.ones(3)


def rays(geometry):
    return ShadowRays(Casters(((REAL, geometry),)))


def test_point_spot_and_directional_from_zenith_past_the_horizon():
    assert point_reference() < 1e-6


def test_one_candela_a_metre_above_gives_one_lux_not_one_over_pi():
    lamp = PointLamp("p", 1.0 * UP, GREY)
    np.testing.assert_allclose(illuminance(lamp, np.zeros(3), UP), GREY)


def test_inverse_square_and_cosine_in_a_batch():
    points = np.random.default_rng(0).uniform(-3, 3, (4, 5, 3)) - [0, 4, 0]
    got = illuminance(PointLamp("p", np.zeros(3), 7 * GREY), points, np.broadcast_to(UP, (4, 5, 3)))
    distance = np.linalg.norm(points, axis=-1)
    expected = 7 * -points[..., 1] / distance**3
    np.testing.assert_allclose(got, expected[..., None] * GREY, rtol=1e-12)


def test_flux_through_a_sphere_is_four_pi():
    """Gauss: ∮ E dA over a sphere around an off-centre lamp is the lamp's whole flux."""
    sphere = ball(1.0, (0, 0, 0), 40)
    corners = sphere.positions[sphere.triangles]
    centre = corners.mean(axis=1)
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(cross, axis=1) / 2
    inward = -cross / (2 * area[:, None])
    got = illuminance(PointLamp("p", np.array([0.3, 0.2, -0.1]), GREY), centre, inward)
    assert (got[:, 0] * area).sum() == pytest.approx(4 * np.pi, rel=2e-3)


def test_a_surface_that_faces_away_gets_nothing():
    behind = illuminance(PointLamp("p", -UP, GREY), np.zeros(3), UP)
    below = illuminance(DirectionalLamp("d", UP, GREY), np.zeros(3), UP)
    assert not behind.any()
    assert not below.any()


def test_spot_is_its_intensity_on_the_axis_and_zero_outside():
    lamp = SpotLamp("s", 2 * UP, 8 * GREY, None, 0.0, -UP, 0.3, 0.5)
    np.testing.assert_allclose(illuminance(lamp, np.zeros(3), UP), 2 * GREY)
    outside = np.array([2 * np.tan(0.51), 0, 0])
    assert not illuminance(lamp, outside, UP).any()


@pytest.mark.parametrize(("normal", "share"), [(UP, 1.0), (-UP, 0.0), (np.array([1.0, 0, 0]), 0.5)])
def test_sky_is_whole_above_half_at_a_wall_none_below(normal, share):
    got = illuminance(SkyLamp("s", UP, 100 * GREY), np.zeros(3), normal)
    np.testing.assert_allclose(got, 100 * share * GREY, atol=1e-12)


def test_hemisphere_adds_the_ground():
    lamp = HemisphereLamp("h", UP, 100 * GREY, 20 * GREY)
    np.testing.assert_allclose(illuminance(lamp, np.zeros(3), -UP), 20 * GREY)
    np.testing.assert_allclose(illuminance(lamp, np.zeros(3), unit([1, 0, 0])), 60 * GREY)


def test_the_shadow_of_a_square_has_the_size_that_similar_triangles_give_it():
    corners = np.array([[-1, 1, -1], [1, 1, -1], [1, 1, 1], [-1, 1, 1.0]])
    square = rays(Geometry(corners, np.array([[0, 1, 2], [0, 2, 3]], np.int32)))
    x = np.linspace(-4, 4, 801) + 1e-4
    points = np.stack([x, np.zeros_like(x), np.zeros_like(x)], axis=1)
    lit = visibility(PointLamp("p", 2.0 * UP, GREY), points, square)
    np.testing.assert_array_equal(lit, np.abs(x) > 2)  # twice as far, twice as large
    sun = visibility(DirectionalLamp("d", -UP, GREY), points, square)
    np.testing.assert_array_equal(sun, np.abs(x) > 1)


def test_lamps_without_shadow_and_ambient_lamps_are_seen_from_everywhere():
    casters = rays(block((9, 0.1, 9), (0, 1, 0)))
    points = np.zeros((5, 3))
    for lamp in (PointLamp("p", 2 * UP, GREY, None), SkyLamp("s", UP, GREY)):
        assert visibility(lamp, points, casters).all()
    assert not visibility(PointLamp("q", 2 * UP, GREY), points, casters).any()


def test_no_casters_no_shadow():
    empty = rays(Geometry(np.zeros((0, 3)), np.zeros((0, 3), np.int32)))
    assert visibility(PointLamp("p", UP, GREY), np.zeros((3, 3)), empty).all()
