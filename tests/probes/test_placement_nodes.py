"""Locators of a modelling program: names, roles, transforms, captures."""

import json

import numpy as np
import pytest

from andon.errors import InputError
from andon.files.meshes.gltf import GltfNode, read_gltf_nodes, write_gltf_nodes
from andon.quantities import Geometry
from andon.scene import scene_from_dict
from andon.transport.probes.placement import locators, place_probes
from andon.transport.probes.placement.nodes import role_of

NOTHING = Geometry(np.zeros((0, 3)), np.zeros((0, 3), np.int32))


def write(folder, nodes, roots=None):
    document = {
        "asset": {"version": "2.0"},
        "nodes": nodes,
        "scenes": [{"nodes": list(range(len(nodes))) if roots is None else roots}],
    }
    (folder / "n.gltf").write_text(json.dumps(document))


def placed(folder, **more):
    placement = {"kind": "nodes", "file": "n.gltf", **more}
    tables = {"probes": {"volume": "v.glb", "placement": placement}}
    return place_probes(scene_from_dict(tables, folder=folder), NOTHING)


@pytest.mark.parametrize(
    ("name", "role"),
    [
        ("probe_sky.001", "sky"), ("Probe-Bounce", "bounce"), ("probe bleeding red", "bleeding"),
        ("probe", None), ("probe_7", None), ("probesky", "sky"), ("probe_door_sky", None),
    ],
)  # fmt: skip
def test_names_say_roles(name, role):
    assert role_of(name) == role


def test_nodes_become_probes(tmp_path):
    write(
        tmp_path,
        [
            {"name": "probe_sky", "translation": [0, 4, 0]},
            {"name": "lamp", "translation": [9, 9, 9]},
            {"name": "Probe.002", "translation": [1, 1, 1], "children": [3]},
            {"name": "capture", "translation": [0, 0.5, 0]},
        ],
        roots=[0, 1, 2],
    )
    found = placed(tmp_path, role="bounce", range_m=3.0)
    assert found.names == ("probe_sky", "Probe.002")
    assert found.roles == ("sky", "bounce")
    np.testing.assert_allclose(found.positions, [[0, 4, 0], [1, 1, 1]])
    np.testing.assert_allclose(found.capture_positions, [[0, 4, 0], [1, 1.5, 1]])
    np.testing.assert_array_equal(found.ranges_m, [3, 3])


def test_transforms_of_parents_apply_and_groups_are_no_probes(tmp_path):
    half = np.sqrt(0.5)
    write(
        tmp_path,
        [
            {
                "name": "probes of the hall", "translation": [10, 0, 0], "scale": [2, 2, 2],
                "rotation": [0, half, 0, half], "children": [1],
            },
            {"name": "shelf", "children": [2]},
            {"name": "probe", "translation": [0, 1, 3]},
        ],
        roots=[0],
    )  # fmt: skip
    found = placed(tmp_path)
    assert found.names == ("probe",)
    # A quarter turn around +Y takes +Z to +X.
    np.testing.assert_allclose(found.positions, [[16, 2, 0]], atol=1e-12)


def test_none_named_probe(tmp_path):
    write(tmp_path, [{"name": "lamp"}])
    with pytest.raises(InputError, match="none of its 1 nodes has a name that begins"):
        placed(tmp_path)


@pytest.mark.parametrize("reference", ["../n.gltf", "/etc/n.gltf", "n.obj", "missing.glb"])
def test_files_at_fault(tmp_path, reference):
    (tmp_path / "n.obj").write_text("v 0 0 0")
    with pytest.raises(InputError):
        placed(tmp_path, file=reference)


def test_a_node_at_no_place_is_refused(tmp_path):
    write(
        tmp_path,
        [
            {"name": "a", "scale": [1e200] * 3, "children": [1]},
            {"name": "b", "scale": [1e200] * 3, "children": [2]},
            {"name": "probe", "translation": [1e200, 0, 0]},
        ],
        roots=[0],
    )
    with pytest.raises(InputError, match="finite place"):
        placed(tmp_path)


def test_written_nodes_are_read_again(tmp_path):
    first, second = np.eye(4), np.eye(4)
    first[:3, 3], second[:3, 3] = [1, 2, 3], [-1, 0.5, 0]
    nodes = [GltfNode("probe_ä", first), GltfNode("capture", second, 0), GltfNode("c", second)]
    again = read_gltf_nodes(write_gltf_nodes(tmp_path / "n.glb", nodes, generator="test"))
    assert [(n.name, n.parent) for n in again] == [("probe_ä", -1), ("capture", 0), ("c", -1)]
    for node, expected in zip(again, nodes, strict=True):
        np.testing.assert_allclose(node.world_from_node, expected.world_from_node, atol=1e-15)


def test_locators_come_back_as_the_same_probes(tmp_path):
    place = [
        {"name": "a", "position": [1, 2, 3], "role": "sky"},
        {"name": "b", "position": [0, 1, 0], "capture_position": [0, 1.5, 0]},
    ]
    first = place_probes(scene_from_dict({"probes": {"volume": "v.glb", "place": place}}), NOTHING)
    write_gltf_nodes(tmp_path / "n.glb", locators(first), generator="test")
    again = placed(tmp_path, file="n.glb")
    np.testing.assert_allclose(again.positions, first.positions)
    np.testing.assert_allclose(again.capture_positions, first.capture_positions)
    assert again.roles == first.roles
