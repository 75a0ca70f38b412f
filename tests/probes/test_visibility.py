"""Octahedral distances, and what walls hide."""

import numpy as np
import pytest

from andon.errors import InputError
from andon.files.volumes import Distances
from andon.harmonics import cube_directions, irradiance
from andon.octahedra import bilinear_taps, directions_of, square_of
from andon.transport.probes.cells import build_cells
from andon.transport.probes.hidden import LEAST, NEIGHBOURS, hidden_mix, neighbours_of
from andon.transport.probes.light import probe_coefficients, probe_illuminance, probe_mix
from andon.transport.probes.visibility import distance_map, visible
from comparison import assert_agree

from .volumes import FAR_M, POSITIONS, light_of, random_volume, unit_vectors, volume_at


def cube_room(size, half=1.0):
    """Distances from the middle of a cube, through the texels of a cube map."""
    return half / np.abs(cube_directions(size)).max(axis=-1)


# ── octahedra ───────────────────────────────────────────────────────────────────────────────────


def test_the_square_is_the_sphere():
    directions = unit_vectors(2000)
    assert_agree(directions_of(square_of(directions)), directions, atol=1e-14)
    places = np.random.default_rng(1).uniform(-1, 1, (2000, 2))
    assert_agree(square_of(directions_of(places)), places, atol=1e-14)


def test_axes_lie_where_they_should():
    corners = square_of(np.array([[1.0, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0], [0, 0, 1]]))
    assert_agree(corners, [[1, 0], [0, 1], [-1, 0], [0, -1], [0, 0]], atol=0)
    assert (np.abs(square_of(np.array([0.0, 0, -1]))) == 1).all()


@pytest.mark.parametrize("side", [4, 16, 31])
def test_taps_are_continuous_across_edges(side):
    """A picture of any smooth function of direction is smooth, also where the square ends."""
    directions = unit_vectors(4000, seed=3)
    near_edge = np.abs(square_of(directions)).max(axis=1) > 1 - 0.5 / side
    directions = directions[near_edge]
    picture = np.random.default_rng(0).normal(size=side * side)
    steps = 1e-7 * unit_vectors(len(directions), seed=4)
    values = [
        (weights * picture[texels]).sum(axis=-1)
        for texels, weights in (
            bilinear_taps(directions, side),
            bilinear_taps(directions + steps, side),
        )
    ]
    assert len(directions) > 20
    assert np.abs(values[0] - values[1]).max() < 1e-5 * side
    _, weights = bilinear_taps(directions, side)
    assert (weights >= 0).all()
    assert_agree(weights.sum(axis=-1), np.ones(len(directions)), atol=1e-12)


def test_texel_centres_are_met_exactly():
    side = 8
    at = (np.arange(side) + 0.5) * 2 / side - 1
    x, y = np.meshgrid(at, at)
    texels, weights = bilinear_taps(directions_of(np.stack([x, y], axis=-1)), side)
    own = texels[np.arange(side)[:, None], np.arange(side), weights.argmax(axis=-1)]
    assert (own == np.arange(side * side).reshape(side, side)).all()
    assert weights.max(axis=-1).min() > 1 - 1e-12


# ── distances ───────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("size", [8, 16, 64])
@pytest.mark.parametrize("side", [16, 32])
def test_a_ball_is_constant(size, side):
    mean, square = distance_map(np.full((6, size, size), 2.5), side)
    assert mean.shape == square.shape == (side, side)
    assert_agree(mean, np.full((side, side), 2.5), atol=1e-6)
    assert_agree(square, np.full((side, side), 6.25), atol=1e-5)


def test_means_weigh_by_solid_angle():
    """The mean over the sphere is that of the cube map: texels of the square differ in size."""
    cube = cube_room(64)
    mean, square = distance_map(cube, 16)
    directions = unit_vectors(40_000, seed=7)
    texels, _ = bilinear_taps(directions, 16)
    at = np.minimum(((square_of(directions) + 1) * 8).astype(int), 15)
    ours = mean[at[:, 1], at[:, 0]].mean()
    assert abs(ours - (1 / np.abs(directions).max(axis=1)).mean()) < 0.003
    assert (square >= mean**2).all()
    assert texels.shape == (40_000, 4)


def test_a_batch_is_its_parts():
    cubes = np.random.default_rng(0).uniform(0.1, 9, (3, 6, 8, 8))
    together = distance_map(cubes, 16)
    for number, cube in enumerate(cubes):
        for whole, one in zip(together, distance_map(cube, 16), strict=True):
            assert (whole[number] == one).all()


def test_no_surface_counts_as_far():
    cube = np.full((6, 8, 8), np.inf)
    cube[2] = np.nan
    mean, square = distance_map(cube, 16, far_m=7.0)
    assert_agree(mean, np.full((16, 16), 7.0), atol=0)
    assert_agree(square, np.full((16, 16), 49.0), atol=0)


@pytest.mark.parametrize(
    ("shape", "value", "side"),
    [((6, 8, 4), 1.0, 16), ((5, 8, 8), 1.0, 16), ((6, 8, 8), -1.0, 16), ((6, 8, 8), 1.0, 2)],
)
def test_what_is_no_map_of_distances_is_refused(shape, value, side):
    with pytest.raises(InputError):
        distance_map(np.full(shape, value), side)


# ── visibility ──────────────────────────────────────────────────────────────────────────────────


def seen_from_middle(points, normals=None, **options):
    distances = Distances(*(m[None] for m in distance_map(cube_room(32), 16)), FAR_M)
    numbers = np.zeros((len(points), 1), int)
    return visible(distances, np.zeros((1, 3)), numbers, points, normals, **options)[:, 0]


def test_a_wall_hides_what_is_behind_it():
    directions = unit_vectors(500, seed=1)
    wall = 1 / np.abs(directions).max(axis=1, keepdims=True)
    assert_agree(seen_from_middle(directions * wall * 0.8), np.ones(500), atol=0.02)
    assert seen_from_middle(directions * wall * 1.4).max() == 0
    assert seen_from_middle(np.zeros((1, 3)))[0] == 1


def test_visibility_falls_with_distance():
    far = np.linspace(0.5, 2, 40)
    shares = seen_from_middle(far[:, None] * np.array([0.3, 0.8, 0.1]))
    assert (np.diff(shares) <= 1e-12).all()
    assert (shares >= 0).all()
    assert (shares <= 1).all()


def test_a_surface_does_not_hide_itself():
    """Points of the walls, at any slant down to 35°; but for those in the corners of the room,
    where the nearest texels reach over three walls.
    """
    directions = unit_vectors(500, seed=2)
    axis = np.abs(directions).argmax(axis=1)
    points = directions / np.abs(directions).max(axis=1, keepdims=True)
    normals = -np.eye(3)[axis] * np.sign(directions[np.arange(500), axis])[:, None]
    lifted, flat = seen_from_middle(points, normals), seen_from_middle(points, normals, lift=0)
    assert (lifted > 0.99).mean() > 0.93
    assert (flat > 0.99).mean() < 0.8, "without the lift a quarter of the walls does"


# ── the mix ─────────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("name", POSITIONS)
def test_weights_are_a_mean(name):
    light = light_of(random_volume(POSITIONS[name]))
    points = np.random.default_rng(0).uniform(-2, 6, (600, 3))
    mix = probe_mix(light, points, unit_vectors(600))
    assert np.isfinite(mix.weights).all()
    assert (mix.weights >= 0).all()
    assert_agree(mix.weights.sum(axis=1), np.ones(600), atol=1e-12)
    assert mix.probes.min() >= 0
    assert mix.probes.max() < len(POSITIONS[name])


def test_without_walls_in_the_way_nothing_changes():
    positions = POSITIONS["lattice"]
    volume = volume_at(positions, np.ones((64, 9, 3)), np.full((64, 6, 8, 8), np.inf))
    light = light_of(volume)
    points = np.random.default_rng(0).uniform(-1, 4, (200, 3))
    plain = light.space.locate(points)
    hidden = hidden_mix(light.walls, plain, points)
    assert hidden.probes.shape == (200, 4)
    assert_agree(hidden.weights, plain.weights, atol=1e-12)


def test_the_light_is_continuous():
    """Along lines through many cells, past probes that go out of sight, steps shrink."""
    light = light_of(random_volume(POSITIONS["random"], seed=3))
    for seed in range(4):
        start, end = np.random.default_rng(seed).uniform(-0.5, 4.5, (2, 3))
        jumps = [_largest_step(light, start, end, count) for count in (2_000, 40_000)]
        assert jumps[1] < 0.2 * jumps[0]


def _largest_step(light, start, end, count):
    points = start + np.linspace(0, 1, count)[:, None] * (end - start)
    mix = probe_mix(light, points)
    values = light.space.mixed(mix, light.coefficients[:, 0])
    return np.abs(np.diff(values, axis=0)).max()


def test_neighbours_step_in_where_a_cell_is_hidden():
    """Probes of one cell see nothing, those around it see far: they take over, and only they."""
    positions = POSITIONS["lattice"]
    point = np.array([[1.45, 1.5, 1.6]])
    distances = np.full((64, 6, 8, 8), np.inf)
    own = light_of(volume_at(positions, np.ones((64, 9, 3)))).space.locate(point).probes[0]
    distances[own] = 0.05
    light = light_of(volume_at(positions, np.ones((64, 9, 3)), distances))
    mix = probe_mix(light, point)
    of_cell = np.isin(mix.probes[0], own)
    assert mix.weights[0, of_cell].sum() < 10 * LEAST
    assert np.unique(mix.probes[0, mix.weights[0] > 0.01]).size >= 4


def test_a_wide_mix_is_the_sum_over_all_its_probes():
    """Of 36 probes a point, by a slow loop; of values of any shape."""
    positions, generator = POSITIONS["lattice"], np.random.default_rng(5)
    coefficients = generator.normal(size=(64, 9, 3)) * 30 + 100
    distances = np.where(generator.uniform(size=(64, 1, 1, 1)) < 0.7, 0.05, 9.0)
    distances = np.broadcast_to(distances, (64, 6, 8, 8))
    light = light_of(volume_at(positions, coefficients, distances))
    points, normals = generator.uniform(0, 3, (60, 3)), unit_vectors(60)
    mix = probe_mix(light, points, normals)
    assert mix.probes.shape == (60, 36)
    assert (mix.weights[:, 4:].sum(axis=1) > 0.1).any(), "neighbours count"
    expected = np.zeros((60, 9, 3))
    for row, probes, weights in zip(expected, mix.probes, mix.weights, strict=True):
        for probe, weight in zip(probes, weights, strict=True):
            row += weight * coefficients[probe]
    assert_agree(light.space.mixed(mix, coefficients), expected, rtol=1e-12)
    assert_agree(light.space.mixed(mix, coefficients[:, 0, 1]), expected[:, 0, 1], rtol=1e-12)
    lux = np.maximum(irradiance(expected, normals), 0)
    assert_agree(probe_illuminance(light, points, normals), lux, rtol=1e-12)
    in_air = light.space.mixed(probe_mix(light, points), coefficients)
    assert_agree(probe_coefficients(light, points), in_air, rtol=1e-15)


def test_where_all_is_hidden_the_cell_decides():
    positions = POSITIONS["lattice"]
    volume = volume_at(positions, np.ones((64, 9, 3)), np.full((64, 6, 8, 8), 0.05))
    light = light_of(volume)
    points = np.random.default_rng(0).uniform(0.2, 2.8, (50, 3))
    clear = np.linalg.norm(points[:, None] - positions, axis=-1).min(axis=1) > 0.2
    plain = light.space.locate(points[clear])
    mix = probe_mix(light, points[clear])
    assert_agree(mix.weights[:, :4], plain.weights, atol=1e-9)
    assert mix.weights[:, 4:].max() < 1e-9


def test_neighbours_share_an_edge():
    around = neighbours_of(build_cells(POSITIONS["lattice"]), POSITIONS["lattice"])
    assert around.shape == (64, NEIGHBOURS)
    away = np.linalg.norm(POSITIONS["lattice"][around] - POSITIONS["lattice"][:, None], axis=-1)
    away = np.where(around >= 0, away, np.inf)
    assert (away[:, 1:3] >= away[:, :2]).all()
    assert away[:, :3].max() < 1.01  # each has its three or more neighbours along the axes
    lonely = neighbours_of(build_cells(POSITIONS["single"]), np.zeros((1, 3)))
    assert (lonely == -1).all()
