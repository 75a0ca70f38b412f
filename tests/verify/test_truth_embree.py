"""Embree's shadows against Möller–Trumbore in NumPy."""

import numpy as np
import pytest

from andon.errors import InputError
from andon.quantities import Geometry
from andon.verify.rooms import furnished_room, lamps_in
from andon.verify.truths.embree import OFFSET_M, Visibility, visible


def blocked(geometry, origins, targets):
    """(n,) bool by testing every triangle (Möller & Trumbore 1997), float64."""
    a, b, c = (geometry.positions[geometry.triangles[:, k]] for k in range(3))
    first, second = b - a, c - a
    result = []
    for origin, target in zip(origins, targets, strict=True):
        ray = target - origin
        p = np.cross(ray, second)
        with np.errstate(divide="ignore", invalid="ignore"):
            inverse = 1 / np.einsum("ij,ij->i", first, p)
            s = origin - a
            u = np.einsum("ij,ij->i", s, p) * inverse
            q = np.cross(s, first)
            v = (q @ ray) * inverse
            t = np.einsum("ij,ij->i", second, q) * inverse
            hit = (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0) & (t < 1)
        result.append(hit.any())
    return np.array(result)


@pytest.fixture(scope="module")
def room():
    return furnished_room(1)


def surface_points(geometry, count, seed):
    """Random places on the triangles, evenly by area, with their flat normals."""
    generator = np.random.default_rng(seed)
    corners = geometry.positions[geometry.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(normals, axis=1)
    chosen = generator.choice(len(area), count, p=area / area.sum())
    weights = generator.dirichlet((1, 1, 1), count)
    points = np.einsum("ij,ijk->ik", weights, corners[chosen])
    return points, normals[chosen] / area[chosen, None]


def test_agrees_with_brute_force(room):
    points, normals = surface_points(room, 400, 1)
    scene = Visibility(room)
    for lamp in lamps_in(room, 2):
        seen = scene.visible(points, normals, lamp.position)
        above = np.einsum("ij,ij->i", lamp.position - points, normals) > 0
        starts = points + OFFSET_M * normals
        expected = above & ~blocked(room, starts, np.tile(lamp.position, (len(points), 1)))
        assert 0.1 < expected.mean() < 0.9, "the test has to have both"
        # Only float32 against float64 at an edge may differ: one point in 400 at the very most.
        assert np.count_nonzero(seen != expected) <= 1


def test_an_occluder_casts_its_shadow():
    square = np.array([(-0.5, 1, -0.5), (-0.5, 1, 0.5), (0.5, 1, 0.5), (0.5, 1, -0.5)])
    geometry = Geometry(square, np.array([(0, 1, 2), (0, 2, 3)], np.int32))
    x = np.array([-1.01, -0.99, 0.0, 0.99, 1.01])
    points = np.column_stack([x, np.zeros(5), np.zeros(5)])
    normals = np.tile([0.0, 1.0, 0.0], (5, 1))
    # From 2 m the square's shadow on the floor is twice as wide: ±1 m.
    seen = visible(geometry, points, normals, (0.0, 2.0, 0.0))
    np.testing.assert_array_equal(seen, [True, False, False, False, True])


def test_below_the_horizon_nothing_is_seen():
    far = Geometry(np.eye(3) + 50, np.array([(0, 1, 2)], np.int32))
    lamp = (0.0, 1.0, 0.0)
    points = np.zeros((2, 3))
    np.testing.assert_array_equal(
        visible(far, points, np.array([(0.0, 1, 0), (0.0, -1, 0)]), lamp), [True, False]
    )


def test_no_points_give_no_answers(room):
    assert visible(room, np.empty((0, 3)), np.empty((0, 3)), (0, 1, 0)).shape == (0,)


@pytest.mark.parametrize(
    ("points", "normals"),
    [
        (np.full((1, 3), np.nan), np.ones((1, 3))),
        (np.ones((1, 2)), np.ones((1, 2))),
        (np.ones((2, 3)), np.ones((1, 3))),
    ],
    ids=["nan", "shape", "mismatch"],
)
def test_hostile_points_are_refused(room, points, normals):
    with pytest.raises(InputError):
        visible(room, points, normals, (0, 1, 0))


def test_an_empty_geometry_is_refused():
    with pytest.raises(InputError, match="at least one triangle"):
        Visibility(Geometry(np.empty((0, 3)), np.empty((0, 3), np.int32)))
