"""Probes keep off surfaces: exact distances, rooms with thick walls, corners, gaps."""

import numpy as np
import pytest

from andon.quantities import Geometry, merged
from andon.scene import scene_from_dict
from andon.surface.nearest import nearest_distance
from andon.transport.probes.placement import place_probes
from andon.transport.probes.placement.clearance import clear_of, nearest_within, off_surfaces
from worlds import ball, block

INNER = block((4, 3, 4), (0, 1.5, 0), inwards=True)
THICK = merged(INNER, block((4.2, 3.2, 4.2), (0, 1.5, 0)))
NOTHING = Geometry(np.zeros((0, 3)), np.zeros((0, 3), np.int32))


def placed(geometry, place=(), **placement):
    probes = {"volume": "v.glb", "place": place}
    if placement:
        probes["placement"] = placement
    return place_probes(scene_from_dict({"probes": probes}), geometry)


def test_distances_are_those_of_all_triangles():
    """Against the tree over triangles, which looks at them in another way."""
    surface = merged(ball(1.0, (0, 2, 0), 12), THICK)
    points = np.random.default_rng(0).uniform(-2.5, 3.5, (3000, 3))
    exact = nearest_distance(points, surface)
    near = nearest_within(points, surface, 0.7)
    within = exact <= 0.7
    assert 500 < np.count_nonzero(within) < 2900
    np.testing.assert_allclose(near.distance_m[within], exact[within], atol=1e-12)
    assert np.isinf(near.distance_m[~within]).all()
    gaps = np.linalg.norm(points - near.points, axis=1)
    np.testing.assert_allclose(gaps[within], exact[within], atol=1e-12)
    assert np.isinf(nearest_within(points[:3], NOTHING, 1.0).distance_m).all()


def test_out_of_a_corner_and_off_a_face():
    low = np.array([-2.0, 0.0, -2.0])
    points = low + np.array([[0.01, 0.01, 0.01], [0.02, 1, 0.03], [1, 0, 1], [1, 1, 1]])
    points = off_surfaces(INNER, points, 0.1)
    np.testing.assert_allclose(points[2], low + np.array([1, 0.1, 1]), atol=1e-12)
    places, clear = clear_of(INNER, points, 0.1)
    assert clear.all()
    assert nearest_distance(places, INNER).min() >= 0.1 * (1 - 1e-4)
    np.testing.assert_allclose(places[0], low + 0.1, atol=1e-4)
    np.testing.assert_array_equal(places[3], points[3])


def test_in_a_narrow_gap_nothing_is_clear():
    gap = merged(block((1, 1, 1), (0, 0, 0)), block((1, 1, 1), (1.1, 0, 0)))
    _, clear = clear_of(gap, np.array([[0.55, 0.0, 0.0], [0.53, 0.1, 0.1]]), 0.1)
    assert not clear.any()


@pytest.mark.parametrize("counts", [[3, 3, 3], [8, 5, 8]])
def test_a_lattice_in_a_room_with_thick_walls(counts):
    """The default box is the outside of the walls: a margin of their thickness ends on them."""
    found = placed(THICK, kind="lattice", counts=counts)
    assert found.count == np.prod(counts)
    inside = np.abs(found.positions - [0, 1.5, 0]) < [2, 1.5, 2]
    assert inside.all()
    assert nearest_distance(found.positions, THICK).min() >= 0.1 * (1 - 1e-4)
    outer = np.prod(counts) - np.prod(np.array(counts) - 2)
    assert found.tally.moved == outer
    assert f"{outer} probes moved" in found.warnings[0]


def test_a_lattice_leaves_out_what_has_no_room():
    """A slot of 10 cm between two blocks, and offsets of 10 cm."""
    slot = merged(block((1, 1, 1), (0, 0, 0)), block((1, 1, 1), (1.1, 0, 0)))
    box = {"low": [0.55, -0.2, -0.2], "high": [0.55, 0.2, 0.2], "counts": [1, 3, 3]}
    free = [{"position": [0, 3, 0]}]
    found = placed(slot, free, kind="lattice", **box)
    assert found.tally.too_near + found.tally.dropped_in_walls == 9
    assert found.count == 1
    assert placed(slot, free, kind="lattice", offset_m=0.04, **box).count == 10


def test_random_places_keep_the_exact_distance():
    found = placed(THICK, kind="random", count=300, offset_m=0.3)
    assert nearest_distance(found.positions, THICK).min() >= 0.3
    assert found.tally.too_near > 0


def test_by_hand_within_a_centimetre_is_warned_about():
    place = [
        {"name": "on", "position": [0, 0.005, 0]},
        {"name": "off", "position": [0, 0.011, 1]},
        {"name": "photo", "position": [1, 0.001, 0], "panorama": "p.hdr"},
    ]
    found = placed(INNER, place)
    assert found.tally.near_walls == ("on",)
    assert found.count == 3
    assert found.warnings == ("1 probe nearer than 1 cm to a surface: on",)
