"""The nearest of many triangles, against closed forms and against all of them one by one."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from andon.quantities import Geometry
from andon.surface.nearest import nearest_distance
from comparison import assert_agree
from worlds import ball, block

from .test_triangles import plain_nearest

TRIANGLE = Geometry(np.array([[0.0, 0, 0], [4, 0, 0], [0, 4, 0]]), np.array([[0, 1, 2]], np.int32))


@pytest.mark.parametrize(
    ("point", "expected"),
    [
        ((1, 1, 3), 3.0),  # over the middle
        ((1, 1, -3), 3.0),  # and under it
        ((2, -3, 4), 5.0),  # beyond an edge
        ((-3, 0, 4), 5.0),  # beyond a corner
        ((4, 4, 0), 8**0.5),  # beyond the hypotenuse, in the plane
        ((1, 1, 0), 0.0),
        ((4, 0, 0), 0.0),
    ],
)
def test_one_triangle(point, expected):
    assert nearest_distance(np.array([point], float), TRIANGLE)[0] == pytest.approx(expected)
    turned = Geometry(TRIANGLE.positions, TRIANGLE.triangles[:, ::-1])
    assert nearest_distance(np.array([point], float), turned)[0] == pytest.approx(expected)


def test_a_box_inside_and_outside():
    points = np.random.default_rng(0).uniform(-2, 2, (500, 3))
    half = np.array([0.5, 1.0, 0.25])
    over = np.abs(points) - half
    outside = np.linalg.norm(np.maximum(over, 0), axis=1)
    expected = np.where((over < 0).all(axis=1), -over.max(axis=1), outside)
    assert_agree(nearest_distance(points, block(2 * half, (0, 0, 0))), expected, atol=1e-12)


def test_the_centre_of_a_ball_has_all_of_it_equally_near():
    geometry = ball(1.0, (5, 0, 0), 24)
    corners = geometry.positions[geometry.triangles] - (5, 0, 0)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    planes = np.einsum("ij,ij->i", corners[:, 0], normals)
    found = nearest_distance(np.array([[5.0, 0, 0]] * 3), geometry)
    assert_agree(found, [planes.min()] * 3, atol=1e-12)


@given(st.integers(0, 2**32 - 1), st.integers(1, 60))
@settings(max_examples=60, deadline=None)
def test_all_triangles_one_by_one(seed, count):
    """Long ones, tiny ones, some shared corners, some without an area."""
    generator = np.random.default_rng(seed)
    positions = generator.normal(size=(count + 2, 3)) * 10.0 ** generator.uniform(-2, 1)
    positions[::3] = positions[0]
    geometry = Geometry(
        positions, generator.integers(0, len(positions), (count, 3)).astype(np.int32)
    )
    points = np.concatenate([generator.normal(size=(20, 3)), positions[:3]])
    expected = [plain_nearest(geometry, point) for point in points]
    assert_agree(nearest_distance(points, geometry), expected, rtol=1e-9, atol=1e-7)


def test_many_points_walk_in_groups_and_keep_their_order():
    geometry = ball(1.0, (0, 0, 0), 6)
    points = np.random.default_rng(1).normal(size=(2500, 3))
    whole = nearest_distance(points, geometry)
    assert_agree(whole[::-1], nearest_distance(points[::-1], geometry), atol=1e-15)
    assert_agree(whole[2400:], nearest_distance(points[2400:], geometry), atol=1e-15)


def test_nothing_is_infinitely_far():
    empty = Geometry(np.zeros((0, 3)), np.zeros((0, 3), np.int32))
    assert nearest_distance(np.zeros((2, 3)), empty).tolist() == [np.inf, np.inf]
    assert nearest_distance(np.zeros((0, 3)), TRIANGLE).shape == (0,)
