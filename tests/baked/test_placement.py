"""Cameras that together see the surface of rooms."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from andon.errors import InputError
from andon.quantities import Geometry, merged
from andon.rays import RayScene
from andon.spaces import look_at, pinhole_view
from andon.transport.baked.placement import suggested_views
from worlds import block

from .rooms import L_SHAPE, TWO_ROOMS, finer_coverage, plan_area, plan_room

SIZE_PX = 384
ASKED = {"coverage": 0.99, "most_cameras": 12, "map_size_px": SIZE_PX}
TATAMI = Path(__file__).parents[2] / "examples/tatami/andon.toml"

ROOM = block((5, 2.5, 4), (0, 1.25, 0), inwards=True)
ROOM_M2 = 2 * (5 * 2.5 + 5 * 4 + 2.5 * 4)


def limit_of(area_m2, size_px=SIZE_PX):
    """The longest texel that counts, from its definition."""
    return 2.5 * np.sqrt(area_m2 / (4 * np.pi)) * 2 * np.pi / size_px


def check_covers(found, geometry, area_m2):
    assert found.ended == "reached"
    assert found.coverage >= 0.99
    assert found.reachable_area_m2 == pytest.approx(area_m2, rel=0.01)
    assert found.coverage_so_far[-1] == pytest.approx(found.coverage)
    # Samples of its own: chosen for other points, cameras see a little less of these.
    assert finer_coverage(geometry, found, limit_of(found.reachable_area_m2)) >= 0.985


def test_an_empty_room_is_seen_by_few_cameras():
    found = suggested_views(ROOM, **ASKED)
    check_covers(found, ROOM, ROOM_M2)
    assert len(found.views) <= 3


def test_behind_a_pillar_stands_another_camera():
    room = merged(ROOM, block((0.8, 2.5, 0.8), (0, 1.25, 0)))
    found = suggested_views(room, **ASKED)
    check_covers(found, room, ROOM_M2 - 2 * 0.8**2 + 4 * 0.8 * 2.5)
    assert 2 <= len(found.views) <= 5


@pytest.mark.parametrize(("plan", "most"), [(L_SHAPE, 4), (TWO_ROOMS, 6)])
def test_corners_and_doors_are_looked_round(plan, most):
    room = plan_room(plan)
    found = suggested_views(room, **ASKED)
    check_covers(found, room, plan_area(plan))
    assert 2 <= len(found.views) <= most


def test_the_inside_of_solids_is_not_reachable():
    room = merged(ROOM, block((1, 1, 1), (1, 1.2, 0)))
    found = suggested_views(room, **ASKED)
    check_covers(found, room, ROOM_M2 + 6)
    inside = (np.abs(found.candidates - (1, 1.2, 0)) < 0.5).all(axis=1)
    assert not inside.any()


def test_solids_that_are_wound_the_wrong_way_are_closed_to_a_frame_outside_of_them():
    room = merged(ROOM, block((1, 1, 1), (1, 1.2, 0), inwards=True))
    frame = pinhole_view(320, 240, 200.0, look_at(np.array([-2, 1.5, 1.8]), np.array([0, 1, 0])))
    found = suggested_views(room, [frame], **ASKED)
    inside = (np.abs(found.candidates - (1, 1.2, 0)) < 0.5).all(axis=1)
    assert not inside.any()
    assert found.reachable_area_m2 == pytest.approx(ROOM_M2 + 6, rel=0.01)


def test_a_room_in_a_room_is_reached_from_where_the_frame_is():
    # The outer one's walls and the inner one's outer sides are another world.
    around = merged(ROOM, block((9, 6, 9), (0, 1.25, 0), inwards=True))
    frame = pinhole_view(320, 240, 200.0, look_at(np.array([-2, 1.5, 1.8]), np.array([0, 1, 0])))
    found = suggested_views(around, [frame], **ASKED)
    assert found.reachable_area_m2 == pytest.approx(ROOM_M2, rel=0.01)


def test_behind_a_wall_with_a_gap_nobody_stands():
    walls = plan_room(L_SHAPE)
    # Half of the wall at x = 2 is missing; the corner outside of it is in the scene's box.
    middles = walls.positions[walls.triangles].mean(axis=1)
    at_corner = np.flatnonzero(np.isclose(middles[:, 0], 2) & (middles[:, 2] > 2))
    room = Geometry(walls.positions, np.delete(walls.triangles, at_corner[0], axis=0))
    frame = pinhole_view(320, 240, 200.0, look_at(np.array([1, 1.5, 5]), np.array([1.2, 1, 1])))
    found = suggested_views(room, [frame], **ASKED)
    assert len(found.candidates) > 50
    assert ((found.candidates[:, 0] < 2) | (found.candidates[:, 2] < 2)).all()


def test_the_same_seed_gives_the_same_cameras():
    one, two = (suggested_views(ROOM, **ASKED, seed=3) for _ in range(2))
    assert len(one.views) == len(two.views)
    for a, b in zip(one.views, two.views, strict=True):
        np.testing.assert_array_equal(a.world_from_camera, b.world_from_camera)
    assert one.coverage == two.coverage
    other = suggested_views(ROOM, **ASKED, seed=4)
    assert not np.array_equal(one.views[0].position, other.views[0].position)
    assert other.coverage >= 0.99


def test_no_more_than_the_most_cameras():
    room = plan_room(TWO_ROOMS)
    found = suggested_views(room, **(ASKED | {"most_cameras": 2}))
    assert len(found.views) == 2
    assert found.ended == "most cameras"
    assert found.coverage < 0.99


def test_it_says_when_nothing_is_gained():
    # A slit of 4 mm: its sides are seen edge-on at best, and no camera is worth it.
    slit = merged(ROOM, block((1, 1, 0.1), (0, 1.2, 0)), block((1, 1, 0.1), (0, 1.2, 0.104)))
    found = suggested_views(slit, **(ASKED | {"coverage": 1.0, "most_cameras": 64}))
    assert found.ended == "nothing gained"
    assert found.coverage > 0.97
    least = 1e-3 * found.reachable_area_m2
    assert all(area > 0 for area in found.adds_m2)
    assert sum(area < least for area in found.adds_m2) == 0


def test_every_camera_is_another_one():
    found = suggested_views(plan_room(TWO_ROOMS), **ASKED)
    places = np.array([view.position for view in found.views])
    apart = np.linalg.norm(places[:, None] - places, axis=-1)[~np.eye(len(places), dtype=bool)]
    assert apart.min() > 0.1


def test_the_frame_comes_first_and_its_borders_are_inside():
    pose = look_at(np.array([-2.2, 1.5, 1.7]), np.array([1, 1, -1]))
    frame = pinhole_view(640, 480, 500.0, pose)
    found = suggested_views(ROOM, [frame], **ASKED)
    assert found.frame_count == 1
    first = found.views[0]
    np.testing.assert_array_equal(first.world_from_camera, pose)
    assert (first.width, first.height) == (384, 288)
    corners = first.project(frame.directions()[[0, 0, -1, -1], [0, -1, 0, -1]])
    assert (corners > 5).all()
    assert (corners < [384 - 6, 288 - 6]).all()
    check_covers(found, ROOM, ROOM_M2)


def test_two_eyes_are_one_camera():
    pose = look_at(np.array([-2.2, 1.5, 1.7]), np.array([1, 1, -1]))
    left = pinhole_view(640, 480, 500.0, pose, name="left")
    beside = pose.copy()
    beside[:3, 3] += 0.064 * pose[:3, 0]
    right = replace(left, world_from_camera=beside, name="right")
    assert suggested_views(ROOM, [left, right], **ASKED).frame_count == 1
    behind = replace(
        left, world_from_camera=look_at(np.array([2, 1.5, -1]), np.array([-1, 1, 1.8]))
    )
    assert suggested_views(ROOM, [left, behind], **ASKED).frame_count == 2


def test_a_camera_of_the_frame_that_sees_nothing_is_left_out():
    sheet = block((4, 0.1, 4), (0, 0, 0))
    away = pinhole_view(64, 48, 50.0, look_at(np.array([0, 1.0, 0]), np.array([0, 2.0, 0.1])))
    found = suggested_views(sheet, [away], **ASKED)
    assert found.frame_count == 0
    assert found.coverage >= 0.99


def test_finer_maps_want_finer_texels_and_coarse_ones_still_find_places():
    found = suggested_views(ROOM, **(ASKED | {"map_size_px": 16}))
    assert found.coverage >= 0.99
    assert found.views[0].shape == (8, 16)


def test_surfaces_without_area_are_refused():
    point = Geometry(np.zeros((3, 3)), np.array([[0, 1, 2]], np.int32))
    with pytest.raises(InputError, match="area"):
        suggested_views(point, **ASKED)
    with pytest.raises(InputError, match="area"):
        suggested_views(Geometry(np.zeros((0, 3)), np.zeros((0, 3), np.int32)), **ASKED)


def test_places_are_clear_of_surfaces():
    room = merged(ROOM, block((1, 1, 1), (1, 1.2, 0)))
    found = suggested_views(room, **ASKED)
    random = np.random.default_rng(1).normal(size=(500, 3))
    ways = random / np.linalg.norm(random, axis=1, keepdims=True)
    rays = RayScene(room)
    for view in found.views:
        hits = rays.first_hits(np.broadcast_to(view.position, ways.shape), ways)
        assert hits.distance.min() > 0.05


def test_the_tatami_room_is_covered():
    from andon.bake.to_file import scene_geometry
    from andon.engines.reading import view_of
    from andon.scene import load_scene

    scene = load_scene(TATAMI)
    frame = view_of(scene, "mono", None)
    found = suggested_views(scene_geometry(scene), [frame], **ASKED)
    assert found.frame_count == 1
    assert found.coverage >= 0.98
    assert len(found.views) <= 12
    # Nobody stands behind the walls, whose sheets are open at the lattice.
    places = np.array([view.position for view in found.views])
    assert (places[places[:, 0] < 0, 2] > -1.37).all()


@pytest.mark.slow
@pytest.mark.parametrize(("name", "least"), [("sponza", 0.97), ("sibenik", 0.97)])
def test_buildings_are_covered(data_dir, name, least):
    from andon.files.meshes import read_mesh

    building = read_mesh(data_dir / f"{name}_dabrovic/{name}.obj").geometry
    found = suggested_views(building, coverage=least, most_cameras=32, map_size_px=SIZE_PX)
    assert found.ended == "reached"
    limit = limit_of(found.reachable_area_m2)
    assert finer_coverage(building, found, limit, count=30000) >= least - 0.01
