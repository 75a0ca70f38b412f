"""Lamps in a mirror: limits, and every kind of area against brute force."""

import numpy as np
import pytest

from andon.glare.highlights.model import Finish
from andon.glare.highlights.outlines import frames
from andon.glare.highlights.reference import (
    diffuse_share,
    facing_lux,
    is_mirrored,
    lamp_highlight,
    wide_highlight,
)
from andon.lamps import (
    DirectionalLamp,
    DiskLamp,
    MeshLamp,
    PointLamp,
    PolygonLamp,
    SkyLamp,
    SphereLamp,
    TubeLamp,
)
from glare.highlights.facets_for_tests import STEP_SR, brute_force, facet, ggx

ONES = np.ones(3)
SEEN = np.ones((1, 3))
SQUARE = np.array([[-0.3, -0.2, 0], [0.3, -0.2, 0], [0.3, 0.2, 0], [-0.3, 0.2, 0]])


def sphere(direction, radius, light=ONES):
    direction = np.array(direction, float)
    return SphereLamp("ball", light, direction / np.linalg.norm(direction), radius)


def facing_square(middle):
    """A rectangle at `middle` that faces the origin, as corners."""
    axis = -np.array(middle, float) / np.linalg.norm(middle)
    a, b = (v[0] for v in frames(axis[None]))
    return np.array(middle) + SQUARE[:, :1] * a + SQUARE[:, 1:2] * b


def through(corners, directions):
    """Which directions from the origin meet a convex polygon."""
    found = np.ones(len(directions), bool)
    middle = corners.mean(axis=0)
    for p, q in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        side = np.cross(p, q)
        found &= (directions @ side) * np.sign(middle @ side) > 0
    return found & (directions @ middle > 0)


@pytest.mark.parametrize("view", [(0, 0, 1), (-1, 0.4, 1), (-3, 0, 1)])
@pytest.mark.parametrize("base", [(1.0, 1.0, 1.0), (0.9, 0.6, 0.2)])
def test_smooth_metal_shows_reflectance_times_the_lamps_luminance(view, base):
    one = facet(view, ggx(0.002), base)
    lamp = sphere(one.mirror[0], 0.1, np.array([500.0, 400, 300]))
    expected = one.reflectance(one.cosine_view)[0] * lamp.luminance_cd_m2
    assert lamp_highlight(one, lamp, SEEN)[0] == pytest.approx(expected, rel=2e-3)


def test_beside_the_image_smooth_metal_is_dark():
    one = facet((-1, 0, 1), ggx(0.002))
    lamp = sphere(one.mirror[0] + (0, 0.3, 0), 0.1, 1e4 * ONES)
    assert lamp_highlight(one, lamp, SEEN).max() < 1.0


@pytest.mark.parametrize("alpha", [(0.2, 0.2), (0.5, 0.5), (0.6, 0.15)])
@pytest.mark.parametrize("direction", [(1, 0, 1), (0.7, 0.3, 1), (0.2, -0.5, 1)])
@pytest.mark.parametrize(("radius", "bound"), [(0.1, 0.02), (0.3, 0.07)])
def test_balls_against_brute_force(alpha, direction, radius, bound):
    """Lamps 12° and 35° wide: F·G₂ varies over the wider."""
    one = facet((-1, 0, 1), ggx(*alpha))
    lamp = sphere(direction, radius)
    edge = np.sqrt(1 - radius**2)
    brute = brute_force(one, lambda d: d @ lamp.position_m > edge)[0]
    assert lamp_highlight(one, lamp, SEEN)[0, 0] == pytest.approx(brute, rel=bound)


@pytest.mark.parametrize("exponent", [5.0, 40.0, 400.0])
@pytest.mark.parametrize("direction", [(1, 0, 1), (0.7, 0.3, 1)])
def test_balls_in_phongs_lobe(exponent, direction):
    one = facet((-1, 0, 1), Finish("phong", exponent=exponent, reflectance=(0.5, 0.5, 0.5)))
    lamp = sphere(direction, 0.3)
    brute = brute_force(one, lambda d: d @ lamp.position_m > np.sqrt(1 - 0.09))[0]
    assert lamp_highlight(one, lamp, SEEN)[0, 0] == pytest.approx(brute, rel=0.02, abs=1e-4)


def test_all_lamps_of_one_outline_have_one_highlight():
    """A polygon, a picture of one colour, a mesh, and a polygon seen from behind."""
    one = facet((-1, 0, 1), ggx(0.3))
    corners = facing_square((0.8, 0.2, 0.9))
    brute = brute_force(one, lambda d: through(corners, d))[0]
    triangles = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
    for lamp in (
        PolygonLamp("polygon", ONES, corners),
        PolygonLamp("picture", ONES, corners, texture=np.ones((4, 4, 3))),
        PolygonLamp("both sides", ONES, corners[::-1], two_sided=True),
        MeshLamp("mesh", ONES, corners, triangles),
    ):
        highlight = lamp_highlight(one, lamp, SEEN)[0, 0]
        assert highlight == pytest.approx(brute, rel=0.02), lamp.name
    behind = PolygonLamp("behind", ONES, corners[::-1])
    assert lamp_highlight(one, behind, SEEN).max() == 0


def test_a_disk_and_a_tube_against_brute_force():
    one = facet((-1, 0, 1), ggx(0.3))
    middle, normal = np.array([0.8, 0.1, 0.9]), np.array([-0.6, 0.2, -0.8])
    disk = DiskLamp("disk", ONES, middle, normal / np.linalg.norm(normal), 0.3)

    def on_disk(d):
        distance = (disk.direction @ middle) / (d @ disk.direction)
        off = d * distance[:, None] - middle
        return (np.linalg.norm(off, axis=1) < 0.3) & (distance > 0)

    assert lamp_highlight(one, disk, SEEN)[0, 0] == pytest.approx(
        brute_force(one, on_disk)[0], rel=0.03
    )
    ends = np.array([[0.8, -0.4, 0.9], [0.8, 0.5, 0.7]])
    tube = TubeLamp("tube", ONES, ends, 0.08)

    def on_tube(d):
        along = np.linspace(0, 1, 60)[:, None]
        points = ends[0] + along * (ends[1] - ends[0])
        reach = d @ points.T
        square = (points**2).sum(axis=1)
        return ((square - reach**2) < 0.08**2).any(axis=1)

    assert lamp_highlight(one, tube, SEEN)[0, 0] == pytest.approx(
        brute_force(one, on_tube)[0], rel=0.04
    )


@pytest.mark.parametrize("finish", [
    ggx(0.3), ggx(0.5, 0.2), Finish("phong", exponent=20.0, reflectance=(0.8, 0.7, 0.6)),
])  # fmt: skip
def test_a_small_ball_is_a_point(finish):
    one = facet((-1, 0, 1), finish)
    position, radius = np.array([1.5, 0.4, 2.0]), 0.02
    ball = SphereLamp("ball", 1e4 * ONES, position, radius)
    point = PointLamp("point", position, 1e4 * np.pi * radius**2 * ONES)
    lux = point.intensity_cd / (position @ position) * SEEN
    small = lamp_highlight(one, point, lux)
    assert lamp_highlight(one, ball, SEEN) == pytest.approx(small, rel=5e-3)
    drawn = PointLamp("drawn", position, point.intensity_cd, visible_radius_m=radius)
    assert lamp_highlight(one, drawn, lux) == pytest.approx(small, rel=5e-3)


def test_lamps_below_the_horizon_are_not_seen():
    one = facet((-1, 0, 1), ggx(0.4))
    for direction in ((0, 0, -1), (1, 0, -1), (0.3, 0.1, -0.9)):
        assert lamp_highlight(one, sphere(direction, 0.3), SEEN).max() == 0
    sun = DirectionalLamp("sun", np.array([0.0, 0, 1]), ONES)
    assert lamp_highlight(one, sun, SEEN).max() == 0


def test_lux_on_a_plane_that_faces_the_lamp():
    one = facet((-1, 0, 1), ggx(0.4))
    point = PointLamp("point", np.array([1.0, 0, 1]), 8 * ONES)
    on_surface = 8 / 2 * np.cos(np.pi / 4) * SEEN
    assert facing_lux(point, one, on_surface) == pytest.approx(4 * SEEN)


def test_a_sky_is_mirrored_above_and_not_below():
    lamp = SkyLamp("sky", np.array([0.0, 0, 1]), 300 * ONES)
    smooth = facet((-1, 0, 1), ggx(0.002))
    assert wide_highlight(smooth, [lamp], np.zeros((1, 3))) == pytest.approx(
        300 / np.pi * SEEN, rel=2e-3
    )
    below = SkyLamp("below", np.array([0.0, 0, -1]), 300 * ONES)
    assert wide_highlight(smooth, [below], np.zeros((1, 3))).max() == 0


def test_what_is_mirrored_is_not_diffuse_as_well():
    metal = facet((-1, 0, 1), ggx(0.3, metallic=1.0))
    plastic = facet((-1, 0, 1), ggx(0.3, metallic=0.0))
    assert diffuse_share(metal)[0] == 0
    assert 0.9 < diffuse_share(plastic)[0] < 0.97
    white = plastic.base[0, 0] * diffuse_share(plastic)[0]
    assert white + brute_force(plastic)[0] <= 1.002


def test_light_that_is_taken_away_is_not_mirrored():
    assert is_mirrored(sphere((0, 0, 1), 0.1))
    assert not is_mirrored(sphere((0, 0, 1), 0.1, -ONES))


def test_the_hemisphere_of_these_tests_is_whole():
    assert brute_force(facet((0, 0, 1), Finish("phong", exponent=1.0, reflectance=(1, 1, 1))))[
        0
    ] == pytest.approx(1, rel=2e-3)
    assert pytest.approx(2 * np.pi) == STEP_SR * 2 * 300**2
