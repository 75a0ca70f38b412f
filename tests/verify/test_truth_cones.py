"""The quadrature over cones of directions, against what is known without any."""

import numpy as np
import pytest

from andon.lamps import DiskLamp, MeshLamp, PolygonLamp, SphereLamp, TubeLamp
from andon.verify.truths import cones

ONE = np.ones(3)
UP = np.array([[0.0, 1.0, 0.0]])
ORIGIN = np.zeros((1, 3))


def lux(lamp, position=ORIGIN, normal=UP, **settings):
    return cones.illuminance(lamp, np.asarray(position), np.asarray(normal), **settings)[:, 0]


def test_a_facing_sphere_and_disk_are_pi_sine_squared():
    sphere = SphereLamp("s", ONE, np.array([0.0, 0.5, 0]), 0.2)
    assert lux(sphere)[0] == pytest.approx(np.pi * 0.2**2 / 0.5**2, rel=1e-9)
    disk = DiskLamp("d", ONE, np.array([0.0, 0.5, 0]), np.array([0.0, -1, 0]), 0.2)
    assert lux(disk)[0] == pytest.approx(np.pi * 0.2**2 / (0.2**2 + 0.5**2), rel=1e-9)


def test_half_of_a_lamp_on_the_horizon():
    ball = SphereLamp("s", ONE, np.array([1e3, 0.0, 0]), 1.0)
    # A small disk of radius σ whose middle is on the horizon: ∫ sin over its upper half, 2/3·σ³.
    assert lux(ball)[0] == pytest.approx(2 / 3 * 1e-9, rel=1e-4)


def test_a_corner_of_the_sky_and_a_short_tube():
    # Four arcs of arccos ⅓, each in a plane 45° off the zenith: ½·4·arccos ⅓·√½.
    square = PolygonLamp("p", ONE, np.array([[-1.0, 1, -1], [1, 1, -1], [1, 1, 1], [-1, 1, 1]]))
    assert lux(square)[0] == pytest.approx(np.sqrt(2) * np.arccos(1 / 3), rel=1e-9)
    ends = np.array([[0.0, 0.5, 0], [1e-7, 0.5, 0]])
    assert lux(TubeLamp("t", ONE, ends, 0.2))[0] == pytest.approx(np.pi * 0.16, rel=1e-6)


def test_an_edge_through_the_middle_leaves_half_and_two_halves_are_the_whole():
    lamp = DiskLamp("d", ONE, np.array([0.0, 1, 0]), np.array([0.0, -1, 0]), 0.3)
    whole = lux(lamp)[0]
    assert lux(lamp, edge=np.array([[1.0, 0, 0]]))[0] == pytest.approx(whole / 2, rel=1e-8)
    slanted = np.array([[1.0, 0.1, 0]])
    both = lux(lamp, edge=slanted)[0] + lux(lamp, edge=-slanted)[0]
    assert both == pytest.approx(whole, rel=1e-7)


def test_a_mesh_is_its_front_facets_and_behind_is_dark():
    corners = np.array([[-1.0, 1, -1], [1, 1, -1], [1, 1, 1], [-1, 1, 1]])
    triangles = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
    mesh = MeshLamp("m", ONE, corners, triangles)
    assert lux(mesh)[0] == pytest.approx(lux(PolygonLamp("p", ONE, corners))[0], rel=1e-8)
    assert lux(mesh, [[0.0, 2, 0]], -UP)[0] == 0


def test_a_lamp_below_the_horizon_gives_nothing_and_none_is_refused():
    assert lux(SphereLamp("s", ONE, np.array([0.0, -0.5, 0]), 0.2))[0] == 0
    assert lux(SphereLamp("s", ONE, ONE, 0.2), np.empty((0, 3)), np.empty((0, 3))).shape == (0,)
