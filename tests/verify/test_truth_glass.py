"""The truth of glass: Mitsuba's rays against closed forms, and images of points without glass."""

import numpy as np
import pytest

from andon.glass.model import Backdrop, Ball, LensShape, Slab, Solid
from andon.spaces import look_at, pinhole_view
from andon.verify.truths.mitsuba_glass import (
    GlassScene,
    concentric_square,
    lens_landing,
    lens_mesh,
    mitsuba,
    sensor_of,
    sensor_ray,
)
from andon.verify.truths.point_images import image_of_point, pupil_points
from requirements import required

required("mitsuba")

INDEX = 1.51
EYE = np.array([0.0, 0.0, 0.4])
BACKDROP = Backdrop(
    "texture",
    centre_m=np.array([0, 0, -0.2]),
    right_m=np.array([0.6, 0, 0]),
    up_m=np.array([0, 0.45, 0]),
)


def scene_of(shape, **keys):
    return GlassScene([Solid("one", shape, index=(INDEX,) * 3, backdrop=BACKDROP, **keys)])


def rays(angles):
    """From the eye, `angles` off the axis towards +x."""
    directions = np.stack([np.sin(angles), 0 * angles, -np.cos(angles)], axis=1)
    return np.broadcast_to(EYE, directions.shape), directions


def through_ball(angles, radius=0.075):
    """x on the backdrop: a ray of impact parameter b is turned by 2(i − r), sin i = b/R."""
    impact = EYE[2] * np.sin(angles)
    incidence = np.arcsin(impact / radius)
    refraction = np.arcsin(np.sin(incidence) / INDEX)
    way = angles - 2 * (incidence - refraction)
    # It leaves the ball where the chord ends, turned by π − 2r around the centre.
    entry = np.pi / 2 - (incidence - angles)
    exit_ = entry - (np.pi - 2 * refraction)
    x, z = radius * np.cos(exit_), radius * np.sin(exit_)
    return x + (z + 0.2) * np.tan(way)


def test_rays_through_a_ball_land_where_snell_says():
    angles = np.linspace(0.01, 0.16, 12)
    landing = scene_of(Ball(0.075)).land(*rays(angles))
    np.testing.assert_allclose(landing.points[:, 0], through_ball(angles), atol=2e-6)
    assert landing.glass.all()
    assert landing.transmitted[0] == pytest.approx(1 - 2 * (0.51 / 2.51) ** 2, abs=2e-3)


def test_one_interface_goes_straight_on():
    angles = np.array([0.05, 0.1])
    landing = scene_of(Ball(0.075), interfaces=1).land(*rays(angles))
    incidence = np.arcsin(EYE[2] * np.sin(angles) / 0.075)
    turn = angles - (incidence - np.arcsin(np.sin(incidence) / INDEX))
    entry = np.pi / 2 - (incidence - angles)
    x, z = 0.075 * np.cos(entry), 0.075 * np.sin(entry)
    np.testing.assert_allclose(landing.points[:, 0], x + (z + 0.2) * np.tan(turn), atol=2e-6)


def test_a_slab_shifts_rays_sideways():
    angles = np.array([0.05, 0.15])
    landing = scene_of(Slab(np.array([0.1, 0.1, 0.01]))).land(*rays(angles))
    inside = np.arcsin(np.sin(angles) / INDEX)
    wanted = 0.58 * np.tan(angles) + 0.02 * np.tan(inside)
    np.testing.assert_allclose(landing.points[:, 0], wanted, atol=2e-6)


def test_a_lens_is_two_caps_and_a_rim():
    shape = LensShape(0.04, (0.1, -0.3), 0.02)
    mesh = lens_mesh(shape)
    front = mesh.normals[:, 2] > 0.1
    centre = np.array([0, 0, 0.01 - 0.1])
    out = mesh.positions[front] - centre
    np.testing.assert_allclose(np.linalg.norm(out, axis=1), 0.1, atol=1e-12)
    np.testing.assert_allclose(out / 0.1, mesh.normals[front], atol=1e-12)
    a, b, c = mesh.positions[mesh.triangles].transpose(1, 0, 2)
    assert np.einsum("ij,ij->", a, np.cross(b, c)) > 0  # faces look outwards


def test_the_sensor_looks_where_the_view_does():
    view = pinhole_view(64, 36, 80.0, look_at(np.array([0.1, 0.2, 0.4]), np.array([0.3, 0, -1])))
    _, directions = view.rays_world()
    for row, column in ((3, 50), (30, 7)):
        film = ((column + 0.5) / 64, (row + 0.5) / 36)
        ray = sensor_ray(sensor_of(view), film, (0.5, 0.5))
        np.testing.assert_allclose(np.array(ray.d), directions[row, column], atol=1e-6)


def test_the_pupils_map_is_undone():
    disc = pupil_points(50)
    back = [mitsuba().warp.square_to_uniform_disk_concentric(p) for p in concentric_square(disc)]
    np.testing.assert_allclose(np.array(back).reshape(-1, 2), disc, atol=1e-6)
    assert np.mean((disc**2).sum(axis=1)) == pytest.approx(0.5)


def test_without_glass_a_points_image_is_the_disc_of_a_thin_lens():
    aside = np.eye(4)
    aside[0, 3] = 3.0
    scene = scene_of(Ball(0.01), world_from_glass=aside)
    view = pinhole_view(1280, 720, 1758.0, look_at(EYE, np.zeros(3)))
    middle = np.array([639.5, 359.5])
    lands = lens_landing(scene, view, 0.006, 0.4)
    image = image_of_point(lands, np.zeros(2), middle, places=200)
    assert image.found == 1
    assert image.disc_px == pytest.approx(0.006 * abs(1 / 0.4 - 1 / 0.6) * 1758, rel=2e-3)
    np.testing.assert_allclose(image.middle_px, middle, atol=0.02)
