"""Inside or outside: solids, rooms, and surfaces that are neither."""

import numpy as np
import pytest

from andon.quantities import Geometry, merged
from andon.transport.probes.placement import Walls
from andon.transport.probes.placement.walls import winding_faults
from worlds import ball, block


def test_inside_a_solid_all_directions_show_backs():
    sight = Walls(ball(1.0, (0, 0, 0))).sight(np.array([[0, 0, 0], [0.5, 0.2, 0], [3, 0, 0]]))
    np.testing.assert_array_equal(sight.backs, [1, 1, 0])
    np.testing.assert_array_equal(sight.buried, [True, True, False])
    assert 0.95 < sight.nearest_m[0] <= 1.0


def test_inside_a_room_none_do():
    room = block((4, 3, 5), (0, 1.5, 0), inwards=True)
    inside = np.random.default_rng(1).uniform([-1.9, 0.1, -2.4], [1.9, 2.9, 2.4], (50, 3))
    assert not Walls(room).sight(inside).buried.any()


def test_the_way_out_leads_to_the_nearest_back():
    walls = Walls(block((2, 8, 8), (0, 0, 0)))
    points = np.array([[0.8, 0, 0], [5, 0, 0]])
    ways = walls.ways_out(points, np.full(3, -9.0), np.full(3, 9.0), 0.0)
    assert 0.2 <= np.linalg.norm(ways[0]) < 0.22
    assert ways[0, 0] == pytest.approx(0.2, abs=1e-6)
    assert np.isnan(ways[1]).all()
    # The near side is not in the box: the far one is.
    ways = walls.ways_out(points, np.full(3, -9.0), np.array([1.0, 9, 9]), 0.5)
    assert ways[0, 0] < -1.8
    assert points[0, 0] + ways[0, 0] < -1.4
    assert np.isnan(walls.ways_out(points, -np.ones(3), np.ones(3), 0.5)).all()


def test_no_triangles_are_open_space():
    nothing = Geometry(np.zeros((0, 3)), np.zeros((0, 3), np.int32))
    walls = Walls(nothing)
    assert walls.is_free(np.zeros((2, 3))).all()
    assert winding_faults(nothing) == (0, 0)


def test_closed_surfaces_have_no_faults_whatever_their_corners_are_called():
    one = block((1, 1, 1), (0, 0, 0))
    assert winding_faults(one) == (0, 0)
    own = one.triangles.ravel()
    soup = Geometry(one.positions[own], np.arange(36, dtype=np.int32).reshape(-1, 3))
    assert winding_faults(soup) == (0, 0)
    beside = block((1, 1, 1), (1, 1, 0))  # touches along an edge
    assert winding_faults(merged(one, beside)) == (0, 0)


def test_faults_are_counted():
    one = block((1, 1, 1), (0, 0, 0))
    flipped = one.triangles.copy()
    flipped[0] = flipped[0, ::-1]
    assert winding_faults(Geometry(one.positions, flipped)) == (0, 3)
    corner = np.array([[0, 0, 0], [0, 1, 0], [1, 0, 0], [-1, 0, 0], [0, 0, 1]], float)
    fan = np.array([[0, 1, 2], [1, 0, 3], [0, 1, 4]], np.int32)
    assert winding_faults(Geometry(corner, fan)) == (1, 0)


def test_hostile_surfaces_do_not_crash():
    """Triangles of one point, of one line, doubled, and crossing each other."""
    points = np.random.default_rng(2).uniform(-1, 1, (30, 3))
    faces = np.random.default_rng(3).integers(0, 30, (200, 3)).astype(np.int32)
    soup = Geometry(points, np.concatenate([faces, faces[:20], [[0, 0, 0]]]).astype(np.int32))
    sight = Walls(soup).sight(points + 1e-3)
    assert np.isfinite(sight.backs).all()
    assert min(winding_faults(soup)) >= 0
