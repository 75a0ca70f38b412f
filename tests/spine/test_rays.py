"""Embree's rays, held against closed forms and against a plain intersection in float64."""

import numpy as np
import pytest

from andon.quantities import Geometry
from andon.rays import RayScene, face_normals
from comparison import assert_agree

SQUARE = Geometry(
    np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]),
    np.array([[0, 1, 2], [0, 2, 3]], np.int32),
)
NOTHING = Geometry(np.zeros((0, 3)), np.zeros((0, 3), np.int32))


def soup(count, seed):
    generator = np.random.default_rng(seed)
    corners = generator.normal(size=(count, 1, 3)) + generator.normal(size=(count, 3, 3)) * 0.4
    return Geometry(corners.reshape(-1, 3), np.arange(3 * count, dtype=np.int32).reshape(-1, 3))


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def plain_distances(geometry, origin, directions):
    """(rays,) nearest distance, inf where there is none, by 3×3 systems."""
    a, b, c = np.moveaxis(geometry.positions[geometry.triangles], 1, 0)
    nearest = np.full(len(directions), np.inf)
    for index, direction in enumerate(directions):
        sides = np.stack([b - a, c - a, np.broadcast_to(-direction, a.shape)], axis=-1)
        u, v, t = np.linalg.solve(sides, (origin - a)[..., None])[..., 0].T
        hit = (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0)
        nearest[index] = t[hit].min(initial=np.inf)
    return nearest


def test_a_square_from_above():
    rays = unit(np.array([[0, 0, -1.0], [0.3, 0.2, -1], [2, 0, -1], [0, 0, 1]]))
    origins = np.broadcast_to([0, 0, 1.0], rays.shape)
    hits = RayScene(SQUARE).first_hits(origins, rays)
    expected = [1, np.linalg.norm([0.3, 0.2, -1])]
    assert_agree(hits.distance[:2], expected, rtol=1e-14)
    assert np.isinf(hits.distance[2:]).all()
    assert (hits.triangle[2:] == -1).all()
    assert np.isnan(hits.barycentric[2:]).all()


def test_random_triangles_against_plain_intersection():
    geometry = soup(60, seed=1)
    directions = unit(np.random.default_rng(2).normal(size=(400, 3)))
    origin = np.array([0.05, -0.1, 0.2])
    hits = RayScene(geometry).first_hits(np.broadcast_to(origin, directions.shape), directions)
    expected = plain_distances(geometry, origin, directions)
    found = np.isfinite(hits.distance)
    # Embree is float32: rays within 1e-6 of an edge may differ, here none of them does.
    assert (found == np.isfinite(expected)).all()
    assert 0.2 < found.mean() < 1
    assert_agree(hits.distance[found], expected[found], rtol=1e-9)
    corners = geometry.positions[geometry.triangles[hits.triangle[found]]]
    points = np.einsum("nij,ni->nj", corners, hits.barycentric[found])
    assert_agree(points, origin + directions[found] * expected[found, None], atol=1e-9)


def test_precision_far_from_the_origin_is_float64s_once_the_triangle_is_chosen():
    shift = np.array([300.0, -200.0, 500.0])
    moved = Geometry(SQUARE.positions + shift, SQUARE.triangles)
    origin = shift + np.array([0.3, 0.2, 1.7])
    hits = RayScene(moved).first_hits(origin[None], np.array([[0, 0, -1.0]]))
    assert hits.distance[0] == pytest.approx(1.7, abs=1e-10)


def test_visibility_ends_at_the_lamp():
    scene = RayScene(SQUARE)
    above = np.array([[0.2, 0.1, 1.0], [0.2, 0.1, 0.5], [5, 0, 1]])
    assert scene.is_visible(above, np.array([0.2, 0.1, 2.0])).all()
    assert scene.is_visible(above, np.array([0.2, 0.1, -1.0])).tolist() == [False, False, True]
    # A lamp on the square, seen from above it, is not shadowed by the square.
    assert scene.is_visible(above, np.array([0.2, 0.1, 0.0])).all()


def test_visibility_of_infinity():
    scene = RayScene(SQUARE)
    points = np.array([[0, 0.1, -1.0], [0, 0.1, 1], [3, 0, -1]])
    assert scene.sees_infinity(points, np.array([0, 0, 1.0])).tolist() == [False, True, True]


def test_crossings_of_a_box_are_even_outside_and_odd_inside():
    geometry = box_geometry()
    directions = unit(np.random.default_rng(3).normal(size=(40, 3)))
    centre = geometry.positions.mean(axis=0)
    inside = RayScene(geometry).crossings(centre + np.array([0.1, 0.2, 0.3]), directions)
    outside = RayScene(geometry).crossings(centre + np.array([5, 0.2, 0.3]), directions)
    assert (inside == 1).all()
    assert set(outside.tolist()) <= {0, 2}


def box_geometry(size=(2, 2, 2), shift=(0, 0, 0)):
    from andon.verify.solids import box

    solid = box(size)
    return Geometry(solid.positions + np.asarray(shift, float), solid.triangles.astype(np.int32))


def test_crossings_on_edges_and_corners_are_counted_once():
    """Diagonals, edges, corners and axes of a cube around its own middle, to the bit."""
    geometry = box_geometry()
    middle = (geometry.positions.min(axis=0) + geometry.positions.max(axis=0)) / 2
    corners = np.unique(geometry.positions, axis=0) - middle
    steps = np.array([-1.0, 0, 1])
    grid = np.stack(np.meshgrid(steps, steps, steps), axis=-1).reshape(-1, 3)
    directions = np.concatenate([corners, grid[np.abs(grid).sum(axis=1) > 0]])
    inside = RayScene(geometry).crossings(middle, directions)
    assert (inside == 1).all(), inside
    outside = RayScene(geometry).crossings(middle + np.array([5.0, 0, 0]), directions)
    assert (outside % 2 == 0).all(), outside


@pytest.mark.parametrize("seed", range(6))
def test_crossings_through_every_corner_and_edge_of_a_ball(seed):
    """Aimed at what triangles share, with all the rounding of odd numbers: still one way out."""
    from worlds import ball

    generator = np.random.default_rng(seed)
    geometry = ball(1.0, generator.normal(size=3), 3)
    triangles = geometry.positions[geometry.triangles]
    targets = np.concatenate([geometry.positions, (triangles[:, 0] + triangles[:, 1]) / 2])
    inside = geometry.positions.mean(axis=0) + generator.normal(size=3) * 0.2
    assert (RayScene(geometry).crossings(inside, unit(targets - inside)) == 1).all()
    outside = inside + 3 * unit(generator.normal(size=3))
    assert (RayScene(geometry).crossings(outside, unit(targets - outside)) % 2 == 0).all()


@pytest.mark.filterwarnings("error")
def test_crossings_take_triangles_without_area_and_are_silent():
    """Corners that are one, and corners in a row, in a wall and across the box."""
    solid = box_geometry((2, 2, 2))
    low, high = solid.positions.min(axis=0), solid.positions.max(axis=0)
    a, b = solid.positions[solid.triangles[0, :2]]
    extra = [a, a, a, a, b, b, a, (a + b) / 2, b, low, (low + high) / 2, high]
    positions = np.concatenate([solid.positions, extra])
    more = len(solid.positions) + np.arange(len(extra)).reshape(-1, 3)
    flat = RayScene(Geometry(positions, np.concatenate([solid.triangles, more]).astype(np.int32)))
    middle = (low + high) / 2 + (0.1, -0.2, 0.3)
    directions = unit(np.random.default_rng(4).normal(size=(200, 3)))
    at_extra = unit(np.array(extra[3:9]) - middle)
    everywhere = np.concatenate([directions, at_extra, unit(np.eye(3))])
    assert (flat.crossings(middle, everywhere) == 1).all()
    assert (flat.crossings(middle + np.array([9.0, 0, 0]), everywhere) % 2 == 0).all()
    # From a place in the plane of a triangle, and from one of its corners: no warning either.
    flat.crossings(a, everywhere)


def test_crossings_of_a_torn_sheet_are_those_of_its_triangles():
    geometry = soup(80, seed=5)
    directions = unit(np.random.default_rng(6).normal(size=(100, 3)))
    origin = np.array([0.05, -0.1, 0.2])
    each = [
        np.isfinite(plain_distances(Geometry(geometry.positions, t[None]), origin, directions))
        for t in geometry.triangles
    ]
    assert (RayScene(geometry).crossings(origin, directions) == np.sum(each, axis=0)).all()


def test_an_empty_scene_hides_nothing():
    scene = RayScene(NOTHING)
    points = np.zeros((3, 3))
    assert scene.is_visible(points, np.ones(3)).all()
    assert scene.sees_infinity(points, np.ones(3)).all()
    assert (scene.first_hits(points, np.ones((3, 3))).triangle == -1).all()
    assert scene.crossings(points[0], np.ones((3, 3))).tolist() == [0, 0, 0]
    assert len(scene.first_hits(points[:0], points[:0]).triangle) == 0


def test_normals_of_faces_and_of_faces_without_area():
    flat = Geometry(SQUARE.positions, np.array([[0, 1, 2], [0, 0, 1]], np.int32))
    assert face_normals(flat).tolist() == [[0, 0, 1], [0, 0, 0]]
