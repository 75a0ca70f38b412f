"""Light between and beyond probes: exact, continuous, finite; the same in NumPy and Numba."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from andon.errors import InputError
from andon.files.volumes.model import Zone
from andon.transport.probes.cells import build_cells
from andon.transport.probes.space import ProbeSpace
from andon.verify.probe_sets import (
    clustered,
    degenerate_sets,
    full_sets,
    lattice,
    uniform,
    volume_of,
)
from andon.verify.registry import rows
from andon.verify.rows import probe_space
from andon.verify.run import chosen, measured
from requirements import required

required("scipy")
ENGINES = ("numpy", "numba")


def space_of(positions, *zones):
    return ProbeSpace(volume_of(np.asarray(positions, float), zones))


@pytest.fixture(params=ENGINES)
def engine(request):
    if request.param == "numba":
        required("numba")
    return request.param


@pytest.mark.parametrize(
    "name",
    [
        "probes.interpolation.linear",
        "probes.interpolation.faces",
        "probes.interpolation.hull",
        "probes.degenerate.weights",
        "probes.lookup.engines",
    ],
)
def test_rows_hold(name, monkeypatch):
    monkeypatch.setattr(probe_space, "MANY", 2_000)
    monkeypatch.setattr(probe_space, "POINTS", 2_000)
    (entry,) = chosen([name], rows())
    assert measured(entry)["holds"] is True, measured(entry)


@pytest.mark.slow
def test_a_hundred_thousand_probes_hold():
    (entry,) = chosen(["probes.degenerate.weights"], rows())
    probe_space.weight_error.cache_clear()
    assert measured(entry)["holds"] is True, measured(entry)


def test_a_tetrahedron_in_closed_form(engine):
    space = space_of(full_sets()["tetrahedron"])
    points = np.array([[0.2, 0.3, 0.1], [0, 0, 0], [1, 1, 1], [-1, -2, 0.25], [3, -1, -1]])
    values = space.lookup(points, np.eye(4), engine=engine)
    expected = [
        [0.4, 0.2, 0.3, 0.1],
        [1, 0, 0, 0],
        [0, 1 / 3, 1 / 3, 1 / 3],
        [0.75, 0, 0, 0.25],
        [0, 1, 0, 0],
    ]
    assert values == pytest.approx(np.array(expected), abs=1e-15)


def test_inside_outside_and_where_to_start_next_time(engine):
    space = space_of(lattice(3))
    points = np.array([[0.3, 0.2, 0.1], [0.5, 0.4, 7.0]])
    mix = space.locate(points, engine=engine)
    assert mix.cells[0] >= 0 > mix.cells[1]
    assert set(mix.probes[1]) == set(space.facets[-1 - mix.cells[1]])
    assert mix.weights[1, 3] == 0
    again = space.locate(points, mix.cells, engine=engine)
    assert np.array_equal(again.cells, mix.cells)
    assert np.array_equal(again.weights, mix.weights)


@pytest.mark.parametrize("name", ["lattice", "turned lattice", "sphere", "clustered", "plane"])
def test_any_start_finds_the_same_light(name, engine):
    space = space_of({**full_sets(), **degenerate_sets()}[name])
    random = np.random.default_rng(2)
    points = random.uniform(-1.5, 2, (500, 3))
    expected = space.mixed(space.locate(points, engine="numpy"), space.positions)
    everything = np.arange(-len(space.facets) - 3, len(space.corners) + 3)
    start = random.choice(everything, 500).astype(np.int32)
    found = space.mixed(space.locate(points, start, engine=engine), space.positions)
    assert found == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("name", [*full_sets(), "plane", "line", "two", "circle"])
def test_outside_is_the_closest_point_of_the_hull(name, engine):
    """The defining inequality of a projection: (p − c)·(x − c) ≤ 0 for all x of the hull."""
    positions = {**full_sets(), **degenerate_sets()}[name]
    space = space_of(positions)
    extent = space.zone_extents[0]
    points = positions.mean(axis=0) + extent * np.random.default_rng(1).uniform(-3, 3, (400, 3))
    closest = space.lookup(points, positions, engine=engine)
    away = points - closest
    reach = np.einsum("qi,qni->qn", away, positions[None] - closest[:, None])
    assert reach.max() <= 1e-12 * extent**2


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10_000), count=st.integers(1, 30), spread=st.sampled_from([1, 0.05]))
def test_a_projection_never_moves_points_apart(seed, count, spread):
    """Lipschitz 1 of the closest point, and so of light that is linear: continuity everywhere."""
    random = np.random.default_rng(seed)
    space = space_of(random.uniform(-1, 1, (count, 3)) * [1, spread, 1])
    first = random.uniform(-3, 3, (60, 3))
    second = first + random.normal(size=(60, 3)) * 10.0 ** random.uniform(-8, 0, (60, 1))
    at = [space.lookup(p, space.positions, engine="numpy") for p in (first, second)]
    moved = np.linalg.norm(at[0] - at[1], axis=1)
    assert np.all(moved <= np.linalg.norm(first - second, axis=1) + 1e-12)


@settings(max_examples=40, deadline=None)
@given(
    points=st.lists(st.tuples(*[st.floats()] * 3), min_size=1, max_size=20),
    name=st.sampled_from(["cube", "plane", "line", "one", "clustered"]),
)
def test_no_point_is_too_odd(points, name):
    space = _cached(name)
    at = np.array(points)
    valid = np.isfinite(at).all(axis=1)
    for engine in ENGINES:
        mix = space.locate(at, engine=engine)
        assert np.isnan(mix.weights[~valid]).all()
        assert (mix.weights[valid] >= 0).all()
        assert mix.weights[valid].sum(axis=1) == pytest.approx(1, abs=1e-15)
        light = space.lookup(at, np.ones((len(space.positions), 9, 3)), engine=engine)
        assert light.shape == (len(at), 9, 3)
        assert np.array_equal(np.isfinite(light).all(axis=(1, 2)), valid)


SPACES = {}


def _cached(name):
    if name not in SPACES:
        SPACES[name] = space_of({**full_sets(), **degenerate_sets()}[name])
    return SPACES[name]


def test_zones_keep_their_light_to_themselves(engine):
    positions = np.concatenate([lattice(2), lattice(2) + np.array([1.5, 0, 0])])
    number = np.arange(16, dtype=np.int32)
    boxes = np.array([[[-1, -1, -1], [1.25, 2, 2]], [[1.25, -1, -1], [4.0, 2, 2]]])
    west, east = Zone("west", number[:8], boxes[:1]), Zone("east", number[8:], boxes[1:])
    volume = volume_of(positions, (west, east))
    space = ProbeSpace(volume)
    dark_and_bright = np.repeat([0.0, 1.0], 8)[:, None]
    points = np.array([[1.2, 0.5, 0.5], [1.25, 0.5, 0.5], [1.3, 0.5, 0.5], [-9, 0, 0], [9, 9, 9]])
    light = space.lookup(points, dark_and_bright, engine=engine)
    assert light[:, 0].tolist() == [0, 0, 1, 0, 1]
    # The closest point is that of the own zone's hull, though the other's is nearer.
    at = space.lookup(points[:3], positions, engine=engine)
    assert at[:, 0] == pytest.approx([1.0, 1.0, 1.5])
    # A start in the other zone is not used.
    mix = space.locate(points[[0, 2]], engine=engine)
    swapped = space.locate(points[[0, 2]], mix.cells[::-1].copy(), engine=engine)
    assert np.array_equal(swapped.weights, mix.weights)
    only = ProbeSpace(volume, ["east"])
    assert only.lookup(points, dark_and_bright, engine=engine)[:, 0].tolist() == [1] * 5


def test_unknown_zones_are_refused():
    with pytest.raises(InputError, match="did you mean 'all'"):
        ProbeSpace(volume_of(uniform(5)), ["alll"])


@pytest.mark.parametrize(
    ("name", "place", "value"),
    [
        ("corners", (0, 0), 99),
        ("corners", (0, 0), -1),
        ("neighbours", (0, 0), 10_000),
        ("neighbours", (0, 0), -10_000),
        ("facets", (0, 1), 99),
        ("facet_neighbours", (0, 1), -2),
        ("facet_cells", 0, 10_000),
        ("zone_cells", (0, 1), 10_000),
        ("zone_facets", (0, 0), -1),
        ("zone_facets", (0, 1), 0),
    ],
)
def test_broken_cells_are_refused_when_they_are_loaded(name, place, value):
    volume = volume_of(uniform(20))
    cells = build_cells(volume.positions)
    numbers = getattr(cells, name).copy()
    numbers[place] = value
    with pytest.raises(InputError, match=r"cell|zone"):
        ProbeSpace(replace(volume, cells=replace(cells, **{name: numbers})))


def test_cells_inside_out_are_refused():
    volume = volume_of(uniform(20))
    cells = build_cells(volume.positions)
    turned = replace(cells, corners=cells.corners[:, [1, 0, 2, 3]])
    with pytest.raises(InputError, match="inside out"):
        ProbeSpace(replace(volume, cells=turned))


def test_every_start_of_the_grid_is_a_cell_near_its_box():
    space = space_of(clustered(300))
    shape = space.grid_shapes[0]
    x, y, z = (np.arange(n) for n in shape)
    boxes = np.array([(i, j, k) for k, j, i in itertools.product(z, y, x)])
    middles = space.grid_origins[0] + space.grid_steps[0] * (boxes + 0.5)
    assert len(middles) == len(space.grid_starts)
    mix = space.locate(middles, engine="numpy")
    inside = mix.cells >= 0
    assert np.array_equal(mix.cells[inside], space.grid_starts[inside])
    assert space.grid_starts.min() >= 0


def test_a_walk_that_is_cut_short_is_finished_by_a_search(monkeypatch):
    from andon.transport.probes import locate

    monkeypatch.setattr(locate, "step_limit", lambda count: 1)
    space = space_of(uniform(200))
    points = np.random.default_rng(0).uniform(-0.5, 1.5, (300, 3))
    start = np.zeros(300, np.int32)
    cut = space.locate(points, start, engine="numpy")
    monkeypatch.undo()
    whole = space.locate(points, engine="numpy")
    assert space.mixed(cut, space.positions) == pytest.approx(
        space.mixed(whole, space.positions), abs=1e-9
    )


@pytest.mark.parametrize(
    "points",
    [np.zeros(3), np.zeros((4, 2)), np.zeros((2, 2, 3)), np.zeros((1, 3), bool), [["a", "b", "c"]],
     np.zeros((1, 3), complex), 1.0],
)  # fmt: skip
def test_what_is_no_list_of_points_is_refused(engine, points):
    space = space_of(uniform(30))
    with pytest.raises(InputError, match=r"points: must be real numbers of shape \(q, 3\)"):
        space.locate(points, engine=engine)
    with pytest.raises(InputError, match=r"points: must be real numbers of shape \(q, 3\)"):
        space.lookup(points, np.ones(30), engine=engine)
    whole, real = (space.locate(at, engine=engine) for at in ([[0, 1, 0]], np.eye(3)[1:2]))
    np.testing.assert_array_equal(whole.weights, real.weights)


def test_types_and_shapes(engine):
    space = space_of(uniform(30))
    points = uniform(7)
    for kind, values in ((np.float32, np.ones((30, 9, 3), np.float32)), (np.float64, np.ones(30))):
        light = space.lookup(points, values, engine=engine)
        assert light.dtype == kind
        assert light.shape == (7, *values.shape[1:])
        assert light == pytest.approx(1, abs=1e-6)
    assert space.lookup(np.zeros((0, 3)), np.ones((30, 9, 3)), engine=engine).shape == (0, 9, 3)
    assert space.locate(np.zeros((0, 3)), engine=engine).weights.shape == (0, 4)
