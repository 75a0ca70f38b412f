"""examples/basic: the room, its probes, and who walks in it."""

import json
import struct
from pathlib import Path

import numpy as np
import pytest

from andon.files.meshes import read_mesh
from andon.quantities import photometric
from andon.scene import load_scene
from andon.surface.still import still_geometry
from andon.transport.probes.placement import place_probes
from andon.transport.probes.placement.walls import winding_faults

FOLDER = Path(__file__).parents[1] / "examples" / "basic"


def test_the_room_is_closed_and_its_colours_are_possible():
    geometry = read_mesh(FOLDER / "room.glb").geometry
    assert winding_faults(geometry) == (0, 0)
    low, high = geometry.positions.min(axis=0), geometry.positions.max(axis=0)
    np.testing.assert_allclose([low, high], [[-4.2, -0.2, -4.2], [4.2, 3, 4]], atol=1e-6)
    for material in geometry.materials:
        assert min(material.reflectance) >= 0.05
        assert max(material.reflectance) <= 0.75
        assert not material.two_sided
    colours = {material.name: np.array(material.reflectance) for material in geometry.materials}
    for channel, name in enumerate(("red", "green", "blue")):
        assert colours[name].argmax() == channel
        assert colours[name].max() > 3 * np.sort(colours[name])[1]
        assert photometric(colours[name]) < photometric(colours["white"])


@pytest.mark.parametrize(
    ("name", "count", "roles"),
    [
        ("basic.toml", 13, {"sky": 3, "bounce": 5, "bleeding": 5}),
        ("walk.toml", 13, {"sky": 3, "bounce": 5, "bleeding": 5}),
        ("basic-lattice.toml", 64, {"general": 64}),
    ],
)
def test_probes_are_as_many_as_in_the_paper_and_in_free_space(name, count, roles):
    scene = load_scene(FOLDER / name)
    placed = place_probes(scene, still_geometry(scene))
    assert placed.count == count
    assert {role: placed.roles.count(role) for role in placed.roles} == roles
    assert placed.warnings == ()


def test_the_walker_stays_among_the_probes():
    scene = load_scene(FOLDER / "walk.toml")
    placed = place_probes(scene, still_geometry(scene))
    keys = scene.object[0].key
    assert keys[-1].time_seconds == scene.scene.duration_seconds
    path = np.array([key.position for key in keys])
    assert (path[:, [0, 2]] >= placed.positions[:, [0, 2]].min(axis=0) + 0.5).all()
    assert (path[:, [0, 2]] <= placed.positions[:, [0, 2]].max(axis=0) - 0.5).all()
    turns = np.array([key.rotation_xyzw for key in keys])
    heading = np.stack(
        [2 * turns[:, 1] * turns[:, 3], 1 - 2 * turns[:, 1] ** 2], axis=1
    )  # +Z turned around +Y: x and z
    steps = np.gradient(path[:, [0, 2]], axis=0)
    steps /= np.linalg.norm(steps, axis=1, keepdims=True)
    assert (np.einsum("ij,ij->i", heading, steps)[1:-1] > 0.99).all(), "it faces its way"


@pytest.fixture(scope="module")
def walker():
    """The JSON of walker.glb, and a function that reads an accessor."""
    data = (FOLDER / "walker.glb").read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    document = json.loads(data[20 : 20 + length])
    binary = data[28 + length :]
    sizes = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}
    types = {5126: "<f4", 5123: "<u2", 5121: "u1"}

    def read(number):
        entry = document["accessors"][number]
        view = document["bufferViews"][entry["bufferView"]]
        count = entry["count"] * sizes[entry["type"]]
        values = np.frombuffer(binary, types[entry["componentType"]], count, view["byteOffset"])
        return values.reshape(entry["count"], -1).astype(float)

    return document, read


def test_the_walker_stands_on_the_floor():
    geometry = read_mesh(FOLDER / "walker.glb").geometry
    assert 2000 <= len(geometry.triangles) <= 4000
    assert geometry.positions[:, 1].min() == pytest.approx(0, abs=1e-6)
    assert geometry.positions[:, 1].max() == pytest.approx(1.75, abs=0.01)
    assert winding_faults(geometry) == (0, 0)
    toes = geometry.positions[geometry.positions[:, 1] < 0.03]
    assert toes[:, 2].max() > 0.15 > -toes[:, 2].min(), "its toes point towards +Z"
    outside = geometry.positions - [0, 1.2, 0]
    chest = np.abs(outside[:, 1]) < 0.1
    torso = chest & (np.abs(outside[:, 0]) < 0.1)
    assert (np.einsum("ij,ij->i", geometry.normals[torso], outside[torso]) > 0).all()


def test_the_walkers_skin_is_bound(walker):
    document, read = walker
    attributes = document["meshes"][0]["primitives"][0]["attributes"]
    weights, joints = read(attributes["WEIGHTS_0"]), read(attributes["JOINTS_0"])
    np.testing.assert_allclose(weights.sum(axis=1), 1, atol=1e-6)
    count = len(document["skins"][0]["joints"])
    assert joints.max() == count - 1
    assert ((weights > 0).sum(axis=1) <= 2).all()
    assert ((weights > 0.05) & (weights < 0.95)).any(axis=1).sum() > 100, "joints are blended"
    assert (joints[weights == 0] == 0).all(), "glTF 2.0, 3.7.3.3: joints without weight are 0"
    inverse = read(document["skins"][0]["inverseBindMatrices"]).reshape(-1, 4, 4)
    assert inverse.shape[0] == count
    np.testing.assert_array_equal(inverse[:, :, 3], [[0, 0, 0, 1]] * count)


def test_the_walk_comes_back_to_where_it_began(walker):
    document, read = walker
    (walk,) = document["animations"]
    assert walk["name"] == "walk"
    for channel in walk["channels"]:
        sampler = walk["samplers"][channel["sampler"]]
        times, values = read(sampler["input"])[:, 0], read(sampler["output"])
        assert (times[0], times[-1]) == (0, 1)
        assert (np.diff(times) > 0).all()
        np.testing.assert_allclose(values[0], values[-1], atol=1e-6)
        if channel["target"]["path"] == "rotation":
            np.testing.assert_allclose(np.linalg.norm(values, axis=1), 1, atol=1e-6)
            assert (np.einsum("ij,ij->i", values[1:], values[:-1]) > 0.9).all(), "the short way"
