"""Pencils: against neighbouring rays, Coddington's equations and thin lenses."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from andon.glass.model import Ball, LensShape, Slab, Solid
from andon.glass.paths import THROUGH, trace
from andon.glass.pencils import (
    blur_radians,
    frames_of,
    mirrored_pencil,
    start_pencil,
    transferred,
    vergence,
)
from comparison import assert_agree

from .rays import BALL, EYE, SHAPES, neighbours, rays_from, slant, smooth_ball, unit

INDEX = 1.51
BACKDROP_Z = -0.2
# Shapes with edges, on which a few of 600 rays come to lie.
EDGES = {"biconcave": 0.005}


def vergences(solids, directions, eye=EYE):
    """(n, 2, 2) of the paper's plane, as the eye sees it through `solids`."""
    found = trace(solids, eye, directions)
    assert (found.status == THROUGH).all()
    ahead = (BACKDROP_Z - found.exit_point[:, 2]) / found.exit_direction[:, 2]
    return vergence(found.pencil, ahead, found.exit_direction), found, ahead


# ── derivatives ─────────────────────────────────────────────────────────────────────────────────


def assert_pencils(solids, directions, share, edges=0.0):
    """The pencils of at least `share` of the rays are what neighbouring rays do.

    `edges` is the share whose neighbours may meet another boundary beyond an edge.
    """
    found = trace(solids, EYE, directions)
    moves, turns, good = neighbours(solids, EYE, directions, 0.3)
    met = found.solid >= 0
    assert (good & met).sum() >= share * met.sum() > 100 * share
    there = found.pencil[:, :, 0] + 0.3 * found.pencil[:, :, 1]
    along = (there * found.exit_direction[:, None]).sum(-1)
    there = there - along[..., None] * found.exit_direction[:, None]
    keep = good & met
    # Grazing rays fan out so much that a finite step is none.
    keep &= np.abs(found.pencil[:, :, 1]).max(axis=(1, 2)) < 100
    assert_agree(there[keep], moves[keep], atol=1e-6, rtol=1e-6, share=edges)
    assert_agree(found.pencil[keep, :, 1], turns[keep], atol=1e-6, rtol=1e-6, share=edges)


@pytest.mark.parametrize("name", list(SHAPES))
def test_pencils_are_what_neighbouring_rays_do(name):
    assert_pencils([Solid(name, SHAPES[name])], rays_from(EYE, 0.06, 600), 0.9, EDGES.get(name, 0))


def test_pencils_through_bodies_in_bodies():
    place = np.eye(4)
    place[:3, 3] = [0.01, 0.005, -0.01]
    bubble = Solid("bubble", Ball(0.03), place, index=(1.0,) * 3)
    assert_pencils([BALL, bubble], rays_from(EYE, 0.05, 600), 0.9)


def test_pencils_of_a_mesh_follow_its_normals():
    mesh = Solid("mesh", smooth_ball(0.075, 2))
    directions = rays_from(EYE, 0.03, 600)
    found = trace([mesh], EYE, directions)
    _, turns, good = neighbours([mesh], EYE, directions, 0.3, step=1e-6)
    error = np.abs(turns - found.pencil[:, :, 1]).max(axis=(1, 2))
    # Neighbours that cross an edge of a triangle are the few exceptions.
    assert np.mean(error[good] < 1e-3) > 0.99


def test_a_mirrored_pencil_is_what_neighbouring_rays_do():
    directions = rays_from(EYE, 0.04, 200)
    frame, step = frames_of(directions), 1e-5
    found = trace([BALL], EYE, directions)
    for place in range(4):
        ways, points = [], []
        for sign in (step, -step):
            axis = sign * frame[place % 2]
            moved = trace(
                [BALL],
                EYE + (axis if place < 2 else 0 * axis),
                unit(directions + (0 * axis if place < 2 else axis)),
            )
            ways.append(moved.mirrored)
            points.append(moved.point)
        assert_agree(
            found.mirrored_pencil[:, place, 1], (ways[0] - ways[1]) / (2 * step), atol=1e-3
        )
        assert_agree(
            found.mirrored_pencil[:, place, 0], (points[0] - points[1]) / (2 * step), atol=1e-5
        )


def test_a_flat_mirror_keeps_the_vergence():
    directions = slant([0.0, 30.0, 60.0])
    pencil = start_pencil(*frames_of(directions))
    normals = np.broadcast_to([0.0, 0.0, 1.0], (3, 3))
    there = transferred(pencil, np.array([0.5, 0.6, 0.7]), directions, normals)
    back = mirrored_pencil(there, directions, normals, np.zeros((3, 3, 3)))
    away = directions * [1, 1, -1]
    seen = vergence(back, np.array([0.5, 0.4, 0.3]), away)
    assert_agree(seen, np.broadcast_to(np.eye(2), (3, 2, 2)), atol=1e-12)


# ── vergence ────────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("metres", [0.1, 1.0, 40.0])
def test_what_nothing_is_before_is_as_far_as_it_is(metres):
    directions = rays_from(EYE, 0.3, 20)
    seen = vergence(start_pencil(*frames_of(directions)), np.full(20, metres), directions)
    assert_agree(seen, np.broadcast_to(np.eye(2) / metres, (20, 2, 2)), rtol=1e-12, atol=1e-12)


def paraxial(interfaces):
    """The vergence in dioptres of the paper's plane on the axis, by n′/l′ = n/l + (n′ − n)/R."""
    entry, leaving = 0.4 - 0.075, -0.075 - BACKDROP_Z
    if interfaces == 2:
        # From the plane into the ball, R > 0 towards the light.
        inside = INDEX / (1 / -leaving + (INDEX - 1) / 0.075)
        last = INDEX / (inside - 0.15)
    else:
        last = INDEX / -(leaving + 0.15)
    image = 1 / (last + (1 - INDEX) / -0.075)
    return 1 / (entry - image)


@pytest.mark.parametrize(("interfaces", "dioptres"), [(1, -2.28), (2, 6.65)])
def test_the_papers_background_on_the_axis(interfaces, dioptres):
    seen, _, _ = vergences([replace(BALL, interfaces=interfaces)], slant(0))
    assert seen[0, 0, 0] == pytest.approx(dioptres, abs=0.005)
    assert_agree(seen[0], paraxial(interfaces) * np.eye(2), atol=1e-9)


def coddington(degrees, interfaces):
    """Tangential and sagittal vergence of the paper's plane, by the generalised equations.

    Light runs from the plane to the eye. At each boundary, with the image distances t and s along
    the ray: n′·cos²i′/t′ − n·cos²i/t = (n′·cos i′ − n·cos i)/R, sagittal without the squares.
    """
    eye, radius = 0.4, 0.075
    path = np.radians(degrees)
    i = np.arcsin(eye * np.sin(path) / radius)
    t = np.arcsin(np.sin(i) / INDEX)
    chord = 2 * radius * np.cos(t)
    to_ball = eye * np.cos(path) - radius * np.cos(i)
    entry = np.array([np.sin(path), -np.cos(path)]) * to_ball + [0, eye]
    inner, outer = path - (i - t), path - 2 * (i - t)
    point = entry + chord * np.array([np.sin(inner), -np.cos(inner)])
    if interfaces == 2:
        ahead = (point[1] - BACKDROP_Z) / np.cos(outer)
    else:
        ahead = (entry[1] - BACKDROP_Z) / np.cos(inner)
    found = []
    for power in (2, 0):
        distance = -ahead
        if interfaces == 2:
            step = (INDEX * np.cos(t) - np.cos(i)) / radius
            distance = INDEX * np.cos(t) ** power / (np.cos(i) ** power / distance + step)
            distance -= chord
        step = (np.cos(i) - INDEX * np.cos(t)) / -radius
        distance = np.cos(i) ** power / (INDEX * np.cos(t) ** power / distance + step)
        found.append(1 / (to_ball - distance))
    return found


@pytest.mark.parametrize("interfaces", [1, 2])
@pytest.mark.parametrize("degrees", [0.5, 3.0, 6.0, 9.0, 10.5])
def test_off_the_axis_it_is_astigmatic_as_coddington_says(degrees, interfaces):
    solid = replace(BALL, interfaces=interfaces)
    seen, _, _ = vergences([solid], slant(degrees))
    expected = coddington(degrees, interfaces)
    assert_agree(np.sort(np.linalg.eigvals(seen[0])), np.sort(expected), rtol=1e-9)


def test_vergence_is_symmetric():
    """Rays from an eye to a plane and back are one and the same path."""
    seen, _, _ = vergences([BALL], rays_from(EYE, 0.03, 300))
    assert_agree(seen[:, 0, 1], seen[:, 1, 0], atol=1e-9, rtol=1e-9)
    assert np.abs(seen[:, 0, 1]).max() > 1e-3


def test_vergence_is_what_a_moved_pupil_sees():
    """From p the same point of the background is seen turned by −V·p."""
    directions = rays_from(EYE, 0.03, 50)
    seen, middle, ahead = vergences([BALL], directions)
    points = middle.exit_point + ahead[:, None] * middle.exit_direction
    e1, e2 = frames_of(directions)
    pupil = np.array([1e-5, -2e-5])
    turn = -np.einsum("nij,j->ni", seen, pupil)
    moved = trace(
        [BALL],
        EYE + pupil[0] * e1 + pupil[1] * e2,
        unit(directions + turn[:, :1] * e1 + turn[:, 1:] * e2),
    )
    gap = points - moved.exit_point
    gap -= (gap * moved.exit_direction).sum(-1)[:, None] * moved.exit_direction
    assert np.linalg.norm(gap, axis=-1).max() < 1e-3 * np.linalg.norm(pupil)


@pytest.mark.parametrize("power", [-4.0, 2.0, 5.0])
def test_a_thin_lens_adds_its_power(power):
    """A lens of F dioptres, 0.1 mm before the eye: V = 1/d less F, from there."""
    radius = 2 * (INDEX - 1) / power
    lens = Solid("lens", LensShape(0.001, (radius, radius), 1e-5))
    seen, _, _ = vergences([lens], slant(0), np.array([0.0, 0.0, 1e-4]))
    at_lens = 1 / 0.2 - power
    assert seen[0, 0, 0] == pytest.approx(at_lens / (1 + 1e-4 * at_lens), abs=1e-3)


def test_a_slab_brings_what_is_behind_nearer():
    slab = Solid("slab", Slab(np.array([1.0, 1.0, 0.05])))
    seen, _, _ = vergences([slab], slant(0))
    assert seen[0, 0, 0] == pytest.approx(1 / (0.6 - 0.1 * (1 - 1 / INDEX)), rel=1e-12)


def test_an_image_at_the_eye_is_huge_not_nan():
    pencil = start_pencil(*frames_of(slant(0)))
    seen = vergence(pencil, np.zeros(1), slant(0))
    assert np.isfinite(seen).all()
    assert seen[0, 0, 0] > 1e12


def test_blur_is_that_of_a_defocused_eye():
    """1 mm of pupil times 1 D is 3.438′; of the paper's geometry 17.19′."""
    minute = np.radians(1 / 60)
    seen = np.eye(2)[None] / 0.6
    assert blur_radians(np.eye(2)[None], 0.0, 1e-3) / minute == pytest.approx(3.438, abs=1e-3)
    assert blur_radians(seen, 1 / 0.4, 6e-3) / minute == pytest.approx(17.19, abs=5e-3)
    assert blur_radians(seen, 1 / 0.6, 6e-3) == pytest.approx(0, abs=1e-12)


def test_blur_of_an_astigmatic_image_has_the_second_moment_of_its_ellipse():
    random = np.random.default_rng(0)
    half = random.normal(size=(2, 2))
    seen = half + half.T
    focus, pupil = 0.7, 5e-3
    inside = random.uniform(-1, 1, (400_000, 2)) * pupil / 2
    inside = inside[np.hypot(*inside.T) < pupil / 2]
    spread = inside @ (seen - focus * np.eye(2)).T
    moment = (spread**2).sum(-1).mean()
    diameter = blur_radians(seen[None], focus, pupil)[0]
    assert moment == pytest.approx(diameter**2 / 8, rel=0.01)  # of a uniform disc


# ── identities ──────────────────────────────────────────────────────────────────────────────────


@settings(deadline=None, max_examples=60)
@given(
    st.sampled_from(sorted(SHAPES)),
    st.floats(1.0, 2.5),
    st.tuples(*[st.floats(-0.05, 0.05)] * 3),
    st.tuples(*[st.floats(-1.0, 1.0)] * 3),
)
def test_light_runs_the_same_way_back(name, index, target, around):
    solid = Solid(name, SHAPES[name], index=(index,) * 3)
    eye = 0.5 * unit(np.add(around, [0, 0, 2.0]))
    direction = unit(np.array(target) - eye)[None]
    there = trace([solid], eye, direction)
    if there.status[0] != THROUGH or there.transmitted[0] < 1e-3:
        return  # caught, or all but grazing: the way back is the way of the rounding
    start = there.exit_point + 0.4 * there.exit_direction
    back = trace([solid], start, -there.exit_direction)
    assert_agree(back.exit_direction, -direction, atol=1e-8)
    gap = eye - back.exit_point[0]
    assert np.linalg.norm(np.cross(gap, direction[0])) < 1e-8
    assert back.transmitted[0] == pytest.approx(there.transmitted[0], abs=1e-8)
    assert_agree(back.path_m, there.path_m, atol=1e-8)


@settings(deadline=None, max_examples=40)
@given(st.sampled_from(sorted(SHAPES)), st.integers(0, 2**31))
def test_no_ray_makes_anything_that_is_not_a_number(name, seed):
    random = np.random.default_rng(seed)
    solids = [Solid(name, SHAPES[name]), Solid("core", Ball(0.01), index=(1.0, 1.2, 2.0))]
    origins = random.uniform(-0.3, 0.3, (40, 3)).round(2)
    directions = unit(np.add(random.integers(-2, 3, (40, 3)), [0, 0, 1e-9]))
    found = trace(solids, origins, directions)
    for field in ("point", "exit_point", "exit_direction", "pencil", "mirrored_pencil", "normal"):
        assert np.isfinite(getattr(found, field)).all(), field
    assert_agree(np.linalg.norm(found.exit_direction, axis=-1), np.ones(40), atol=1e-12)
    assert ((found.transmitted >= 0) & (found.transmitted <= 1)).all()
    assert (found.path_m >= 0).all()
