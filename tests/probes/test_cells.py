"""Cells between any probes: whole, without slivers, positively turned; or refused."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from andon.errors import InputError
from andon.files.volumes.model import FACES, Zone
from andon.transport.probes.cells import build_cells
from andon.transport.probes.delaunay import volumes
from andon.verify.probe_sets import degenerate_sets, full_sets, lattice, uniform
from andon.verify.rows.probe_space import not_refused
from requirements import required

required("scipy")
SETS = {**full_sets(), **degenerate_sets()}


def assert_whole(positions, cells):
    """Faces are shared by two, or are facets; neighbours and facets know each other."""
    assert np.all(volumes(positions, cells.corners) > 0)
    sides = np.sort(cells.corners[:, FACES], axis=2)
    for cell, row in enumerate(cells.neighbours):
        for face, other in enumerate(row):
            if other >= 0:
                back = np.flatnonzero(cells.neighbours[other] == cell)
                assert any(np.array_equal(sides[cell, face], sides[other, b]) for b in back)
            else:
                assert np.array_equal(np.sort(cells.facets[-1 - other]), sides[cell, face])
                assert cells.facet_cells[-1 - other] == cell
    for facet, around in enumerate(cells.facet_neighbours):
        for corner, other in enumerate(around):
            if other >= 0:
                assert facet in cells.facet_neighbours[other]
                edge = set(np.delete(cells.facets[facet], corner))
                # Of a piece (a, b, b), place 1 has the piece beyond a.
                if len(set(cells.facets[facet])) == 2 and corner == 1:
                    edge = {cells.facets[facet][0]}
                assert edge <= set(cells.facets[other])


@pytest.mark.parametrize("name", SETS)
def test_cells_are_whole_and_use_every_probe(name):
    cells = build_cells(SETS[name])
    assert_whole(SETS[name], cells)
    used = np.union1d(cells.corners, cells.facets)
    assert np.array_equal(used, np.arange(len(SETS[name])))


@pytest.mark.parametrize("name", full_sets())
def test_the_hull_is_closed_convex_and_seen_from_outside(name):
    positions = SETS[name]
    cells = build_cells(positions)
    assert np.all(cells.facet_neighbours >= 0)
    a, b, c = (positions[cells.facets[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    heights = np.einsum("fi,fpi->fp", normals, positions[None] - a[:, None])
    assert heights.max() <= 1e-12 * np.abs(heights).max()
    # Gauss: the volume inside the facets is that of the cells.
    inside = np.einsum("fi,fi->", a, normals) / 6
    assert inside == pytest.approx(volumes(positions, cells.corners).sum() / 6, rel=1e-9)


def test_a_lattice_has_kuhns_six_tetrahedra_in_every_cell():
    positions = lattice(5)
    cells = build_cells(positions)
    assert len(cells.corners) == 6 * 4**3
    assert volumes(positions, cells.corners) == pytest.approx(4.0**-3, rel=1e-12)
    # All are cut alike: the six differ by a translation from cell to cell.
    low = positions[cells.corners].min(axis=1)
    shape = np.round((positions[cells.corners] - low[:, None]) * 4) @ [1, 2, 4]
    assert len(np.unique(np.sort(shape, axis=1), axis=0)) == 6


def test_a_lattice_that_went_through_float32_has_no_slivers():
    positions = degenerate_sets()["rounded lattice"]
    cells = build_cells(positions)
    assert len(cells.corners) == 6 * 5**3
    assert volumes(positions, cells.corners) == pytest.approx(5.0**-3, rel=1e-5)
    assert len(cells.facets) == 2 * 6 * 5**2


def test_cells_of_free_probes_are_those_of_delaunay_but_for_a_few():
    """The lift stretches space by half a percent."""
    positions = uniform(400)
    spatial = required("scipy.spatial")
    theirs = {tuple(sorted(s)) for s in spatial.Delaunay(positions).simplices.tolist()}
    ours = {tuple(sorted(s)) for s in build_cells(positions).corners.tolist()}
    assert len(ours & theirs) > 0.97 * len(theirs)


def test_planes_lines_and_points_have_facets_only():
    kinds = {"one": 1, "two": 1, "three": 1, "three in a row": 2, "plane": 32, "circle": 10}
    for name, count in kinds.items():
        cells = build_cells(SETS[name])
        assert len(cells.corners) == 0
        assert len(cells.facets) == count, name
        assert np.all(cells.facet_cells == -1)
    row = build_cells(SETS["three in a row"])
    assert row.facets.tolist() in ([[0, 2, 2], [2, 1, 1]], [[1, 2, 2], [2, 0, 0]])
    assert row.facet_neighbours.tolist() == [[1, -1, -1], [-1, 0, -1]]


def test_zones_lie_one_after_the_other_and_share_a_probe_at_a_door():
    positions = np.concatenate([lattice(2), lattice(2)[4:] + np.array([1, 0, 0])])
    west, east = np.arange(8, dtype=np.int32), np.arange(4, 12, dtype=np.int32)
    cells = build_cells(positions, [Zone("west", west), Zone("east", east)])
    assert cells.zone_cells.tolist() == [[0, 6], [6, 6]]
    assert cells.zone_facets.tolist() == [[0, 12], [12, 12]]
    assert_whole(positions, cells)
    assert set(np.unique(cells.corners[:6])) == set(west)
    assert set(np.unique(cells.corners[6:])) == set(east)


def test_what_nothing_can_be_made_of_is_refused():
    assert not_refused() == 0


def test_a_refusal_names_the_probe():
    positions = uniform(9)
    positions[5, 1] = np.nan
    with pytest.raises(InputError, match="probe 5"):
        build_cells(positions)
    with pytest.raises(InputError, match="probes 2 and 9"):
        build_cells(np.vstack([uniform(9), uniform(9)[2]]))


@settings(max_examples=60, deadline=None)
@given(
    points=st.lists(st.tuples(*[st.integers(-4, 4)] * 3), min_size=1, max_size=40, unique=True),
    step=st.sampled_from([1.0, 0.1, 1 / 3]),
    turn=st.integers(0, 5),
)
def test_any_set_of_lattice_points_is_joined(points, step, turn):
    """Every coplanar, collinear and cospherical set of small integers, turned."""
    rotation = np.linalg.qr(np.random.default_rng(turn).normal(size=(3, 3)))[0] if turn else 1.0
    positions = np.asarray(points, float) * step @ (rotation * np.eye(3))
    cells = build_cells(positions)
    assert_whole(positions, cells)
    assert np.array_equal(np.union1d(cells.corners, cells.facets), np.arange(len(positions)))


def test_the_graph_of_a_cube():
    cells = build_cells(lattice(2))
    # Twelve sides, six faces' diagonals, one through the middle.
    assert len(cells.edges) == 19
    assert len(cells.adjacent) == 6
    assert (cells.neighbours[cells.adjacent[:, 0]] == cells.adjacent[:, 1:]).any(axis=1).all()
    assert build_cells(SETS["three in a row"]).edges.tolist() == [[0, 2], [1, 2]]
    assert build_cells(SETS["one"]).edges.shape == (0, 2)
