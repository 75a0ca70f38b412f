"""Outlines of sources: closed forms of their areas, symmetry, and lamps in perspective."""

import numpy as np
import pytest

from andon.errors import InputError
from andon.glare import shapes
from andon.glare.lamp_sources import source_of_lamp
from andon.lamps import (
    DirectionalLamp,
    DiskLamp,
    PointLamp,
    PolygonLamp,
    SkyLamp,
    SphereLamp,
    SpotLamp,
    TubeLamp,
)
from andon.lamps.areas import MeshLamp
from andon.lamps.solids import icosphere
from andon.spaces import pinhole_view

D = np.pi / 180
VIEW = pinhole_view(64, 48, 60.0)
UP = np.array([0.0, 1.0, 0.0])
LUMINANCE = np.array([100.0, 200.0, 300.0])
AHEAD = np.array([0.3, 0.2, -4.0])


def plane_area(outline):
    phi = (np.arange(40000) + 0.5) / 40000 * 2 * np.pi
    return np.mean(outline.radius(phi) ** 2) * np.pi / D**2


def pear_area(r, n, d):
    touch = np.arccos((r - n) / d)
    return (np.pi - touch) * r**2 + touch * n**2 + d * np.sin(touch) * (r + n)


@pytest.mark.parametrize(
    ("outline", "area"),
    [
        (shapes.circle(1 * D), np.pi),
        (shapes.ellipse(3 * D, 1 * D), 3 * np.pi),
        (shapes.cylinder(3 * D, 0.2 * D), 0.04 * np.pi + 4 * 3 * 0.2),
        (shapes.hemisphere(1 * D), np.pi / 2),
        (shapes.pear(1 * D, 0.4 * D, 1.5 * D), pear_area(1, 0.4, 1.5)),
        (shapes.polygon(D * np.array([[-2, -1], [2, -1], [2, 1], [-2, 1]])), 8),
    ],
    ids=lambda value: getattr(value, "name", ""),
)
def test_areas(outline, area):
    np.testing.assert_allclose(plane_area(outline), area, rtol=1e-3)


def test_axes_of_an_ellipse():
    outline = shapes.ellipse(3 * D, 1 * D)
    np.testing.assert_allclose(outline.radius(np.array([0, np.pi / 2])) / D, [3, 1])


@pytest.mark.parametrize("outline", [shapes.hemisphere(2 * D), shapes.pear(2 * D, 0.6 * D, 3 * D)])
def test_centroids(outline):
    phi = (np.arange(40000) + 0.5) / 40000 * 2 * np.pi
    r3 = outline.radius(phi) ** 3
    moments = np.mean(r3 * np.cos(phi)), np.mean(r3 * np.sin(phi))
    np.testing.assert_allclose(moments, 0, atol=1e-3 * np.mean(r3))


def test_a_dome_is_flat_below_and_a_pear_is_narrow_above():
    dome, pear = shapes.hemisphere(2 * D), shapes.pear(2 * D, 0.6 * D, 3 * D)
    up, down = -np.pi / 2, np.pi / 2
    assert dome.radius(np.array(down)) < dome.radius(np.array(up))
    assert pear.radius(np.array(up)) > pear.radius(np.array(down))


def test_wrong_shapes():
    with pytest.raises(InputError, match="neck < radius"):
        shapes.pear(1 * D, 2 * D, 1 * D)
    with pytest.raises(InputError, match="must be in"):
        shapes.ellipse(-1 * D, 1 * D)
    with pytest.raises(InputError, match="seen whole"):
        shapes.polygon(D * np.array([[0, 0], [5, 0], [5, 5], [4.9, 5], [4.9, 0.1], [0, 0.1]]))


# ── lamps ────────────────────────────────────────────────────────────────────────────────────────


def towards(point):
    """In the camera frame of the default pose."""
    return np.array([1, -1, -1]) * point / np.linalg.norm(point)


def test_a_point_lamp():
    lamp = PointLamp("bulb", AHEAD, np.array([10.0, 20, 30]), visible_radius_m=0.05)
    source = source_of_lamp(lamp, VIEW)
    distance = np.linalg.norm(AHEAD)
    np.testing.assert_allclose(source.direction, towards(AHEAD))
    np.testing.assert_allclose(source.illuminance_lux, np.array([10, 20, 30]) / distance**2)
    np.testing.assert_allclose(source.outline.radii_radians, np.arcsin(0.05 / distance))
    # A disc of luminance I/(π r²), as it is drawn.
    drawn = np.array([10, 20, 30]) / (np.pi * 0.05**2)
    np.testing.assert_allclose(source.luminance_cd_m2, drawn, rtol=1e-3)
    assert source_of_lamp(PointLamp("unseen", AHEAD, np.ones(3)), VIEW) is None
    assert source_of_lamp(PointLamp("unseen", AHEAD, np.ones(3)), VIEW, point_radius_m=0.01)


@pytest.mark.parametrize(("tilt", "share"), [(0.0, 1.0), (0.2, 1.0), (0.45, 0.5), (0.8, 0.0)])
def test_a_spot_shines_towards_the_eye(tilt, share):
    back = -AHEAD / np.linalg.norm(AHEAD)
    side = np.cross(back, UP) / np.linalg.norm(np.cross(back, UP))
    axis = np.cos(tilt) * back + np.sin(tilt) * side
    lamp = SpotLamp("spot", AHEAD, np.ones(3), None, 0.05, axis, 0.3, 0.6)
    source = source_of_lamp(lamp, VIEW)
    if share == 0:
        assert source is None
    else:
        light = source.illuminance_lux * (AHEAD @ AHEAD)
        assert np.all(light > 0.1) if share < 1 else np.allclose(light, 1)
        assert np.all(light < 0.9) or share == 1


def test_a_sphere_has_its_solid_angle():
    source = source_of_lamp(SphereLamp("ball", LUMINANCE, AHEAD, 0.5), VIEW)
    sine2 = 0.25 / (AHEAD @ AHEAD)
    solid_angle = 2 * np.pi * (1 - np.sqrt(1 - sine2))
    np.testing.assert_allclose(source.illuminance_lux, LUMINANCE * solid_angle, rtol=1e-6)


@pytest.mark.parametrize("tilt", [0.0, 0.5, 1.3])
def test_a_disk_and_its_polygon(tilt):
    normal = np.array([np.sin(tilt), 0, np.cos(tilt)])
    source = source_of_lamp(DiskLamp("disk", LUMINANCE, np.array([0, 0, -5.0]), normal, 0.2), VIEW)
    expected = np.pi * 0.04 * np.cos(tilt) / 25
    np.testing.assert_allclose(source.luminance_cd_m2, LUMINANCE, rtol=1e-9)
    np.testing.assert_allclose(source.outline.solid_angle_sr, expected, rtol=6e-3)
    back = DiskLamp("disk", LUMINANCE, np.array([0, 0, -5.0]), -normal, 0.2)
    assert source_of_lamp(back, VIEW) is None


def test_a_rectangle_has_its_exact_solid_angle():
    x, y, z = 0.5, 0.3, 2.0
    corners = np.array([[-x, -y, -z], [x, -y, -z], [x, y, -z], [-x, y, -z]])
    source = source_of_lamp(PolygonLamp("panel", LUMINANCE, corners), VIEW)
    expected = 4 * np.arcsin(x * y / np.sqrt((x * x + z * z) * (y * y + z * z)))
    np.testing.assert_allclose(source.outline.solid_angle_sr, expected, rtol=1e-3)
    assert source_of_lamp(PolygonLamp("back", LUMINANCE, corners[::-1]), VIEW) is None


def test_a_tube_is_a_cylinder():
    ends = np.array([[-0.6, 0, -6.0], [0.6, 0, -6.0]])
    source = source_of_lamp(TubeLamp("tube", LUMINANCE, ends, 0.02), VIEW)
    np.testing.assert_allclose(source.outline.radii_radians.max(), np.arctan(0.62 / 6), rtol=2e-3)
    np.testing.assert_allclose(source.outline.radii_radians.min(), 0.02 / 6, rtol=2e-2)


def test_a_mesh_of_a_ball_is_a_sphere():
    ball = icosphere(3)
    mesh = MeshLamp("mesh", LUMINANCE, AHEAD + 0.5 * ball.positions, ball.triangles)
    sphere = source_of_lamp(SphereLamp("ball", LUMINANCE, AHEAD, 0.5), VIEW)
    source = source_of_lamp(mesh, VIEW)
    np.testing.assert_allclose(source.illuminance_lux, sphere.illuminance_lux, rtol=1e-2)
    np.testing.assert_allclose(source.direction, sphere.direction, atol=1e-3)


def test_the_sun_and_the_sky():
    sun = source_of_lamp(DirectionalLamp("sun", np.array([0, -0.6, 0.8]), LUMINANCE), VIEW)
    np.testing.assert_allclose(sun.direction, [0, -0.6, 0.8])
    np.testing.assert_allclose(sun.illuminance_lux, LUMINANCE)
    assert source_of_lamp(SkyLamp("sky", UP, LUMINANCE), VIEW) is None
    assert source_of_lamp(DirectionalLamp("night", UP, np.zeros(3)), VIEW) is None
