"""Maps of known light, projected into other views, against the closed form."""

import gc
import weakref

import numpy as np
import pytest

from andon.surface.objects import joined
from andon.surface.reference import trace
from andon.transport.baked import (
    BakedLight,
    BakedMoment,
    baked_illuminance,
    illuminance_at,
    texels,
)
from baked.scenes import baked_map, candles, fisheye, latlong, pinhole, still
from worlds import ball, block, sheet

ROOM = block((4, 2.4, 4), (0, 1.2, 0), inwards=True)
VIEW = pinhole(160, 120, (-1.2, 1.5, 1.5), (0.5, 0.6, -1))
CAMERAS = {
    "pinhole": lambda size: pinhole(size, size * 3 // 4, (1.5, 1.7, 1.7), (-0.5, 0.8, -1), 1.5),
    "fisheye": lambda size: fisheye(size, (1.5, 1.7, 1.7), (-0.5, 0.8, -1)),
    "latlong": lambda size: latlong(size, (0.3, 1.2, 0.2)),
}
FLOOR = sheet((-4, 0, -4), (0, 0, 8), (8, 0, 0))
UP = np.array([0.0, 1.0, 0.0])


def shown(geometry, view):
    """Points (n, 3) and normals (n, 3) that a view shows."""
    surface = trace(geometry, view, is_object=False)
    return surface.position[surface.valid], surface.normal[surface.valid]


def constant(lux):
    return lambda position, normal: np.full((*position.shape[:-1], 3), float(lux))


def by_normal(axis, lux):
    """`lux` on surfaces that face along +axis, 1 lx elsewhere."""
    return lambda position, normal: np.where(normal[..., axis, None] > 0.5, lux, 1.0) * np.ones(3)


def asked(light, position, normal, time_seconds=0.0):
    return illuminance_at(light, time_seconds, np.asarray(position), np.asarray(normal))


def floor_points(x, z):
    x, z = np.broadcast_arrays(np.asarray(x, float), np.asarray(z, float))
    position = np.stack([x, 0 * x, z], axis=-1)
    return position, np.broadcast_to(UP, position.shape)


# ── how exact ───────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("camera", CAMERAS)
def test_second_order(camera):
    """Twice the texels, a quarter of the error, where light is smooth."""
    position, normal = shown(ROOM, VIEW)
    truth = candles(position, normal)
    errors = []
    for size in (64, 128, 256):
        seen = baked_map(ROOM, CAMERAS[camera](size))
        lux, covered = asked(still(seen), position, normal)
        assert covered.mean() > 0.7
        errors.append(np.median(np.abs(lux / truth - 1).max(axis=1)[covered]))
    assert errors[-1] < 2e-4
    assert errors[0] / errors[1] > 3.5
    assert errors[1] / errors[2] > 3.5


@pytest.mark.parametrize("camera", CAMERAS)
def test_through_the_maps_own_camera_it_is_the_map(camera):
    view = CAMERAS[camera](48)
    surface = trace(ROOM, view, is_object=False)
    seen = baked_map(ROOM, view)
    lux, covered = asked(still(seen), *shown(ROOM, view))
    assert covered.all()
    np.testing.assert_allclose(lux, seen.lux["lamp"][surface.valid], rtol=1e-4)


def test_lamps_count_by_their_shares():
    view = CAMERAS["pinhole"](48)
    one, two = (baked_map(ROOM, view, constant(lux), name) for lux, name in ((3, "a"), (5, "b")))
    both = type(one)(view, one.depth_m, one.normal, {**one.lux, **two.lux})
    position, normal = shown(ROOM, view)
    lux, _ = baked_illuminance(
        BakedMoment(0.0, (both,)), position, normal, shares={"a": 0.5, "b": 2.0}
    )
    np.testing.assert_allclose(lux, 0.5 * 3 + 2 * 5, rtol=1e-6)


def test_edges_of_shadows_stay():
    """Half of the floor is lit: beyond a texel from the edge nothing is blurred, by two maps."""
    edge = lambda position, normal: np.where(position[..., :1] > 0.1, 100.0, 1.0) * np.ones(3)  # noqa: E731
    views = [pinhole(256, 192, (x, 2.0, 1.5), (0, 0, 0)) for x in (-0.7, 0.5)]
    light = still(*[baked_map(FLOOR, view, edge) for view in views])
    x = np.linspace(-0.5, 0.7, 481)
    position, normal = floor_points(x, 0.0)
    lux, covered = asked(light, position, normal)
    assert covered.all()
    # Camera to floor 2.6 m, at focal length 187 px, slanted by 40° at most: 14 mm and 18 mm.
    far = np.abs(x - 0.1) > 0.02
    assert np.mean(~far) < 0.04
    np.testing.assert_allclose(lux[far], edge(position[far], normal[far]), rtol=1e-6)


# ── no leaks ────────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("camera", CAMERAS)
def test_light_does_not_go_round_corners(camera):
    """The floor is lit and the walls are not: to the last millimetre before the corner."""
    seen = baked_map(ROOM, CAMERAS[camera](96), by_normal(1, 1000.0))
    height = np.geomspace(1e-3, 1.0, 40)
    along = np.linspace(-1.8, 1.0, 20)
    h, a = (values.ravel() for values in np.meshgrid(height, along))
    wall, facing = np.stack([a, h, 0 * a - 2], axis=-1), np.tile([0.0, 0.0, 1.0], (len(a), 1))
    lux, covered = asked(still(seen), wall, facing)
    assert covered.mean() > 0.95
    np.testing.assert_allclose(lux[covered], 1.0)
    lux, covered = asked(still(seen), *floor_points(a, h - 2))
    assert covered.mean() > 0.95
    np.testing.assert_allclose(lux[covered], 1000.0)


def test_the_sides_of_a_thin_wall_are_two_surfaces():
    """1 cm, half of the tolerance in depth: the normal tells the sides apart."""
    wall = block((2, 2, 0.01), (0, 1, 0))
    front, back = ((0.2, 1.1, 3.0), (0.2, 1.1, -3.0))
    maps = [
        baked_map(wall, pinhole(96, 96, eye, (0, 1, 0)), by_normal(2, 500.0))
        for eye in (front, back)
    ]
    x, y = (values.ravel() for values in np.meshgrid(*[np.linspace(-0.9, 0.9, 15)] * 2))
    for z, lux in ((0.005, 500.0), (-0.005, 1.0)):
        position = np.stack([x, y + 1, 0 * x + z], axis=-1)
        normal = np.tile([0.0, 0.0, np.sign(z)], (len(x), 1))
        got, covered = asked(still(*maps), position, normal)
        assert covered.all()
        np.testing.assert_allclose(got, lux)
        assert not asked(still(maps[int(z > 0)]), position, normal)[1].any()


def test_what_stands_before_a_wall_gives_it_no_light():
    """A lit box 5 cm before a dark wall: the wall stays dark, and is unknown behind the box."""
    wall = sheet((-2, 0, 0), (4, 0, 0), (0, 2, 0))
    box = block((0.5, 0.5, 0.1), (0, 1, 0.1))
    lit = lambda position, normal: np.where(position[..., 2:] > 0.01, 900.0, 2.0) * np.ones(3)  # noqa: E731
    view = pinhole(256, 128, (0, 1, 2.0), (0, 1, 0), 1.4)
    light = still(baked_map(joined([wall, box]), view, lit))
    x, y = (values.ravel() for values in np.meshgrid(*[np.linspace(-0.6, 0.6, 121)] * 2))
    position = np.stack([x, y + 1, 0 * x], axis=-1)
    lux, covered = asked(light, position, np.tile([0.0, 0.0, 1.0], (len(x), 1)))
    np.testing.assert_allclose(lux[covered], 2.0)
    # The box's front edges, 15 cm before the wall, hide it as far as 0.25·2/1.85 m.
    reach, texel = 0.25 * 2 / 1.85, 2 / view.fx
    size = np.maximum(np.abs(x), np.abs(y))
    assert not covered[size < reach - texel].any()
    assert covered[size > reach + texel].all()


def depths_agree(seen, position, tolerance_m):
    """The paper's rule: the point's depth in the map is its nearest texel's, but for ε."""
    camera = (position - seen.view.position) @ seen.view.world_from_camera[:3, :3]
    column, row = np.rint(seen.view.project(camera)).astype(int).T
    inside = (column >= 0) & (row >= 0) & (column < seen.view.width) & (row < seen.view.height)
    column, row = (
        np.clip(v, 0, n - 1) for v, n in ((column, seen.view.width), (row, seen.view.height))
    )
    return inside & (np.abs(camera[:, 2] - seen.depth_m[row, column]) < tolerance_m), row, column


def test_planes_rather_than_depths_on_a_floor_at_a_slant():
    """Neighbours on a floor 3 … 9 m away differ in depth by more than any ε that keeps walls."""
    floor = sheet((-4, 0, -9), (0, 0, 12), (8, 0, 0))
    seen = baked_map(floor, pinhole(384, 288, (0, 0.8, 0), (0, 0.5, -4), 1.2), constant(10))
    generator = np.random.default_rng(5)
    position, normal = floor_points(generator.uniform(-1, 1, 4000), generator.uniform(-9, -3, 4000))
    by_depth, _, _ = depths_agree(seen, position, 0.02)
    _, by_plane = asked(still(seen), position, normal)
    assert by_plane.all()
    assert by_depth.mean() < 0.75


def test_planes_rather_than_depths_in_a_corner():
    """Within 2 cm of a corner the depths of both walls agree: light goes round it."""
    seen = baked_map(ROOM, CAMERAS["pinhole"](96), by_normal(1, 1000.0))
    generator = np.random.default_rng(6)
    x, h = generator.uniform(-1.5, 0.5, 2000), generator.uniform(0, 0.02, 2000)
    position, normal = np.stack([x, h, 0 * x - 2], axis=-1), np.tile([0.0, 0, 1], (2000, 1))
    agree, row, column = depths_agree(seen, position, 0.02)
    leaks = agree & (seen.lux["lamp"][row, column, 0] > 1)
    assert leaks.mean() > 0.1
    lux, covered = asked(still(seen), position, normal)
    assert covered.mean() > 0.95
    assert lux[covered].max() == pytest.approx(1)


# ── several maps ────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("other", [0.4, 1.5])
def test_no_seam_where_maps_that_disagree_end(other):
    """One says 100 lx, the other 110: no step of 1 % between points 2 mm apart, 0.4 texels."""
    views = (
        pinhole(192, 192, (0, 2, 0.1), (0, 0, 0)),
        pinhole(192, 192, (0.8, other, 0.1), (0.8, 0, 0)),
    )
    maps = [baked_map(FLOOR, v, constant(lux)) for v, lux in zip(views, (100, 110), strict=True)]
    position, normal = floor_points(np.arange(-1, 2.2, 2e-3), 0.07)
    lux, covered = asked(still(*maps), position, normal)
    assert lux[covered].min() == pytest.approx(100)
    assert lux[covered].max() > 109.5
    steps = np.abs(np.diff(lux[:, 0]))[covered[1:] & covered[:-1]]
    assert steps.max() < 1.0


def test_no_seam_where_something_hides_the_floor_from_one_map():
    box = block((0.4, 0.6, 0.4), (0, 0.3, 0))
    scene = joined([FLOOR, box])
    views = [pinhole(256, 192, eye, (0, 0.2, 0)) for eye in ((1.6, 1.6, 0.3), (0.2, 2.4, 1.8))]
    maps = [baked_map(scene, v, constant(lux)) for v, lux in zip(views, (100, 110), strict=True)]
    position, normal = floor_points(np.arange(-1.6, -0.25, 2e-3), 0.05)
    lux, covered = asked(still(*maps), position, normal)
    alone = asked(still(maps[0]), position, normal)[1]
    assert covered.all()
    assert 0 < alone.mean() < 1
    assert np.abs(np.diff(lux[:, 0])).max() < 1.0


def test_the_map_with_more_texels_counts_more():
    near, far = (pinhole(128, 128, (0, h, 0.1), (0, 0, 0)) for h in (0.7, 2.1))
    maps = baked_map(FLOOR, near, constant(100)), baked_map(FLOOR, far, constant(200))
    lux, _ = asked(still(*maps), *floor_points([0.0], [0.0]))
    # A third of the distance, 9 times the texels per m².
    np.testing.assert_allclose(lux, (9 * 100 + 200) / 10, rtol=5e-3)


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_first_valid_follows_the_order_of_the_cameras(order):
    views = pinhole(128, 128, (0, 2, 0.1), (0, 0, 0)), pinhole(128, 128, (1, 2, 0.1), (1, 0, 0))
    maps = [baked_map(FLOOR, v, constant(lux)) for v, lux in zip(views, (100, 200), strict=True)]
    light = still(*[maps[i] for i in order], mode="first_valid")
    lux, covered = asked(light, *floor_points([-0.9, 0.5, 1.9], 0.0))
    assert covered.all()
    np.testing.assert_allclose(lux[:, 0], [100, (100, 200)[order[0]], 200])


# ── what is covered ─────────────────────────────────────────────────────────────────────────────


def test_covered_is_what_the_map_sees():
    """Straight from above a map sees a square: exactly that is covered."""
    view = pinhole(64, 64, (0.3, 2.0, 0.1), (0.3, 0, 0.1 - 1e-9), 1.2)
    light = still(baked_map(FLOOR, view))
    half = 32 / view.fx * 2.0
    generator = np.random.default_rng(2)
    x, z = generator.uniform(-4, 4, (2, 5000))
    _, covered = asked(light, *floor_points(x, z))
    np.testing.assert_array_equal(covered, np.maximum(np.abs(x - 0.3), np.abs(z - 0.1)) < half)


def test_nothing_covers_points_that_face_away():
    seen = baked_map(FLOOR, pinhole(64, 64, (0, 2, 0.1), (0, 0, 0)))
    position, normal = floor_points([0.0, 0.1], 0.0)
    lux, covered = asked(still(seen), position, -normal)
    assert not covered.any()
    assert not lux.any()


@pytest.mark.parametrize("width", [96, 97])
def test_a_panorama_has_no_seam_and_no_poles(width):
    """All around in a ball that is lit alike: covered everywhere, and right."""
    shell = ball(2.0, (0, 0, 0), 24)
    seen = baked_map(shell, latlong(width, (0, 0, 0), (0, 0, -1)), lambda p, n: 5 + p)
    azimuth = np.concatenate([np.linspace(-0.05, 0.05, 41), np.linspace(0, 6.2, 41)])
    elevation = np.linspace(-np.pi / 2, np.pi / 2, 61)
    a, e = (values.ravel() for values in np.meshgrid(azimuth, elevation))
    # Azimuth 0 is straight behind: where columns end and begin.
    outwards = np.stack([np.cos(e) * np.sin(a), np.sin(e), np.cos(e) * np.cos(a)], axis=-1)
    lux, covered = asked(still(seen), 1.995 * outwards, -outwards)
    assert covered.all()
    assert np.abs(lux - (5 + 2 * outwards)).max() < 0.02


# ── time ────────────────────────────────────────────────────────────────────────────────────────


def test_light_between_moments():
    """10 lx at 0 s, 30 lx at 2 s; a box covers part of the floor in the second moment."""
    view = pinhole(96, 96, (0, 3, 0.1), (0, 0, 0))
    box = block((0.5, 0.2, 0.5), (0.8, 0.5, 0))
    moments = [
        BakedMoment(0.0, (baked_map(FLOOR, view, constant(10)),)),
        BakedMoment(2.0, (baked_map(joined([FLOOR, box]), view, constant(30)),)),
    ]
    light = BakedLight((0.0, 2.0), moments.__getitem__, lambda t: {"lamp": 1.0 + t})
    points = floor_points([-0.5, 0.95], 0.0)
    expected = {0.0: (10, 10), 0.5: (15 * 1.5, 10 * 1.5), 1.0: (20 * 2, 10 * 2), 3.0: (30 * 4, 0)}
    for time_seconds, lux in expected.items():
        got, covered = asked(light, *points, time_seconds)
        np.testing.assert_allclose(got[:, 0], lux, rtol=1e-6)
        assert covered.tolist() == [True, time_seconds < 2]


# ── odd input ───────────────────────────────────────────────────────────────────────────────────


def test_no_maps_cover_nothing():
    lux, covered = asked(still(), *floor_points([0.0], [0.0]))
    assert not covered.any()
    assert not lux.any()


def test_a_map_of_holes_covers_nothing():
    seen = baked_map(FLOOR, pinhole(16, 16, (0, 2, 0.1), (0, 5, 9)))
    assert np.isnan(seen.depth_m).all()
    assert not asked(still(seen), *floor_points([0.0, 1.0], 0.0))[1].any()


def test_light_that_is_not_known_is_not_used():
    view = pinhole(65, 65, (0, 2, 0.1), (0, 0, 0.1 - 1e-9))
    seen = baked_map(FLOOR, view, constant(7))
    seen.lux["lamp"][32, 32] = np.nan
    x = np.linspace(-0.2, 0.2, 81)
    lux, covered = asked(still(seen), *floor_points(x, 0.1))
    assert np.isfinite(lux).all()
    np.testing.assert_allclose(lux[covered], 7)
    assert 0 < np.mean(~covered) < 0.1


def test_a_map_of_one_texel():
    seen = baked_map(FLOOR, pinhole(1, 1, (0, 2, 0.1), (0, 0, 0.1 - 1e-9)), constant(7))
    lux, covered = asked(still(seen), *floor_points([0.0], [0.1]))
    assert covered.all()
    np.testing.assert_allclose(lux, 7)


def test_a_panorama_of_two_texels():
    """They look left and right, at the middles of two walls."""
    seen = baked_map(ROOM, latlong(2, (0, 1.2, 0), (0, 1.2, -1)), constant(7))
    position = np.array([[-2, 1.2, 0], [2, 1.2, 0], [0, 1.2, -2.0]])
    normal = np.array([[1, 0, 0], [-1, 0, 0], [0, 0, 1.0]])
    lux, covered = asked(still(seen), position, normal)
    assert covered.tolist() == [True, True, False]
    np.testing.assert_allclose(lux[:2], 7)


def test_points_that_are_nowhere_or_at_the_camera():
    eye = np.array([0.0, 2.0, 0.1])
    below = [0.0, 2.0 - 1e-12, 0.1]
    position = np.array([eye, below, [np.nan, 0, 0], [np.inf, 0, 0], [0, 0, 0]])
    for view in (
        pinhole(64, 64, eye, (0, 0, 0)),
        fisheye(64, eye, (0, 0, 0)),
        latlong(64, eye, (0, 0, 0)),
    ):
        light = still(baked_map(FLOOR, view, constant(7)))
        lux, covered = asked(light, position, np.tile(UP, (5, 1)))
        assert covered.tolist() == [False, False, False, False, True]
        np.testing.assert_allclose(lux[4], 7)


# ── what is kept ────────────────────────────────────────────────────────────────────────────────


def test_texels_are_made_once_and_go_with_their_map(monkeypatch):
    """However many maps there are: frames between two moments ask for those of both in turn."""
    made, make = [], texels.texels_of
    monkeypatch.setattr(texels, "texels_of", lambda *args: made.append(1) or make(*args))
    view = pinhole(4, 3, (0, 2, 0.1), (0, 0, 0))
    light = still(*(baked_map(FLOOR, view) for _ in range(40)))
    for _ in range(2):
        asked(light, *floor_points([0.0, 0.1], 0.0))
    assert len(made) == 40
    kept = weakref.ref(texels.kept_texels(light.load(0).maps[0], light.depth_tolerance_m))
    assert len(made) == 40
    del light
    gc.collect()
    assert kept() is None
