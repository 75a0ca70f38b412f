"""Glass balls in the light of lamps: what is known without a table."""

from dataclasses import replace

import numpy as np
import pytest

from andon.lamps import DirectionalLamp, PointLamp, Shadow, SpotLamp
from andon.quantities import Geometry, Surface
from andon.spaces import View
from andon.transport.direct import reference as direct
from andon.transport.direct.balls import GLASS, GlassBall
from andon.transport.direct.balls.reference import through_balls
from andon.transport.direct.balls.table import CELLS, ROWS, angle_of, ball_table, polar_angle
from andon.transport.direct.casters import REAL, Casters, ShadowRays
from andon.verify.rows.caustic import flux_error, map_error, shadow_error
from worlds import unit

GREY, UP, DOWN = np.ones(3), np.array([0.0, 1, 0]), np.array([0.0, -1, 0])
CLEAR = GlassBall(np.zeros(3), 0.05)
NOTHING = ShadowRays(Casters(((REAL, Geometry(np.zeros((0, 3)), np.zeros((0, 3), np.int32))),)))
EDGES = angle_of(np.linspace(0, 1, CELLS + 1))
SOLID_ANGLE = np.diff(-2 * np.pi * np.cos(EDGES))


def on_floor(height, half, count, *, at=(0.0, 0.0)):
    """Middles of count² cells of a floor `height` under the origin, and the area of one."""
    line = half * ((np.arange(count) + 0.5) / count * 2 - 1)
    x, z = np.meshgrid(line + at[0], line + at[1])
    points = np.stack([x, np.full_like(x, -height), z], axis=-1).reshape(-1, 3)
    return points, np.tile(UP, (count**2, 1)), (2 * half / count) ** 2


def lit(lamp, balls, points, normals):
    """(n, 3) lux of the lamp beside and through the balls, nothing else in the way."""
    row = (1, len(points))
    nothing = np.zeros((*row, 3))
    surface = Surface(
        points[None], normals[None], np.ones(row), np.ones(row, bool), np.zeros(row, bool),
        nothing, np.zeros(row, np.int32), nothing, View("latlong", len(points), 1),
    )  # fmt: skip
    bias = np.zeros(row)
    return direct.illuminate(surface, [lamp], NOTHING, bias_m=bias, balls=balls)[0]


@pytest.mark.parametrize("lamp_vergence", [0.0, 0.1, 0.7])
@pytest.mark.parametrize("index", [1.33, 1.51, 2.4])
def test_every_concentric_sphere_has_all_of_the_flux(index, lamp_vergence):
    """∮ of a row is what the cone of the ball holds, less Fresnel twice and absorption."""
    table = ball_table(lamp_vergence, (index,) * 3, (0.0, 0.3, 3.0))
    incidence = (np.arange(200_000) + 0.5) / 200_000 * np.pi / 2
    bent = np.arcsin(np.sin(incidence) / index)
    across = np.sin(incidence - bent) / np.sin(incidence + bent)
    along = np.tan(incidence - bent) / np.tan(incidence + bent)
    passed = (1 - (across**2 + along**2) / 2) ** 2
    b = np.sin(incidence)
    weight = 2 * np.pi * b * np.cos(incidence) / np.sqrt(1 - (b * lamp_vergence) ** 2)
    for channel, absorption in enumerate((0.0, 0.3, 3.0)):
        values = weight * passed * np.exp(-2 * absorption * np.cos(bent))
        truth = values.mean() * np.pi / 2
        np.testing.assert_allclose(table.light[..., channel] @ SOLID_ANGLE, truth, rtol=1e-5)


@pytest.mark.parametrize("lamp_vergence", [0.0, 0.2])
@pytest.mark.parametrize("index", [1.4, 1.51, 1.8])
def test_the_axis_brightens_towards_the_paraxial_focus(index, lamp_vergence):
    """E·ρ²/E₀ = T/(v_f − v)², with 1/v_f = n/(2(n − 1)) radii behind the centre from afar."""
    table = ball_table(lamp_vergence, (index,) * 3, (0.0, 0.0, 0.0))
    vergence = np.arange(ROWS) / (ROWS - 1)
    focus = 2 * (index - 1) / index - lamp_vergence
    rows = np.searchsorted(vergence, [0.2 * focus, 0.5 * focus, 0.7 * focus])
    passed = (1 - ((index - 1) / (index + 1)) ** 2) ** 2
    found = vergence[rows] + np.sqrt(passed / table.light[rows, 0, 1])
    np.testing.assert_allclose(found, focus, rtol=3e-3)


def test_the_same_with_lamp_and_receiver_exchanged():
    b = np.linspace(0, 1, 50)
    np.testing.assert_allclose(polar_angle(b, 0.3, 0.8, 1.5), polar_angle(b, 0.8, 0.3, 1.5))


def test_the_shadow_has_the_radius_that_the_tangents_give_it():
    lamp = PointLamp("p", 0.5 * UP, GREY)
    ball = replace(CLEAR, absorption_per_m=(1e4,) * 3)  # as good as black
    edge = 0.6 * np.tan(np.arcsin(0.1))
    x = edge + np.array([-1e-6, 1e-6])
    points = np.stack([x, np.full(2, -0.1), np.zeros(2)], axis=1)
    open_, bent = through_balls(lamp, [ball], points, np.tile(UP, (2, 1)))
    assert open_.tolist() == [False, True]
    assert bent.max() < 1e-6
    sun = DirectionalLamp("s", DOWN, GREY)
    points[:, 0] = 0.05 + np.array([-1e-6, 1e-6])
    assert through_balls(sun, [ball], points, np.tile(UP, (2, 1)))[0].tolist() == [False, True]
    above = points + 0.3 * UP
    assert through_balls(sun, [ball], above, np.tile(UP, (2, 1)))[0].all()


def test_a_ball_of_air_changes_nothing():
    lamp = PointLamp("p", np.array([0.1, 0.5, 0.05]), GREY)
    points, normals, _ = on_floor(0.08, 0.2, 60)
    free = direct.illuminance(lamp, points, normals)
    np.testing.assert_array_equal(
        lit(lamp, [replace(CLEAR, index=(1.0,) * 3)], points, normals), free
    )


def test_a_ball_of_hardly_anything_gives_back_what_it_takes():
    lamp = PointLamp("p", np.array([0.1, 0.5, 0.05]), GREY)
    ball = replace(CLEAR, index=(1 + 1e-9,) * 3)
    points, normals, _ = on_floor(0.08, 0.2, 200)
    free = direct.illuminance(lamp, points, normals)
    gap = np.abs(lit(lamp, [ball], points, normals) / free - 1).max(axis=1)
    # Cells of the table reach over the shadow's edge.
    assert np.median(gap) < 1e-4
    assert (gap > 0.01).mean() < 0.02


@pytest.mark.parametrize("height", [0.15, 0.3])
def test_a_floor_gets_what_the_ball_lets_through(height):
    """Nearly: from 0.3 m, 3 % are bent past the 1.6 m of floor."""
    lamp = PointLamp("p", np.array([0.2, 0.8, 0.1]), GREY)
    points, normals, _ = on_floor(height, 0.8, 1000)
    taken = direct.illuminance(lamp, points, normals)
    is_open, bent = through_balls(lamp, [CLEAR], points, normals)
    through = bent[:, 1].sum() / taken[~is_open, 1].sum()
    vergence = CLEAR.lamp_vergence(lamp)
    whole = ball_table(vergence, CLEAR.index, (0.0,) * 3).light[0, :, 1] @ SOLID_ANGLE
    cone = 2 * np.pi * (1 - np.sqrt(1 - vergence**2))
    assert 0.96 < through / (whole * vergence**2 / cone) < 1


def test_absorption_takes_each_channel_along_the_chord():
    lamp = PointLamp("p", 0.5 * UP, GREY)
    tinted = replace(CLEAR, absorption_per_m=(0.0, 5.0, 20.0))
    point = np.array([[0.0, -0.3, 0.0]])
    clear, taken = (through_balls(lamp, [x], point, UP[None])[1][0] for x in (CLEAR, tinted))
    np.testing.assert_allclose(taken / clear, np.exp([0, -0.5, -2.0]), rtol=5e-3)


def test_dispersion_puts_the_blue_focus_nearer():
    lamp = DirectionalLamp("s", DOWN, GREY)
    ball = replace(CLEAR, index=(1.48, 1.51, 1.56))
    reach = np.linspace(0.052, 0.12, 400)
    points = np.stack([0 * reach, -reach, 0 * reach], axis=1)
    bent = through_balls(lamp, [ball], points, np.tile(UP, (400, 1)))[1]
    weak = bent / (reach**-2)[:, None]
    # Beyond its focus a channel falls: the one of the higher index first.
    last = [reach[np.nonzero(weak[:, c] > 0.3 * weak[:, c].max())[0][-1]] for c in range(3)]
    assert last[2] < last[1] < last[0]


def test_a_far_lamp_is_a_directional_one():
    far = PointLamp("p", 1e4 * UP, 1e8 * GREY)
    sun = DirectionalLamp("s", DOWN, GREY)
    points, normals, _ = on_floor(0.09, 0.1, 40)
    ball = [CLEAR]
    np.testing.assert_allclose(
        lit(far, ball, points, normals), lit(sun, ball, points, normals), rtol=2e-3
    )


def test_a_spot_is_as_bright_as_where_the_ray_leaves_it():
    at = np.array([0.0, 0.5, 0.0])
    points, normals, _ = on_floor(0.12, 0.2, 50)
    point = PointLamp("p", at, GREY)
    wide = SpotLamp("w", at, GREY, Shadow(), 0.0, DOWN, 1.2, 1.5)
    bent = [through_balls(x, [CLEAR], points, normals)[1] for x in (point, wide)]
    np.testing.assert_allclose(bent[1], bent[0])
    # The ball fills 5.7 degrees: a cone of 3 leaves its rim in the dark, and the middle as it is.
    narrow = SpotLamp("n", at, GREY, Shadow(), 0.0, DOWN, np.radians(2.9), np.radians(3.0))
    cut = through_balls(narrow, [CLEAR], points, normals)[1]
    assert 0.2 < cut.sum() / bent[0].sum() < 0.4
    aside = SpotLamp("a", at, GREY, Shadow(), 0.0, unit([1.0, -1, 0]), 0.1, 0.2)
    assert not through_balls(aside, [CLEAR], points, normals)[1].any()


def test_two_balls_in_a_row_make_no_light():
    lamp = PointLamp("p", 0.8 * UP, GREY)
    second = replace(CLEAR, centre_m=-0.13 * UP)
    points, normals, _ = on_floor(0.2, 0.4, 250)
    free = direct.illuminance(lamp, points, normals).sum()
    one = lit(lamp, [second], points, normals).sum()
    two = lit(lamp, [CLEAR, second], points, normals).sum()
    assert 0.95 * free < two < one < free


@pytest.mark.parametrize("shadow", [None, Shadow(through=frozenset([GLASS]))])
def test_lamps_without_a_shadow_or_from_before_the_glass_know_no_ball(shadow):
    lamp = PointLamp("p", 0.5 * UP, GREY, shadow)
    points, normals, _ = on_floor(0.1, 0.1, 10)
    free = direct.illuminance(lamp, points, normals)
    np.testing.assert_array_equal(lit(lamp, [CLEAR], points, normals), free)


def test_a_lamp_inside_a_ball_and_receivers_in_and_around_it():
    points = np.random.default_rng(1).uniform(-0.12, 0.12, (2000, 3))
    normals = unit(np.random.default_rng(2).normal(size=(2000, 3)))
    inside = PointLamp("p", np.array([0.01, 0, 0]), GREY)
    free = direct.illuminance(inside, points, normals)
    np.testing.assert_array_equal(lit(inside, [CLEAR], points, normals), free)
    for at in ([0.051, 0, 0], [0.0, 3, 0], [0.03, 0.05, 0.0]):
        lux = lit(PointLamp("p", np.array(at), GREY), [CLEAR], points, normals)
        assert np.isfinite(lux).all()
        assert (lux >= 0).all()


def test_photons_find_the_same_light():
    assert flux_error("reference", [0.0505, 0.15]) < 2e-3
    assert map_error("reference") < 0.03
    assert shadow_error("reference") < 1e-3
