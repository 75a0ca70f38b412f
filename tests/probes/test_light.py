"""Light of probes: closed forms, and the shaders against the reference."""

import numpy as np
import pytest

from andon.errors import InputError
from andon.files.volumes import Zone
from andon.gpu.bindings import bind_group
from andon.gpu.passes import FullscreenPass
from andon.gpu.textures import make_texture
from andon.harmonics import irradiance
from andon.transport.probes.light import probe_coefficients, probe_illuminance
from andon.transport.probes.stage import ProbeBuffers
from andon.verify.rows.probe_light import doorway_error, leaks_in
from comparison import assert_agree

from .volumes import POSITIONS, light_of, random_volume, unit_vectors, volume_at

WIDTH = 64


# ── physics ─────────────────────────────────────────────────────────────────────────────────────


def test_an_even_light_is_pi_times_its_luminance():
    coefficients = np.zeros((64, 9, 3))
    coefficients[:, 0] = np.sqrt(4 * np.pi) * np.array([10.0, 20, 30])
    light = light_of(volume_at(POSITIONS["lattice"], coefficients))
    points = np.random.default_rng(0).uniform(-3, 6, (100, 3))
    lux = probe_illuminance(light, points, unit_vectors(100))
    assert_agree(lux, np.tile(np.pi * np.array([10.0, 20, 30]), (100, 1)), rtol=1e-12)


def test_a_linear_field_is_met_inside():
    positions = POSITIONS["random"]
    coefficients = np.zeros((len(positions), 9, 3))
    coefficients[:, 0] = 100 + positions @ np.diag([3.0, 5.0, 7.0])
    light = light_of(volume_at(positions, coefficients))
    points = positions[:40] * 0.5 + positions[20:] * 0.5
    lux = probe_illuminance(light, points, unit_vectors(40))
    expected = np.pi * (100 + points @ np.diag([3.0, 5, 7])) / np.sqrt(4 * np.pi)
    assert_agree(lux, expected, rtol=1e-9)


def test_light_is_never_negative_and_nan_stays_nan():
    coefficients = np.zeros((64, 9, 3))
    coefficients[:, 0], coefficients[:, 3] = 1.0, 5.0
    light = light_of(volume_at(POSITIONS["lattice"], coefficients))
    normals = np.array([[1.0, 0, 0], [-1, 0, 0], [0, 1, 0]])
    points = np.array([[1.0, 1, 1], [1, 1, 1], [np.nan, 0, 0]])
    lux = probe_illuminance(light, points, normals)
    assert lux[0].min() > 1
    assert (lux[1] == 0).all()
    assert np.isnan(lux[2]).all()


def test_normals_have_any_length_and_shapes_are_checked():
    light = light_of(random_volume(POSITIONS["lattice"]), walls=False)
    points, normals = np.random.default_rng(1).uniform(0, 4, (20, 3)), unit_vectors(20)
    lux = probe_illuminance(light, points, normals)
    longer = np.linspace(0.1, 30, 20)[:, None] * normals
    assert_agree(probe_illuminance(light, points, longer), lux, rtol=1e-9)
    assert np.isnan(probe_illuminance(light, points[:1], np.zeros((1, 3)))).all()
    for wrong in ((points[0], normals), (points, normals[0]), (points, normals[:3])):
        with pytest.raises(InputError, match=r"\(q, 3\)|as many as points"):
            probe_illuminance(light, *wrong)


@pytest.mark.parametrize("name", POSITIONS)
def test_per_object_is_per_pixel_at_one_point(name):
    light = light_of(random_volume(POSITIONS[name]), walls=False)
    points = np.random.default_rng(1).uniform(0, 4, (20, 3))
    normals = unit_vectors(20)
    by_object = np.maximum(irradiance(probe_coefficients(light, points), normals), 0)
    assert_agree(probe_illuminance(light, points, normals), by_object, rtol=1e-9)


@pytest.mark.parametrize("towards_wall", [False, True])
def test_walls_keep_light_in_its_room(towards_wall):
    """One of the scenes of `andon verify probes.leaks`: a wall as thin as paper."""
    leaked, error = leaks_in("ours", 0.0, 0, towards_wall)
    through, _ = leaks_in("off", 0.0, 0, towards_wall)
    assert leaked < 2 < through
    assert error < 110


def test_light_of_a_doorway_stays_off_the_back_of_its_wall():
    """Probes of the lit room see through the opening what lies beside it; rays give the truth."""
    assert doorway_error(True, True) < 120
    assert doorway_error(False, True) > 1000
    assert doorway_error(True, False) < 0.5 * doorway_error(False, False)


# ── parity ──────────────────────────────────────────────────────────────────────────────────────


class Shader:
    """`probe_lux` of the shaders, at rows of points and normals."""

    def __init__(self, gpu, light, count):
        self.gpu, self.height = gpu, -(-count // WIDTH)
        buffers = ProbeBuffers(gpu, light)
        self.inputs = make_texture(gpu, "rgba32float", WIDTH, self.height, layers=2)
        self.target = make_texture(gpu, "rgba32float", WIDTH, self.height)
        text = """//!import andon/gpu/octahedral.wgsl
//!import andon/transport/probes/walls_none.wgsl
@group(0) @binding(0) var rows: texture_2d_array<f32>;
@fragment fn call(@builtin(position) place: vec4f) -> @location(0) vec4f {
  let at = vec2i(place.xy);
  let lux = probe_lux(textureLoad(rows, at, 0, 0).xyz, textureLoad(rows, at, 1, 0).xyz);
  return vec4f(lux, 1.0);
}
"""
        group = bind_group(gpu, {0: ("float array", self.inputs.view)} | buffers.resources)
        variants = buffers.variants | {"harness": text}
        self.call = FullscreenPass(
            gpu, "harness", "call", ["rgba32float"], [group], variants=variants
        )

    def __call__(self, points, normals):
        for layer, column in enumerate((points, normals)):
            data = np.zeros((self.height * WIDTH, 4), np.float32)
            data[: len(column), :3] = column
            self.inputs.write(data, layer)
        encoder = self.gpu.device.create_command_encoder()
        self.call.encode(encoder, [self.target.view])
        self.gpu.device.queue.submit([encoder.finish()])
        return self.target.read().reshape(-1, 4)[: len(points), :3]


def agree(gpu, light, points, seed=5):
    normals = unit_vectors(len(points), seed)
    # As the shader has them: a neighbour in float64 may lie in another cell.
    points = points.astype(np.float32).astype(np.float64)
    expected = probe_illuminance(light, points, normals)
    actual = Shader(gpu, light, len(points))(points, normals)
    assert np.isfinite(actual).all()
    floor = 0.02 * np.median(expected.max(axis=1))
    error = np.abs(actual - expected).max(axis=1) / np.maximum(expected.max(axis=1), floor)
    assert error.max() < 1e-3, points[error.argmax()]
    assert expected.std() > 1


@pytest.mark.parametrize("walls", [False, True], ids=["open", "walls"])
@pytest.mark.parametrize("name", POSITIONS)
def test_shaders_agree(gpu, name, walls):
    points = np.random.default_rng(4).uniform(-2, 6, (4000, 3))
    agree(gpu, light_of(random_volume(POSITIONS[name]), walls=walls), points)


@pytest.mark.parametrize("order", [0, 1, 3, 4])
def test_shaders_agree_in_every_order(gpu, order):
    points = np.random.default_rng(4).uniform(-1, 5, (1000, 3))
    agree(gpu, light_of(random_volume(POSITIONS["lattice"], order)), points)


@pytest.mark.parametrize("walls", [False, True], ids=["open", "walls"])
def test_shaders_agree_at_nodes_and_faces(gpu, walls):
    """Where several cells meet, any of them will do."""
    light = light_of(random_volume(POSITIONS["lattice"]), walls=walls)
    halves = np.random.default_rng(1).integers(-2, 9, (2000, 3)) / 2
    agree(gpu, light, halves)


def test_shaders_agree_in_zones(gpu):
    positions = POSITIONS["random"]
    left = positions[:, 0] < 2
    zones = (
        Zone(
            "left", np.flatnonzero(left).astype(np.int32), np.array([[[-9, -9, -9], [2, 9, 9.0]]])
        ),
        Zone(
            "right", np.flatnonzero(~left).astype(np.int32), np.array([[[2, -1, -1], [5, 5, 5.0]]])
        ),
    )
    light = light_of(random_volume(positions, zones=zones))
    points = np.random.default_rng(6).uniform(-2, 6, (3000, 3))
    points = points[np.abs(points[:, 0] - 2) > 1e-4]
    agree(gpu, light, points)


def test_many_probes_fill_several_rows(gpu):
    """More numbers than one row of their picture holds."""
    positions = np.random.default_rng(9).uniform(0, 4, (1500, 3))
    light = light_of(random_volume(positions))
    agree(gpu, light, np.random.default_rng(4).uniform(0.5, 3.5, (2000, 3)))
