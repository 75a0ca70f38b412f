"""The test room: closed, clean, and seen from inside only."""

import numpy as np
import pytest
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene

from andon.errors import InputError
from andon.quantities import LUMINANCE_WEIGHTS
from andon.spaces import View
from andon.verify.furniture import ROOM_SIZE, room_parts
from andon.verify.rooms import (
    CLEAR_M,
    FREE_ZONE,
    camera_in,
    furnished_room,
    lamps_in,
    random_view,
)
from andon.verify.solids import box, facet_normals, icosphere, lathe, torus, wedge, weld


@pytest.fixture(scope="module")
def room():
    return furnished_room()


def edge_counts(triangles):
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    return np.unique(np.sort(edges, axis=1), axis=0, return_counts=True)[1]


def volume(solid):
    a, b, c = (solid.positions[solid.triangles[:, k]] for k in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6


def first_hits(room, origins, directions):
    """Distance and cosine to the outward side's normal of what each ray meets first."""
    scene = EmbreeScene(robust=True)
    mesh = TriangleMesh(scene, room.positions.astype(np.float32), room.triangles)
    found = scene.run(origins.astype(np.float32), directions.astype(np.float32), output=1)
    assert mesh is not None
    assert (found["primID"] >= 0).all(), "a ray leaves the room"
    normals = facet_normals(room.positions, room.triangles[found["primID"]])
    return found["tfar"], np.einsum("ij,ij->i", normals, directions)


@pytest.mark.parametrize(
    ("solid", "expected"),
    [
        (box((1, 2, 3), (2, 3, 1)), 6.0),
        (wedge((1, 2, 3)), 3.0),
        (icosphere(0.5, 12), np.pi / 6),
        (torus(1.0, 0.25, (96, 48)), 2 * np.pi**2 * 0.0625),
        (lathe([0, 1, 1, 0], [0, 0, 2, 2], 96), 2 * np.pi),
    ],
    ids=["box", "wedge", "icosphere", "torus", "lathe"],
)
def test_solids_have_the_volume_of_their_shape(solid, expected):
    assert volume(solid) == pytest.approx(expected, rel=0.02)
    assert set(edge_counts(solid.triangles).tolist()) == {2}


def test_icosphere_has_twenty_times_frequency_squared_triangles_on_its_sphere():
    ball = icosphere(0.3, 5)
    assert len(ball.triangles) == 500
    np.testing.assert_allclose(np.linalg.norm(ball.positions, axis=1), 0.3, rtol=1e-12)


def test_moved_turns_roll_then_pitch_then_yaw():
    corner = box((2, 2, 2)).moved((0, 0, 0)).positions[-1]
    np.testing.assert_allclose(corner, 1)
    stick = box((2, 1e-3, 1e-3))
    turned = stick.moved((0, 0, 0), roll_degrees=90, yaw_degrees=33)
    assert np.ptp(turned.positions[:, 1]) == pytest.approx(2)
    assert np.ptp(stick.moved((0, 0, 0), yaw_degrees=90).positions[:, 2]) == pytest.approx(2)


@pytest.mark.parametrize("least", [1, 12_000, 30_000])
def test_room_has_at_least_the_triangles_asked_for(least):
    count = len(furnished_room(least).triangles)
    assert least <= count <= max(4000, 1.2 * least)


@pytest.mark.parametrize("least", [0, 2_000_000])
def test_room_refuses_counts_out_of_range(least):
    with pytest.raises(InputError, match="min_triangles"):
        furnished_room(least)


@pytest.mark.parametrize("seed", [7, 8])
def test_every_object_is_closed_and_outward(seed):
    for part in room_parts(1.0, seed)[6:]:
        assert set(edge_counts(part.solid.triangles).tolist()) == {2}
        assert volume(part.solid) > 0


def test_the_shell_is_closed_and_inward():
    shell = [part.solid for part in room_parts(1.0, 7)[:6]]
    starts = np.cumsum([0, *(len(s.positions) for s in shell)])
    positions, triangles = weld(
        np.concatenate([s.positions for s in shell]),
        np.concatenate([s.triangles + start for s, start in zip(shell, starts, strict=False)]),
    )
    assert set(edge_counts(triangles).tolist()) == {2}
    corners = positions[triangles]
    signed = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6
    assert signed == pytest.approx(-np.prod(ROOM_SIZE))


@pytest.mark.parametrize("seed", range(4))
def test_no_degenerate_triangles(seed):
    room = furnished_room(seed=seed)
    corners = room.positions[room.triangles]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    area = np.linalg.norm(facet_normals(room.positions, room.triangles), axis=1)
    # The height over the longest edge: a needle thinner than 0.2 mm would be numerical dirt.
    assert (2 * area / longest).min() > 2e-4


def test_no_two_objects_share_a_plane_where_they_overlap():
    corners, owner = [], []
    for number, part in enumerate(room_parts(0.5, 7)):
        corners.append(part.solid.positions[part.solid.triangles])
        owner.append(np.full(len(corners[-1]), number))
    corners, owner = np.concatenate(corners), np.concatenate(owner)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    lead = np.take_along_axis(normals, np.abs(normals).argmax(axis=1)[:, None], axis=1)
    normals *= np.sign(lead)
    offset = np.einsum("ij,ij->i", normals, corners[:, 0])
    keys = np.round(np.column_stack([normals, offset]) / 1e-5).astype(np.int64)
    _, group = np.unique(keys, axis=0, return_inverse=True)
    low, high = corners.min(axis=1), corners.max(axis=1)
    for number in np.unique(group):
        members = np.flatnonzero(group.reshape(-1) == number)
        if len(set(owner[members])) < 2:
            continue
        overlap = np.minimum(high[members, None], high[members]) - np.maximum(
            low[members, None], low[members]
        )
        # In the plane two extents count; the third is 0 for planes along the axes.
        touching = (np.sort(overlap, axis=2)[..., 1:] > 1e-6).all(axis=2) & (overlap > -1e-6).all(
            axis=2
        )
        other = owner[members, None] != owner[members]
        assert not (touching & other).any(), set(owner[members])


def test_smooth_normals_are_unit_and_exact_on_angular_things(room):
    smooth = furnished_room(smooth=True)
    assert len(smooth.triangles) == len(room.triangles)
    np.testing.assert_allclose(np.linalg.norm(smooth.normals, axis=1), 1, rtol=1e-12)
    facets = facet_normals(smooth.positions, smooth.triangles)
    area = np.linalg.norm(facets, axis=1)
    assert area.sum() == pytest.approx(
        np.linalg.norm(facet_normals(room.positions, room.triangles), axis=1).sum()
    )
    cosine = np.einsum("ij,ikj->ik", facets / area[:, None], smooth.normals[smooth.triangles])
    assert cosine.min() > 0.6
    exact = (cosine > 1 - 1e-12).all(axis=1)
    assert 0.2 < exact.mean() < 0.8, "angular things are exact, curved things interpolate"


def test_the_seed_decides_and_repeats(room):
    again, other = furnished_room(seed=7), furnished_room(seed=8)
    np.testing.assert_array_equal(room.positions, again.positions)
    assert room.positions.shape != other.positions.shape or not np.allclose(
        room.positions, other.positions
    )


def test_materials_are_several_and_physical(room):
    used = {room.materials[index].reflectance for index in np.unique(room.material_ids)}
    assert len(used) >= 8
    assert all(0 < channel < 1 for reflectance in used for channel in reflectance)


@pytest.mark.parametrize("seed", [7, 3])
def test_the_camera_sees_only_the_inside(seed):
    room = furnished_room(seed=seed)
    view = camera_in(room)
    assert (view.width, view.height, view.projection) == (1280, 720, "pinhole")
    assert_inside(room, camera_in(room, 160, 90))


@pytest.mark.parametrize("seed", range(12))
def test_random_views_stand_in_free_air(room, seed):
    view = random_view(seed, 32, 18)
    assert (view.position >= FREE_ZONE[0]).all()
    assert (view.position <= FREE_ZONE[1]).all()
    assert_inside(room, view)


def assert_inside(room, view: View):
    origin, directions = view.rays_world()
    directions = directions.reshape(-1, 3)
    distance, cosine = first_hits(room, np.tile(origin, (len(directions), 1)), directions)
    assert (cosine < 0).all(), "a back face is seen"
    assert distance.min() > 0.05


@pytest.mark.parametrize("seed", range(4))
def test_the_free_zone_is_free(seed):
    room = furnished_room(4000, seed=seed)
    corners = room.positions[room.triangles]
    inside = (corners.max(axis=1) > FREE_ZONE[0]).all(axis=1) & (
        corners.min(axis=1) < FREE_ZONE[1]
    ).all(axis=1)
    assert not inside.any()


def test_lamps_hang_in_free_air_and_spread(room):
    lamps = lamps_in(room, 16)
    places = np.array([lamp.position for lamp in lamps])
    generator = np.random.default_rng(0)
    directions = generator.normal(size=(3000, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    for place in places:
        distance, cosine = first_hits(room, np.tile(place, (3000, 1)), directions)
        assert distance.min() >= CLEAR_M - 1e-5
        assert (cosine < 0).all(), "a lamp is inside an object"
    apart = np.linalg.norm(places[:, None] - places, axis=2)[~np.eye(16, dtype=bool)]
    assert apart.min() > 0.5


def test_lamps_have_units_and_a_shared_prefix(room):
    few, many = lamps_in(room, 4), lamps_in(room, 6)
    for one, same in zip(few, many, strict=False):
        np.testing.assert_array_equal(one.position, same.position)
        assert one.colour == same.colour
    for lamp in many:
        assert 20 <= lamp.intensity_cd <= 120
        assert lamp.intensity_rgb_cd @ LUMINANCE_WEIGHTS == pytest.approx(lamp.intensity_cd)


@pytest.mark.parametrize("count", [0, 17])
def test_lamps_refuse_other_numbers(room, count):
    with pytest.raises(InputError, match="1…16"):
        lamps_in(room, count)
