"""Samples, gains, depth images, cameras that see nothing, and the plan."""

import numpy as np
import pytest

from andon.errors import InputError
from andon.quantities import Geometry, merged
from andon.spaces import look_at, pinhole_view
from andon.surface.triangulate import triangulate_depth
from andon.transport.baked.placement import check_view_sees, plan_picture, suggested_views
from andon.transport.baked.placement.greedy import Looks, best_place, first_queue
from andon.transport.baked.placement.plan import CAMERA, FRAME, OPEN
from andon.transport.baked.placement.samples import surface_samples
from worlds import block, sheet

ROOM = block((5, 2.5, 4), (0, 1.25, 0), inwards=True)
INSIDE = look_at(np.array([-2.2, 1.5, 1.7]), np.array([1, 1, -1]))


def test_samples_stand_for_equal_areas():
    parts = [sheet((0, y, 0), (width, 0, 0), (0, 0, 1)) for y, width in ((0, 1), (5, 3), (9, 0.01))]
    samples = surface_samples(merged(*parts), 4010, 5)
    assert samples.area_m2 == pytest.approx(4.01 / 4010)
    height = np.round(samples.points[:, 1], 6)
    counts = [np.count_nonzero(height == y) for y in (0, 5, 9)]
    np.testing.assert_allclose(counts, [1000, 3000, 10], atol=2)
    # Evenly within them: of every tenth of the long one nearly as many.
    tenths = np.histogram(samples.points[height == 5, 0], 10, (0, 3))[0]
    np.testing.assert_allclose(tenths, 300, atol=12)
    np.testing.assert_allclose(np.abs(samples.normals), [[0, 1, 0]] * 4010, atol=1e-12)


def test_the_lazy_queue_finds_the_largest_gain():
    random = np.random.default_rng(2)
    looks = [
        Looks(np.zeros(3), sides, random.integers(4, 9, len(sides)))
        for sides in (np.flatnonzero(random.random(300) < 0.2) for _ in range(40))
    ]
    covered = np.zeros(300, bool)
    queue = first_queue(looks, covered)
    while (place := best_place(looks, covered, queue)) is not None:
        gains = [int(look.value[~covered[look.sides]].sum()) for look in looks]
        assert place == int(np.argmax(gains))  # of equal ones the first
        covered[looks[place].sides] = True
    assert covered.all()


def depth_scene():
    """A wall 3 m ahead with a post before it, as a depth image and its view."""
    view = pinhole_view(160, 120, 140.0, look_at(np.array([1, 1.5, 4]), np.array([1, 1.2, 0])))
    depth = np.full(view.shape, 3.0)
    depth[30:, 70:90] = 2.0
    return triangulate_depth(depth, view), view


def test_a_depth_image_is_looked_at_from_its_front():
    geometry, view = depth_scene()
    found = suggested_views(
        geometry, [view], coverage=0.99, most_cameras=12, map_size_px=384, one_sided=True
    )
    assert found.frame_count == 1
    assert found.adds_m2[0] >= 0.97 * found.reachable_area_m2
    assert found.coverage >= 0.99
    # Nobody stands behind a triangle that the photograph shows.
    local = (found.candidates - view.position) @ view.world_from_camera[:3, :3]
    pixels = np.nan_to_num(view.project(local), nan=-9.0)
    shown = ((pixels > 0) & (pixels < [view.width - 1, view.height - 1])).all(axis=1)
    assert shown.sum() > 20
    assert (local[shown, 2] < 3.0).all()
    fronts = np.einsum("ij,ij->i", view.position - found.points, found.normals)
    assert (fronts > 0).all()


def test_a_camera_that_sees_something_is_taken():
    check_view_sees(ROOM, pinhole_view(64, 48, 50.0, INSIDE), "baked.camera[0]")
    # So small and far that the first, sparse look goes past it.
    dot = block((0.004, 0.004, 0.004), (0.021, 0.033, -3.0))
    ahead = pinhole_view(1600, 1200, 1500.0)
    check_view_sees(dot, ahead, "baked.camera[0]")


def test_a_camera_that_sees_nothing_is_refused():
    away = pinhole_view(64, 48, 50.0, look_at(np.array([9.0, 1, 0]), np.array([12.0, 1, 0])))
    with pytest.raises(InputError, match="sees nothing") as refused:
        check_view_sees(ROOM, away, "baked.camera[2]")
    text = str(refused.value)
    for part in ("baked.camera[2]", "[9, 1, 0] m", "along [1, 0, 0]", "at [0, 1.25, 0] m", "turn"):
        assert part in text
    empty = Geometry(np.zeros((0, 3)), np.zeros((0, 3), np.int32))
    with pytest.raises(InputError, match="there is no surface"):
        check_view_sees(empty, away, "baked.camera[0]")


def near(picture, colour):
    return np.abs(picture.astype(int) - colour).max(axis=-1) < 12


def test_the_plan_shows_cameras_where_they_are_and_what_none_sees():
    room = merged(ROOM, block((0.8, 2.5, 0.8), (0, 1.25, 0)))
    frame = pinhole_view(64, 48, 50.0, INSIDE)
    asked = {"coverage": 0.99, "map_size_px": 384}
    little = suggested_views(room, [frame], **asked, most_cameras=1)
    enough = suggested_views(room, [frame], **asked, most_cameras=12)
    one, all_of_them = (plan_picture(room, found) for found in (little, enough))
    assert one.dtype == np.uint8
    assert near(one[:700], OPEN).sum() > 20 * near(all_of_them[:700], OPEN).sum()
    # 5 m are 900 px, the room's corner is at 44 px.
    for found, picture in ((little, one), (enough, all_of_them)):
        for number, view in enumerate(found.views):
            x, z = view.position[[0, 2]]
            column, row = int(44 + (x + 2.5) * 180), int(44 + (z + 2) * 180)
            patch = picture[row - 12 : row + 13, column - 12 : column + 13]
            colour = FRAME if number < found.frame_count else CAMERA
            assert near(patch, colour).sum() > 100


def test_plans_are_the_same_every_time():
    found = suggested_views(ROOM, coverage=0.99, most_cameras=4, map_size_px=64)
    np.testing.assert_array_equal(plan_picture(ROOM, found), plan_picture(ROOM, found))
