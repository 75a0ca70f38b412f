"""A depth image as triangles, and fewer of them."""

from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from andon.quantities import Geometry, merged
from andon.rays import face_normals
from andon.spaces import View, look_at
from andon.surface.occluder import decimated
from andon.surface.triangulate import thickened, triangulate_depth
from andon.verify.rooms import camera_in, furnished_room
from comparison import assert_agree
from worlds import sphere_depth, unit

POSE = look_at(np.array([1.0, 2, 3]), np.array([0.5, 0, 0]))
PINHOLE = View("pinhole", 40, 30, 35.0, 36.0, 19.0, 15.0, world_from_camera=POSE)
FISHEYE = View("fisheye", 40, 30, 20.0, 20.0, 19.0, 15.0, world_from_camera=POSE)


def areas(geometry):
    a, b, c = np.moveaxis(geometry.positions[geometry.triangles], 1, 0)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


def test_area_of_a_plane():
    """A tilted plane: the quadrilateral between its four corners, exactly."""
    normal = unit([0.3, -0.2, -1])
    depth = -2 / (PINHOLE.rays_planar() @ normal)
    geometry = triangulate_depth(depth, PINHOLE)
    assert len(geometry.triangles) == 2 * 39 * 29
    a, b, c, d = (PINHOLE.rays_planar() * depth[..., None])[[0, 0, -1, -1], [0, -1, -1, 0]]
    expected = (
        np.linalg.norm(np.cross(b - a, c - a)) / 2 + np.linalg.norm(np.cross(c - a, d - a)) / 2
    )
    assert areas(geometry).sum() == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("view", [PINHOLE, FISHEYE], ids=["pinhole", "fisheye"])
def test_triangles_face_the_camera(view):
    depth = sphere_depth(view, (0, 0, 2.0), 0.9)[0]
    geometry = triangulate_depth(depth, view, max_jump=0.3)
    middle = geometry.positions[geometry.triangles].mean(axis=1)
    facing = np.einsum("ij,ij->i", face_normals(geometry), view.position - middle)
    assert (facing > 0).all()
    assert_agree(
        np.linalg.norm(geometry.positions - view.world_from_camera[:3] @ (0, 0, 2.0, 1), axis=1),
        np.full(len(geometry.positions), 0.9),
        rtol=1e-9,
    )


def test_no_triangle_crosses_a_jump_or_touches_a_hole():
    depth = np.full(PINHOLE.shape, 2.0)
    depth[:, 20:] = 2.0 * 1.06
    depth[5, 7] = np.nan
    geometry = triangulate_depth(depth, PINHOLE)
    camera = geometry.positions @ np.linalg.inv(POSE)[:3, :3].T + np.linalg.inv(POSE)[:3, 3]
    z = camera[geometry.triangles][..., 2]
    assert np.ptp(z, axis=1).max() < 1e-9
    # One column of cells fell to the jump. A hole is the corner of 4 cells: 6 of the 8 triangles.
    assert len(geometry.triangles) == 2 * 38 * 29 - 6
    assert len(triangulate_depth(depth, PINHOLE, max_jump=0.07).triangles) == 2 * 39 * 29 - 6


def test_latlong_is_closed_all_around():
    """A ball seen from inside: rims are left at the poles only, no ray slips out between."""
    view = View("latlong", 24, 12, world_from_camera=POSE)
    geometry = triangulate_depth(np.full(view.shape, 2.0), view)
    assert len(geometry.triangles) == 2 * 24 * 11
    assert len(geometry.positions) == 24 * 12
    edges = directed_edges(geometry)
    rim = [edge for edge in edges if (edge[1], edge[0]) not in edges]
    assert len(rim) == 2 * 24
    assert {a // 24 for edge in rim for a in edge} == {0, 11}
    middle = geometry.positions[geometry.triangles].mean(axis=1)
    facing = np.einsum("ij,ij->i", face_normals(geometry), view.position - middle)
    assert (facing > 0).all()
    backwards = POSE[:3, :3] @ (0, 0, -1.0)
    assert plain_distance(geometry, view.position, backwards) == pytest.approx(2, rel=0.05)
    jump = np.full(view.shape, 2.0)
    jump[:, 12:] = 3.0
    # Two jumps now: in the middle of the picture, and at its seam.
    assert len(triangulate_depth(jump, view).triangles) == 2 * 22 * 11


def directed_edges(geometry):
    t = geometry.triangles
    return Counter(map(tuple, np.concatenate([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]]).tolist()))


def volume(geometry):
    a, b, c = np.moveaxis(geometry.positions[geometry.triangles], 1, 0)
    return np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6


def test_thickness_closes_the_sheet():
    depth = np.full(PINHOLE.shape, 2.0)
    geometry = thickened(triangulate_depth(depth, PINHOLE), PINHOLE.position, 0.1)
    edges = directed_edges(geometry)
    assert set(edges.values()) == {1}
    assert all(edges[b, a] == 1 for a, b in edges)
    flat = areas(triangulate_depth(depth, PINHOLE)).sum()
    # Along the rays the sheet grows: between 0.1·cos(35°) and 0.1 thick, and wider behind.
    assert 0.085 * flat < volume(geometry) < 0.11 * flat


@given(st.integers(0, 2**32 - 1), st.floats(0.05, 0.6))
@settings(max_examples=40, deadline=None)
def test_thickness_closes_whatever_holes_left(seed, share):
    """Every edge is walked as often one way as the other, also where pieces touch in a point."""
    view = PINHOLE.resized(9, 7)
    generator = np.random.default_rng(seed)
    depth = np.where(generator.random(view.shape) < share, np.nan, 2.0)
    depth = depth * (1 + 0.1 * (generator.random(view.shape) < 0.3))
    geometry = thickened(triangulate_depth(depth, view), view.position, 0.2)
    edges = directed_edges(geometry)
    assert all(edges[b, a] == count for (a, b), count in edges.items())
    if len(geometry.triangles):
        assert volume(geometry) > 0


@pytest.mark.parametrize("depth", [np.nan, 2.0])
def test_pictures_too_small_for_a_triangle(depth):
    for shape in ((1, 1), (1, 5), (5, 1)):
        view = View("pinhole", shape[1], shape[0], 3.0, 3.0)
        sheet = triangulate_depth(np.full(shape, depth), view)
        geometry = thickened(sheet, view.position, 0.1)
        assert geometry.triangles.shape == (0, 3)


# ── decimation ────────────────────────────────────────────────────────────────────────────────


def bumpy():
    view = PINHOLE.resized(120, 90)
    x, y = np.moveaxis(view.rays_planar()[..., :2], -1, 0)
    depth = 2 + 0.15 * np.sin(7 * x) * np.cos(6 * y)
    return triangulate_depth(depth, view), view


def plain_distance(geometry, origin, direction):
    """Nearest hit of one ray, by Cramer's rule on all triangles in float64."""
    a, b, c = np.moveaxis(geometry.positions[geometry.triangles], 1, 0)
    p = np.cross(direction, c - a)
    determinant = np.einsum("ij,ij->i", b - a, p)
    with np.errstate(divide="ignore", invalid="ignore"):
        u = np.einsum("ij,ij->i", origin - a, p) / determinant
        q = np.cross(origin - a, b - a)
        v = q @ direction / determinant
        t = np.einsum("ij,ij->i", c - a, q) / determinant
        hit = (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0)
    return t[hit].min(initial=np.inf)


def plain_nearest(geometry, point):
    """Distance to the nearest triangle, by the barycentric foot of the plane or of an edge."""
    a, b, c = np.moveaxis(geometry.positions[geometry.triangles], 1, 0)
    u, v, w = b - a, c - a, point - a
    uu, uv, vv = (np.einsum("ij,ij->i", p, q) for p, q in ((u, u), (u, v), (v, v)))
    wu, wv = (np.einsum("ij,ij->i", w, q) for q in (u, v))
    with np.errstate(divide="ignore", invalid="ignore"):
        s, t = (vv * wu - uv * wv) / (uu * vv - uv**2), (uu * wv - uv * wu) / (uu * vv - uv**2)
    feet = [(a + s[:, None] * u + t[:, None] * v)[(s >= 0) & (t >= 0) & (s + t <= 1)]]
    for start, end in ((a, b), (b, c), (c, a)):
        edge = end - start
        with np.errstate(invalid="ignore"):
            along = np.einsum("ij,ij->i", point - start, edge) / np.einsum("ij,ij->i", edge, edge)
        feet.append(start + np.clip(np.nan_to_num(along), 0, 1)[:, None] * edge)
    return np.linalg.norm(np.concatenate(feet) - point, axis=1).min()


@pytest.mark.parametrize("budget", [200, 1000, 5000])
def test_decimation_keeps_its_budget_and_says_what_it_cost(budget):
    geometry, view = bumpy()
    occluder = decimated(geometry, budget, view.position)
    assert budget / 2 < len(occluder.geometry.triangles) <= budget
    assert occluder.triangles_before == len(geometry.triangles) == 2 * 119 * 89
    # Measured again, at other points than it measures itself: the middles of triangles.
    chosen = np.random.default_rng(0).choice(len(geometry.triangles), 400, replace=False)
    points = geometry.positions[geometry.triangles[chosen]].mean(axis=1)
    error = [plain_nearest(occluder.geometry, point) for point in points]
    assert np.percentile(error, 95) == pytest.approx(occluder.error_m, rel=0.25, abs=2e-6)


def test_more_triangles_err_less():
    geometry, view = bumpy()
    errors = [decimated(geometry, budget, view.position).error_m for budget in (200, 1000, 5000)]
    assert errors[0] > 2 * errors[1] > 4 * errors[2] > 0


def test_what_decimation_lost_is_counted():
    """Thousands of specks: most vanish, and no error in metres can say so."""
    generator = np.random.default_rng(0)
    specks = [
        Geometry(
            generator.uniform(-0.5, 0.5, 3) * (1, 1, 0) + generator.normal(size=(3, 3)) * 0.004,
            np.array([[0, 1, 2]], np.int32),
        )
        for _ in range(3000)
    ]
    geometry = merged(*specks)
    occluder = decimated(geometry, 300, PINHOLE.position)
    middles = geometry.positions[geometry.triangles].mean(axis=1)[::10]
    hits = [
        plain_distance(occluder.geometry, PINHOLE.position, unit(p - PINHOLE.position))
        for p in middles
    ]
    lost = float(np.mean(~np.isfinite(hits)))
    assert lost > 0.5
    assert occluder.lost_share == pytest.approx(lost, abs=0.05)


def test_a_speck_before_a_wall_is_lost_and_no_error():
    """What vanished a metre before a wall was not moved by a metre."""
    wall, view = bumpy()
    rays = view.rays_planar()[2::5, 2::5].reshape(-1, 1, 3)
    small = rays + np.random.default_rng(0).normal(size=(len(rays), 3, 3)) * 0.002
    places = (small @ POSE[:3, :3].T + POSE[:3, 3]).reshape(-1, 3)
    specks = Geometry(places, np.arange(len(places), dtype=np.int32).reshape(-1, 3))
    kept = decimated(wall, 500, view.position)
    both = decimated(merged(wall, specks), 500, view.position)
    assert both.error_m < 2 * kept.error_m
    # Specks are 2 % of the triangles; half of them vanish, and the eye sees the wall instead.
    assert both.lost_share > kept.lost_share + 0.007


def test_a_silhouette_that_draws_back_is_no_error_of_its_distance_to_the_wall():
    """Furniture before walls: rims move by millimetres, what the eye's rays meet by decimetres."""
    room = merged(furnished_room(12_000))
    occluder = decimated(room, 6000, camera_in(room).position)
    assert 0.0005 < occluder.error_m < 0.003  # 0.125 m along the line of sight


def test_a_sheet_loses_nothing():
    geometry, view = bumpy()
    assert decimated(geometry, 5000, view.position).lost_share < 0.002
    assert decimated(geometry, 0, view.position).lost_share == 0


def test_few_triangles_or_no_budget_are_left_as_they_are():
    geometry, view = bumpy()
    for budget in (0, 10**6):
        occluder = decimated(geometry, budget, view.position)
        assert occluder.geometry is geometry
        assert occluder.error_m == 0


def test_merging_moves_indices():
    a, _ = bumpy()
    both = merged(a, a)
    assert len(both.triangles) == 2 * len(a.triangles)
    assert both.triangles.max() == 2 * len(a.positions) - 1
    assert_agree(both.positions[both.triangles[-1]], a.positions[a.triangles[-1]])


def test_another_eye_is_given_the_fitted_normals():
    """Flat triangles of a noisy depth would light the same point differently in the other eye."""
    from andon.surface.load import surface_of_depth
    from andon.surface.reference import see

    depth, expected = sphere_depth(PINHOLE, (0.1, 0, 2.0), 0.8)
    expected = expected @ POSE[:3, :3].T
    noisy = depth * (1 + 0.001 * np.random.default_rng(2).normal(size=depth.shape))
    model = surface_of_depth(noisy, PINHOLE)
    pose = POSE.copy()
    pose[:3, 3] += POSE[:3, 0] * 0.05
    other = View(**{**vars(PINHOLE), "world_from_camera": pose, "name": "right"})
    seen = see(model, other)
    centre = PINHOLE.world_from_camera[:3] @ (0.1, 0, 2.0, 1)
    errors = {}
    for name, normal, mask in (
        ("fitted", model.normals["mono"], np.isfinite(depth)),
        ("other", seen.normal, seen.valid),
    ):
        position = seen.position if name == "other" else see(model, PINHOLE).position
        truth = unit(position[mask] - centre)
        errors[name] = np.median(np.linalg.norm(np.cross(normal[mask], truth), axis=-1))
    assert errors["other"] < 1.2 * errors["fitted"]


def test_pixels_without_a_normal_are_holes_for_every_eye():
    from andon.surface.load import surface_of_depth

    depth = np.full(PINHOLE.shape, 2.0)
    normals = np.broadcast_to(-POSE[:3, 2], (*PINHOLE.shape, 3)).copy()
    normals[10:14, 10:14] = np.nan
    model = surface_of_depth(depth, PINHOLE, normals=normals)
    assert np.isfinite(model.real.normals).all()
    assert len(model.real.triangles) < 2 * 39 * 29
    # They still stand in the light.
    assert len(model.occluder.geometry.triangles) == 2 * 39 * 29
