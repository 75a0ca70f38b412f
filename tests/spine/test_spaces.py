"""Where pixels look: identities of the three projections, poses, and the fixed conventions."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from andon.errors import InputError
from andon.spaces import View, invert_rigid, look_at, rotate, transform_points
from comparison import assert_agree

sizes = st.integers(1, 24)
shifts = st.floats(-5, 5)


@st.composite
def views(draw):
    projection = draw(st.sampled_from(["pinhole", "fisheye", "latlong"]))
    width, height = draw(sizes), draw(sizes)
    if projection == "latlong":
        return View(projection, width, height)
    # An equidistant image ends at θ = π: its radius in pixels stays below π·f.
    least = 10.0 if projection == "pinhole" else 12.0
    fx, fy = draw(st.floats(least, 200)), draw(st.floats(least, 200))
    cx, cy = (width - 1) / 2 + draw(shifts), (height - 1) / 2 + draw(shifts)
    return View(projection, width, height, fx, fy, cx, cy)


@given(views(), st.floats(0.01, 1000))
def test_projecting_a_direction_gives_its_pixel(view, distance):
    assert_agree(view.project(view.directions() * distance), view.pixel_grid(), atol=1e-8)


@given(views())
def test_directions_are_unit_and_planar_rays_run_along_them(view):
    directions, planar = view.directions(), view.rays_planar()
    assert_agree(np.linalg.norm(directions, axis=-1), np.ones(view.shape), atol=1e-12)
    along = planar / np.linalg.norm(planar, axis=-1, keepdims=True)
    assert_agree(along, directions, atol=1e-12)
    if view.projection == "pinhole":
        assert (planar[..., 2] == 1).all()


@given(views(), st.integers(1, 40), st.integers(1, 40))
def test_resizing_moves_no_direction(view, width, height):
    small = view.resized(width, height)
    back = view.project(small.directions())
    grid = small.pixel_grid()
    expected = (grid + 0.5) / (width, height) * (view.width, view.height) - 0.5
    assert_agree(back, expected, atol=1e-7)


@given(sizes, sizes)
def test_latlong_pixels_share_the_whole_sphere(width, height):
    solid = View("latlong", width, height).solid_angles()
    assert solid.min() > 0
    assert solid.sum() == pytest.approx(4 * np.pi, rel=1e-13)


def corner_solid_angle(x, y):
    """Solid angle of the rectangle from the axis to (x, y) at distance 1."""
    return np.arctan(x * y / np.sqrt(1 + x * x + y * y))


@pytest.mark.parametrize("focal", [8.0, 40.0, 300.0])
def test_pinhole_solid_angles_against_the_closed_form(focal):
    view = View("pinhole", 33, 20, focal, focal, 14.0, 11.5)
    x = (np.arange(34) - 0.5 - view.cx) / focal
    y = (np.arange(21) - 0.5 - view.cy) / focal
    corners = corner_solid_angle(x[None, :], y[:, None])
    exact = corners[1:, 1:] - corners[1:, :-1] - corners[:-1, 1:] + corners[:-1, :-1]
    assert_agree(view.solid_angles(), exact, rtol=focal**-2 / 4 * 1.05)


def test_fisheye_hemisphere_has_two_pi():
    view = View("fisheye", 400, 400, 120.0, 120.0, 199.5, 199.5)
    forward = view.directions()[..., 2] > 0
    # The rim is one pixel wide and cut at pixel centres: 2π·(π/2)·f pixels of 1/f² · 2/π each.
    assert view.solid_angles()[forward].sum() == pytest.approx(2 * np.pi, rel=1e-3)


def test_conventions_of_the_default_camera():
    """x right, y down, z forward; it looks along −Z with +Y up."""
    view = View("pinhole", 5, 5, 4.0, 4.0, 2.0, 2.0)
    origin, rays = view.rays_world()
    assert origin.tolist() == [0, 0, 0]
    assert rays[2, 2].tolist() == [0, 0, -1]
    assert rays[2, 4, 0] > 0
    assert rays[0, 2, 1] > 0


def test_conventions_of_a_panorama():
    """Centre −Z, right +X, up +Y, by a picture of odd size whose middle pixel is the centre."""
    rays = View("latlong", 9, 5).rays_world()[1]
    assert_agree(rays[2, 4], [0, 0, -1], atol=1e-12)
    assert rays[2, 6, 0] > 0.9
    assert rays[0, 4, 1] > 0.9


def test_fisheye_is_equidistant():
    view = View("fisheye", 101, 3, 20.0, 20.0, 50.0, 1.0)
    angle = np.arccos(view.directions()[1, :, 2])
    assert_agree(angle, np.abs(np.arange(101) - 50) / 20, atol=1e-7)


def test_what_is_behind_has_no_pixel():
    pinhole = View("pinhole", 5, 5, 4.0, 4.0, 2.0, 2.0)
    assert np.isnan(pinhole.project([[0, 0, -1], [1, 1, 0]])).all()
    # Straight behind a fisheye every azimuth is as good as any other; the centre is none of them.
    fisheye = replace(pinhole, projection="fisheye")
    assert np.isnan(fisheye.project([0, 0, -1])).all()
    assert fisheye.project([0, 0, 1]).tolist() == [2, 2]


coordinate = st.floats(-50, 50)
points = st.tuples(coordinate, coordinate, coordinate).map(np.array)


@given(points, points)
def test_look_at_puts_the_target_in_the_middle_and_up_above(eye, target):
    forward = target - eye
    if np.linalg.norm(np.cross(forward, (0, 1, 0))) < 1e-3:
        return
    pose = look_at(eye, target)
    view = View("pinhole", 9, 7, 5.0, 5.0, 4.0, 3.0, world_from_camera=pose)
    assert np.linalg.det(pose[:3, :3]) == pytest.approx(1)
    seen = transform_points(view.camera_from_world, target)
    assert seen[2] == pytest.approx(np.linalg.norm(forward))
    assert_agree(view.project(seen), [4, 3], atol=1e-9)
    above = transform_points(view.camera_from_world, target + np.array([0, 0.01, 0]))
    assert above[1] < 0


def test_look_at_needs_a_plane():
    for target in ((0, 0, 0), (0, 3, 0)):
        with pytest.raises(InputError, match="span a plane"):
            look_at(np.zeros(3), np.array(target))


@given(points, points, points)
@settings(max_examples=50)
def test_the_inverse_of_a_pose_undoes_it(eye, target, point):
    if np.linalg.norm(np.cross(target - eye, (0, 1, 0))) < 1e-3:
        return
    pose = look_at(eye, target)
    assert_agree(invert_rigid(pose) @ pose, np.eye(4), atol=1e-9)
    there = transform_points(pose, point)
    assert_agree(transform_points(invert_rigid(pose), there), point, atol=1e-9)
    assert_agree(rotate(pose, point) + pose[:3, 3], there, atol=1e-9)


def posed(matrix):
    return View("latlong", 4, 2, world_from_camera=np.array(matrix, float))


@pytest.mark.parametrize(
    "matrix",
    [
        np.diag([2.0, 2, 2, 1]),
        np.diag([-1.0, 1, 1, 1]),
        np.eye(3),
        np.eye(4) * np.nan,
        np.eye(4)[::-1],
        np.eye(4) + np.eye(4, k=1) * 0.01,
    ],
    ids=["scaled", "mirrored", "3×3", "nan", "shuffled", "sheared"],
)
def test_poses_that_are_not_rigid_are_refused(matrix):
    with pytest.raises(InputError, match=r"camera\.world_from_camera: must be"):
        posed(matrix)


@pytest.mark.parametrize(
    ("fields", "field"),
    [
        ({"width": 0}, "width"),
        ({"height": 70000}, "height"),
        ({"fx": 0.0}, "fx"),
        ({"fy": -3.0}, "fy"),
        ({"fx": float("nan")}, "fx"),
        ({"cx": float("inf")}, "camera"),
        ({"distortion": (0.1, float("nan"))}, "camera"),
    ],
)
def test_intrinsics_out_of_range_are_refused(fields, field):
    good = {"width": 4, "height": 4, "fx": 1.0, "fy": 1.0}
    with pytest.raises(InputError, match=field):
        View("pinhole", **(good | fields))


def test_a_panorama_has_no_distortion():
    with pytest.raises(InputError, match="latlong has no distortion"):
        View("latlong", 4, 2, distortion=(0.1, 0, 0, 0))
