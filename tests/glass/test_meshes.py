"""Meshes as glass: a fine ball of triangles is a ball, normals and facets agree about sides."""

from dataclasses import replace

import numpy as np
import pytest

from andon.glass.model import Ball, Closed, Slab, Solid
from andon.glass.paths import THROUGH, insides, trace
from andon.quantities import Geometry
from comparison import assert_agree
from worlds import block

from .rays import BALL, EYE, angles_between, icosphere, rays_from, smooth_ball, unit


def compared(levels):
    """Angles between the last directions behind a ball and behind its mesh; shares that miss."""
    directions = rays_from(EYE, 0.045, 4000)
    ball = trace([BALL], EYE, directions)
    mesh = trace([Solid("mesh", smooth_ball(0.075, levels))], EYE, directions)
    both = (ball.events == 2) & (mesh.events == 2) & (mesh.status == THROUGH)
    angles = angles_between(ball.exit_direction, mesh.exit_direction)[both]
    return np.median(angles), 1 - both.mean(), mesh


def test_a_fine_mesh_becomes_the_ball():
    """The error falls with the square of the triangles' size: 4 times for each level."""
    coarse, fine, finest = (compared(levels) for levels in (3, 4, 5))
    assert finest[0] < 2e-4
    assert coarse[0] / fine[0] == pytest.approx(4, rel=0.2)
    assert fine[0] / finest[0] == pytest.approx(4, rel=0.2)
    assert finest[1] == 0


def test_a_box_of_triangles_is_the_slab():
    half = np.array([0.1, 0.08, 0.03])
    box = block(2 * half, (0, 0, 0))
    directions = rays_from(np.array([0.2, 0.1, 0.4]), 0.1, 1000)
    slab = trace([Solid("slab", Slab(half))], np.array([0.2, 0.1, 0.4]), directions)
    mesh = trace([Solid("mesh", Closed(box))], np.array([0.2, 0.1, 0.4]), directions)
    assert (mesh.events == slab.events).mean() > 0.999
    same = (mesh.events == slab.events) & (slab.status == THROUGH)
    assert same.mean() > 0.95
    assert_agree(mesh.exit_direction[same], slab.exit_direction[same], atol=1e-9)
    assert_agree(mesh.exit_point[same], slab.exit_point[same], atol=1e-7)
    assert_agree(mesh.pencil[same], slab.pencil[same], atol=1e-6)
    assert_agree(mesh.transmitted[same], slab.transmitted[same], atol=1e-9)


def test_a_mesh_far_from_its_origin_loses_nothing():
    positions, triangles = icosphere(0.075, 4)
    far = np.array([300.0, -200.0, 50.0])
    place = np.eye(4)
    place[:3, 3] = -far
    moved = Closed(Geometry(positions + far, triangles, normals=positions / 0.075))
    directions = rays_from(EYE, 0.04, 500)
    here = trace([Solid("mesh", smooth_ball(0.075, 4))], EYE, directions)
    there = trace([Solid("mesh", moved, place)], EYE, directions)
    assert_agree(there.exit_direction, here.exit_direction, atol=1e-8)


def test_normals_that_point_inwards_are_turned():
    positions, triangles = icosphere(0.075, 3)
    wrong = Closed(Geometry(positions, triangles, normals=-positions / 0.075))
    directions = rays_from(EYE, 0.04, 300)
    right = trace([Solid("mesh", smooth_ball(0.075, 3))], EYE, directions)
    turned = trace([Solid("mesh", wrong)], EYE, directions)
    assert_agree(turned.exit_direction, right.exit_direction, atol=1e-14)
    assert_agree(turned.pencil, right.pencil, atol=1e-9, rtol=1e-9)
    assert ((turned.normal * turned.point).sum(-1)[turned.solid == 0] > 0).all()


@pytest.mark.parametrize("shape", [Ball(0.02), smooth_ball(0.02, 5)])
def test_a_bubble_in_a_mesh(shape):
    outer, bubble = Solid("outer", smooth_ball(0.075, 5)), Solid("bubble", shape, index=(1.0,) * 3)
    directions = rays_from(EYE, 0.04, 1000)
    exact = trace([BALL, replace(bubble, shape=Ball(0.02))], EYE, directions)
    found = trace([outer, bubble], EYE, directions)
    same = found.events == exact.events
    assert same.mean() > 0.98
    assert set(np.unique(exact.events)) == {2, 3, 4}
    angles = angles_between(found.exit_direction, exact.exit_direction)[same]
    assert np.median(angles) < 5e-4


def test_a_hollow_mesh_is_hollow():
    """Two shells in one mesh, the inner one inside out."""
    positions, triangles = icosphere(1.0, 4)
    count = len(positions)
    hollow = Geometry(
        np.concatenate([0.075 * positions, 0.03 * positions]),
        np.concatenate([triangles, count + triangles[:, ::-1]]),
        normals=np.concatenate([positions, -positions]),
    )
    found = trace([Solid("hollow", Closed(hollow))], EYE, unit([[0.0, 0.001, -1.0]]))
    assert found.events == 4
    assert found.path_m[0, 0] == pytest.approx(0.15 - 0.06, abs=1e-3)
    points = np.array([[0.0, 0.0, 0.05], [0, 0, 0], [0, 0.08, 0], [0.06, 0.0, 0.0]])
    inside = insides([Solid("hollow", Closed(hollow))], points)[:, 0]
    assert inside.tolist() == [True, False, False, True]


def test_coordinates_of_a_mesh_are_its_own():
    positions, triangles = icosphere(0.075, 3)
    uvs = np.stack([0.5 + positions[:, 0], 0.5 - positions[:, 1]], axis=-1)
    mesh = Solid("mesh", Closed(Geometry(positions, triangles, uvs=uvs)))
    found = trace([mesh], EYE, rays_from(EYE, 0.03, 100))
    expected = np.stack([0.5 + found.local_point[:, 0], 0.5 - found.local_point[:, 1]], axis=-1)
    assert_agree(found.uv, expected, atol=1e-9)
    bare = Solid("bare", Closed(Geometry(positions, triangles)))
    assert np.isnan(trace([bare], EYE, rays_from(EYE, 0.03, 100)).uv).all()
