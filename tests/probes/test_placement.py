"""Where probes go: by hand, off vertices, in lattices, by chance."""

import numpy as np
import pytest

from andon.errors import InputError
from andon.quantities import Geometry, Material, merged
from andon.scene import scene_from_dict
from andon.transport.probes.placement import (
    locators,
    nearest_distances_m,
    place_probes,
    place_tables,
    zones_of,
)
from worlds import ball, block

NOTHING = Geometry(np.zeros((0, 3)), np.zeros((0, 3), np.int32))
ROOM = block((4, 3, 4), (0, 1.5, 0), inwards=True)
PILLAR = block((1, 3, 1), (0, 1.5, 0))


def scene(*, seed=0, place=(), zone=(), **placement):
    probes = {"volume": "v.glb", "place": place, "zone": zone}
    if placement:
        probes["placement"] = placement
    return scene_from_dict({"scene": {"seed": seed}, "probes": probes})


def hand(*positions, **more):
    return [{"position": position, **more} for position in positions]


def test_by_hand_as_stated():
    place = [
        {"name": "a", "position": [1, 2, 3], "role": "sky", "range_m": 7.0},
        {"name": "b", "position": [0, 1, 0], "capture_position": [0, 1.5, 0]},
        {
            "name": "c", "position": [2, 0, 0], "panorama": "p.hdr", "heading_degrees": 90.0,
            "luminance_per_unit": 5.0, "white": [1.0, 0.9, 0.8],
        },
    ]  # fmt: skip
    placed = place_probes(scene(place=place), NOTHING)
    assert placed.names == ("a", "b", "c")
    assert placed.roles == ("sky", "general", "general")
    np.testing.assert_array_equal(placed.positions, [[1, 2, 3], [0, 1, 0], [2, 0, 0]])
    np.testing.assert_array_equal(placed.capture_positions[1], [0, 1.5, 0])
    np.testing.assert_array_equal(placed.ranges_m, [7, np.inf, np.inf])
    assert placed.panoramas[:2] == (None, None)
    panorama = placed.panoramas[2]
    assert (panorama.reference, panorama.field) == ("p.hdr", "probes.place[2].panorama")
    assert panorama.heading_degrees == 90
    assert panorama.luminance_per_unit == 5
    assert panorama.white == (1, 0.9, 0.8)
    assert placed.warnings == ()


def test_names_become_unique_and_never_take_anothers():
    place = [
        {"name": name, "position": [x, 0, 0]}
        for x, name in enumerate(["a", "a", "a-2", "a", "b", "b"])
    ]
    placed = place_probes(scene(place=place), NOTHING)
    assert placed.names == ("a", "a-3", "a-2", "a-4", "b", "b-2")


def test_duplicates_are_merged_and_counted():
    at = [0.5, 1, -2]
    place = [
        {"name": "first", "position": at, "role": "sky"},
        {"name": "again", "position": [0.5, 1.0004, -2]},
        {"name": "near", "position": [0.5, 1.002, -2]},
        {"name": "thrice", "position": at},
    ]
    placed = place_probes(scene(place=place), NOTHING)
    assert placed.names == ("first", "near")
    assert placed.roles == ("sky", "general")
    assert placed.tally.merged == 2
    (warning,) = placed.warnings
    assert "2 probes within 1 mm of another, left out: again, thrice" in warning


def test_those_by_hand_count_beside_a_lattice_and_come_first():
    placed = place_probes(
        scene(
            place=hand([0, 0, 0], [9, 9, 9]),
            kind="lattice", low=[0, 0, 0], high=[1, 1, 1], counts=[2, 2, 2], offset_m=0.0,
            role="bounce", range_m=2.0,
        ),
        NOTHING,
    )  # fmt: skip
    assert placed.count == 9
    assert placed.tally.merged == 1
    assert placed.names[:3] == ("probe", "probe-2", "lattice-0-0-1")
    assert placed.roles == ("general",) * 2 + ("bounce",) * 7
    np.testing.assert_array_equal(placed.ranges_m, [np.inf] * 2 + [2.0] * 7)


def test_lattice_by_counts():
    placed = place_probes(scene(kind="lattice", counts=[4, 3, 2], offset_m=0.5), ROOM)
    axes = [np.unique(placed.positions[:, axis]) for axis in range(3)]
    np.testing.assert_allclose(axes[0], [-1.5, -0.5, 0.5, 1.5])
    np.testing.assert_allclose(axes[1], [0.5, 1.5, 2.5])
    np.testing.assert_allclose(axes[2], [-1.5, 1.5])
    assert placed.names[0] == "lattice-0-0-0"
    assert placed.names[-1] == "lattice-3-2-1"


@pytest.mark.parametrize(
    ("spacing", "counts"), [(1.0, (5, 4, 5)), (0.9, (5, 4, 5)), (9.0, (1, 1, 1)), (2.1, (3, 2, 3))]
)
def test_lattice_by_spacing_fits_its_box(spacing, counts):
    placed = place_probes(scene(kind="lattice", spacing_m=spacing, offset_m=0.0), specks(ROOM))
    assert tuple(len(np.unique(placed.positions[:, axis])) for axis in range(3)) == counts
    middle = (placed.positions.min(axis=0) + placed.positions.max(axis=0)) / 2
    np.testing.assert_allclose(middle, [0, 1.5, 0], atol=1e-12)


def specks(room):
    """A room without walls near its bounds: a speck at each of two corners."""
    return Geometry(room.positions, np.array([[0, 0, 7], [7, 7, 0]], np.int32))


def test_a_flat_box_is_a_flat_lattice():
    placed = place_probes(
        scene(kind="lattice", low=[0, 1, 0], high=[2, 1, 2], spacing_m=1.0, offset_m=0.25), NOTHING
    )
    assert placed.count == 9
    np.testing.assert_array_equal(placed.positions[:, 1], 1)


def test_lattice_probes_leave_walls_or_are_left_out():
    """A pillar of 1 m: 0.2 m under its face is moved out, 0.5 m under it is not, with 1 m steps."""
    settings = {
        "kind": "lattice", "low": [-1.3, 1.0, 0.0], "high": [1.7, 1.0, 0.0],
        "counts": [4, 1, 1], "offset_m": 0.0,
    }  # fmt: skip
    placed = place_probes(scene(**settings), PILLAR)
    assert placed.names == ("lattice-0-0-0", "lattice-1-0-0", "lattice-2-0-0", "lattice-3-0-0")
    assert placed.tally.moved == 1
    x = placed.positions[:, 0]
    np.testing.assert_allclose(x[[0, 2, 3]], [-1.3, 0.7, 1.7], atol=1e-12)
    moved = placed.positions[1]
    outside = np.maximum(np.abs(moved - [0, 1.5, 0]) - [0.5, 1.5, 0.5], 0).max()
    assert outside >= 0
    assert np.linalg.norm(moved - [-0.3, 1, 0]) <= 0.45
    assert place_probes(scene(place=hand(moved.tolist())), PILLAR).tally.in_walls == ()
    assert (
        "of the lattice, 1 probe moved out of walls or away from surfaces, 0 inside"
        in placed.warnings[0]
    )
    settings |= {"low": [-1.0, 1.0, 0.0], "high": [1.0, 1.0, 0.0], "counts": [3, 1, 1]}
    placed = place_probes(scene(**settings), PILLAR)
    assert placed.names == ("lattice-0-0-0", "lattice-2-0-0")
    assert placed.tally.dropped_in_walls == 1


def test_off_vertices_along_their_normals():
    """A ball's vertices lie on its normals, so places lie on a larger ball."""
    placed = place_probes(scene(kind="vertices", offset_m=0.25), ball(1.0, (0, 2, 0), 4))
    radius = np.linalg.norm(placed.positions - [0, 2, 0], axis=1)
    np.testing.assert_allclose(radius, 1.25, atol=0.01)
    assert placed.count == len(np.unique(ball(1.0, (0, 2, 0), 4).positions.round(9), axis=0))


def test_normals_of_a_room_point_inwards():
    placed = place_probes(scene(kind="vertices", offset_m=0.3), ROOM)
    assert placed.count == 8
    step = 0.3 / np.sqrt(3)
    distance = np.abs(np.abs(placed.positions - [0, 1.5, 0]) - [2, 1.5, 2])
    # Two triangles of a face may meet in a corner and one in another: weights differ.
    assert (distance > 0.3 * step).all()
    assert (np.abs(placed.positions - [0, 1.5, 0]) < [2, 1.5, 2]).all()
    np.testing.assert_allclose(np.linalg.norm(distance, axis=1), 0.3, atol=1e-6)


def test_vertices_keep_their_distance_and_the_first_come_wins():
    surface = ball(1.0, (0, 2, 0), 12)
    every = place_probes(scene(kind="vertices"), surface)
    few = place_probes(scene(kind="vertices", min_distance_m=0.5), surface)
    assert few.count + few.tally.crowded == every.count
    assert nearest_distances_m(few.positions).min() >= 0.5
    assert set(few.names) < set(every.names)
    assert few.names[0] == every.names[0]
    # Maximal: every place that was passed over is too near to one that was taken.
    gaps = np.linalg.norm(every.positions[:, None] - few.positions, axis=2).min(axis=1)
    assert gaps.max() < 0.5
    again = place_probes(scene(kind="vertices", min_distance_m=0.5), surface)
    np.testing.assert_array_equal(again.positions, few.positions)


def test_places_behind_or_inside_another_wall_are_dropped():
    """A ball 0.1 m before a thick wall: with 0.3 m offset its near side ends inside the wall."""
    wall = block((0.4, 4, 4), (1.3, 0, 0))
    small = ball(1.0, (0, 0, 0), 6)
    alone = place_probes(scene(kind="vertices", offset_m=0.3, low=[-2] * 3, high=[1.6] * 3), small)
    both = place_probes(
        scene(kind="vertices", offset_m=0.3, low=[-2] * 3, high=[1.6] * 3), merged(small, wall)
    )
    assert both.tally.hidden > 0
    assert (both.positions[:, 0] < 1.1).all()
    assert (alone.positions[:, 0] > 1.1).any()


def test_sheets_with_two_sides_have_no_outside():
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]], float)
    sheet = Geometry(square, np.array([[0, 1, 2], [0, 2, 3], [2, 1, 0], [3, 2, 0]], np.int32))
    with pytest.raises(InputError, match="no probe is left"):
        place_probes(scene(kind="vertices", low=[-1] * 3, high=[2] * 3), sheet)


def test_random_places_are_free_apart_and_seeded():
    settings = {"kind": "random", "count": 60, "min_distance_m": 0.4, "offset_m": 0.2}
    world = merged(ROOM, PILLAR)
    placed = place_probes(scene(seed=3, **settings), world)
    assert placed.count == 60
    assert nearest_distances_m(placed.positions).min() >= 0.4
    aside = np.abs(placed.positions[:, [0, 2]]).max(axis=1)
    assert (aside > 0.5).all(), "inside the pillar"
    assert (aside <= 1.8).all()
    assert placed.tally.dropped_in_walls > 0
    np.testing.assert_array_equal(
        placed.positions, place_probes(scene(seed=3, **settings), world).positions
    )
    assert not np.array_equal(
        placed.positions, place_probes(scene(seed=4, **settings), world).positions
    )


def test_a_full_box_says_so():
    placed = place_probes(
        scene(kind="random", count=50, min_distance_m=1.0, low=[0] * 3, high=[1] * 3), NOTHING
    )
    assert 1 <= placed.count < 20
    assert f"only {placed.count} of 50 random probes have room" in placed.warnings[0]


def test_those_by_hand_inside_walls_are_named_and_kept():
    place = [
        {"name": "in", "position": [0, 1, 0]},
        {"name": "out", "position": [1.2, 1, 0]},
        {"name": "rescued", "position": [0.1, 1, 0], "capture_position": [1, 1, 1]},
        {"name": "photo", "position": [0.2, 1.2, 0], "panorama": "p.hdr"},
    ]
    placed = place_probes(scene(place=place), merged(ROOM, PILLAR))
    assert placed.names == ("in", "out", "rescued", "photo")
    assert placed.tally.in_walls == ("in",)
    assert placed.warnings == ("1 probe inside a wall or behind it: in",)


def test_a_surface_that_is_inside_out_is_suspected():
    room = block((4, 3, 4), (0, 1.5, 0))  # seen from inside it shows its backs
    with pytest.raises(InputError, match="64 places lie inside walls") as refusal:
        place_probes(scene(kind="lattice", counts=[4, 4, 4]), room)
    assert "turn its faces round" in refusal.value.remedy


@pytest.mark.parametrize(
    ("settings", "expected"),
    [
        ({"kind": "automatic", "spacing_m": 1.0}, "not built yet"),
        ({}, "there is no probe to place"),
        ({"kind": "vertices"}, "needs a surface"),
        ({"kind": "random", "low": [0, 0, 0]}, "needs a box"),
        ({"kind": "random", "low": [0, 0, 0], "high": [1, -1, 1]}, "must be above low"),
        (
            {"kind": "lattice", "low": [0] * 3, "high": [1] * 3, "counts": [100, 100, 100]},
            "more than 100000",
        ),
        (
            {"kind": "lattice", "low": [0] * 3, "high": [1e3] * 3, "spacing_m": 1e-9},
            "more than 100000",
        ),
    ],
)
def test_refusals(settings, expected):
    with pytest.raises(InputError, match=expected) as refusal:
        place_probes(scene(**settings), NOTHING)
    assert refusal.value.field.startswith("probes")


def test_no_table():
    with pytest.raises(InputError, match=r"needs a \[probes\] table"):
        place_probes(scene_from_dict({}), NOTHING)


def test_tables_place_the_same_probes_by_hand():
    place = [
        {"name": "a", "position": [1, 2, 3], "capture_position": [1, 2.5, 3], "range_m": 4.0},
        {"name": "b", "position": [2, 2, 3], "panorama": "p.hdr", "white": [1.0, 2.0, 1.0]},
    ]
    first = place_probes(
        scene(place=place, kind="lattice", counts=[2, 2, 2], role="sky", low=[0] * 3, high=[1] * 3),
        NOTHING,
    )
    second = place_probes(scene(place=place_tables(first)), NOTHING)
    np.testing.assert_allclose(second.positions, first.positions, atol=5e-5)
    np.testing.assert_allclose(second.capture_positions, first.capture_positions, atol=5e-5)
    assert (second.names, second.roles) == (first.names, first.roles)
    np.testing.assert_array_equal(second.ranges_m, first.ranges_m)
    assert second.panoramas[1].white == (1, 2, 1)


def test_locators_say_roles():
    placed = place_probes(
        scene(
            place=[
                {"name": "probe_sky.001", "position": [0, 0, 0], "role": "sky"},
                {"name": "door", "position": [1, 0, 0], "role": "bounce"},
                {"name": "plain", "position": [2, 0, 0], "capture_position": [2, 1, 0]},
            ]
        ),
        NOTHING,
    )
    nodes = locators(placed)
    assert [node.name for node in nodes] == [
        "probe_sky.001", "probe_bounce_door", "probe_plain", "capture_plain",
    ]  # fmt: skip
    assert [node.parent for node in nodes] == [-1, -1, -1, 2]
    np.testing.assert_array_equal(nodes[3].position, [2, 1, 0])


def test_zones_take_the_probes_in_their_boxes():
    boxes = [
        {"name": "west", "low": [-2, 0, -1], "high": [0.1, 3, 1]},
        {"name": "east", "low": [-0.1, 0, -1], "high": [2, 3, 1]},
        {"name": "west", "low": [-2, 0, 1], "high": [-1, 3, 4]},
    ]
    positions = np.array([[-1, 1, 0], [0, 1, 0], [1, 1, 0], [-1.5, 1, 3], [5, 1, 0]], float)
    west, east = zones_of(scene(place=hand([0, 0, 0]), zone=boxes), positions)
    assert (west.name, east.name) == ("west", "east")
    np.testing.assert_array_equal(west.probes, [0, 1, 3])
    np.testing.assert_array_equal(east.probes, [1, 2, 4])  # outside: the nearest box
    assert west.boxes.shape == (2, 2, 3)
    np.testing.assert_array_equal(east.boxes[0], [[-0.1, 0, -1], [2, 3, 1]])


def test_without_zones_there_is_one():
    (zone,) = zones_of(scene(place=hand([0, 0, 0])), np.zeros((3, 3)))
    np.testing.assert_array_equal(zone.probes, [0, 1, 2])
    assert zone.boxes is None


def test_a_zone_without_probes_is_refused():
    box = [{"name": "attic", "low": [0, 9, 0], "high": [1, 10, 1]}]
    box += [{"name": "room", "low": [-9, 0, -9], "high": [9, 3, 9]}]
    with pytest.raises(InputError, match="no probe lies in the zone 'attic'") as refusal:
        zones_of(scene(place=hand([0, 0, 0]), zone=box), np.zeros((1, 3)))
    assert refusal.value.field == "probes.zone[0]"


def test_one_sided_materials_count_at_half_the_share():
    """Behind a wide one-sided sheet a probe is behind a wall; behind a curtain it is not."""
    square = np.array([[-9, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0]], float)
    faces = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
    behind = hand([0, 0, -1])
    for two_sided, names in ((True, ()), (False, ("probe",))):
        sheet = Geometry(square, faces, materials=(Material(two_sided=two_sided),))
        assert place_probes(scene(place=behind), sheet).tally.in_walls == names
        assert place_probes(scene(place=hand([0, 0, 1])), sheet).tally.in_walls == ()


def test_places_are_those_that_files_hold():
    """Float32 has them, and those on the side between two zones stay in both."""
    places = hand([0.1, 0.2, 0.3], [0.7, 0, 0])
    placed = place_probes(scene(place=places), NOTHING)
    for points in (placed.positions, placed.capture_positions):
        np.testing.assert_array_equal(points, points.astype(np.float32))
        assert (points != [[0.1, 0.2, 0.3], [0.7, 0, 0]]).any()
    boxes = [
        {"name": "west", "low": [-1, -1, -1], "high": [0.7, 1, 1]},
        {"name": "east", "low": [0.7, -1, -1], "high": [2, 1, 1]},
    ]
    west, east = zones_of(scene(place=places, zone=boxes), placed.positions)
    assert (west.probes.tolist(), east.probes.tolist()) == ([0, 1], [1])


@pytest.mark.parametrize("spacing", [0.7, 1.3, 2.0])
def test_far_from_the_origin_cells_are_those_of_the_file(tmp_path, spacing):
    """Where float32 tells places apart by half a metre, or not at all."""
    from andon.files.volumes import ProbeVolume, read_volume, write_volume
    from andon.transport.probes.cells import build_cells

    low = np.array([4e5, 100.0, 5e6])
    lattice = {"kind": "lattice", "counts": [4, 3, 4], "low": low.tolist(),
               "high": (low + spacing * np.array([3, 2, 3]) + 0.2).tolist()}  # fmt: skip
    placed = place_probes(scene(**lattice), NOTHING)
    assert placed.count == 48
    zones = zones_of(scene(**lattice), placed.positions)
    volume = ProbeVolume(
        placed.positions, placed.capture_positions, placed.names, placed.roles, placed.ranges_m,
        {"day": np.ones((48, 1, 3))}, zones, build_cells(placed.positions, zones),
    )  # fmt: skip
    write_volume(tmp_path / "far.glb", volume)
    np.testing.assert_array_equal(read_volume(tmp_path / "far.glb").positions, placed.positions)


def test_places_that_float32_does_not_tell_apart_are_refused():
    near = hand([4e5, 0, 5e6], [4e5 + 0.3, 0, 5e6])
    with pytest.raises(InputError, match="too far from the origin for float32") as caught:
        place_probes(scene(place=near), NOTHING)
    assert "move the scene" in caught.value.remedy
    twice = hand([4e5, 0, 5e6], [4e5, 0, 5e6])
    assert place_probes(scene(place=twice), NOTHING).tally.merged == 1
