"""glTF 2.0: arrays, transforms, materials, lights, and what is refused."""

from __future__ import annotations

import base64
import copy
import json
import math
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from andon.errors import InputError
from andon.files import MeshFile, read_mesh
from andon.responses import srgb_decode
from andon.spaces import rotate, transform_points

from .specimens import GLTF_BINARY, QUAD, QUAD_UV, glb, gltf_json, pillow_bytes, rgb


def read(folder: Path, document: dict[str, Any], binary: bytes = GLTF_BINARY) -> MeshFile:
    path = folder / "a.glb"
    document = copy.deepcopy(document)
    document["buffers"][0].pop("uri", None)
    document["buffers"][0]["byteLength"] = len(binary)
    path.write_bytes(glb(document, binary))
    return read_mesh(path)


def corner_points(mesh: MeshFile) -> np.ndarray:
    return mesh.geometry.positions[mesh.geometry.triangles]


EXPECTED = np.add(QUAD, [0, 0, -1])[[[0, 1, 2], [0, 2, 3]]]


@pytest.mark.parametrize("form", ["glb", "external", "data", "encoded name"])
def test_every_kind_of_buffer_gives_the_same_quad(form: str, tmp_path: Path) -> None:
    path = tmp_path / "a.gltf"
    if form == "glb":
        path = tmp_path / "a.glb"
        path.write_bytes(glb(gltf_json(None), GLTF_BINARY))
    elif form == "data":
        uri = "data:application/octet-stream;base64," + base64.b64encode(GLTF_BINARY).decode()
        path.write_text(json.dumps(gltf_json(uri)))
    else:
        name = "q.bin" if form == "external" else "q 1.bin"
        (tmp_path / name).write_bytes(GLTF_BINARY)
        path.write_text(json.dumps(gltf_json(name.replace(" ", "%20"))))
    mesh = read_mesh(path)
    np.testing.assert_array_equal(corner_points(mesh), EXPECTED)
    np.testing.assert_array_equal(mesh.geometry.uvs, QUAD_UV)
    assert mesh.geometry.normals is None
    assert mesh.names == ("quad", "lamp")


def test_material_values_and_emission_in_nits(tmp_path: Path) -> None:
    document: Any = gltf_json()
    material = document["materials"][0]
    material["pbrMetallicRoughness"] |= {"metallicFactor": 0.25, "roughnessFactor": 0.75}
    material["doubleSided"] = True
    material["alphaMode"] = "BLEND"
    material["extensions"]["KHR_materials_transmission"] = {"transmissionFactor": 0.5}
    read_material = read(tmp_path, document).geometry.materials[0]
    assert read_material.reflectance == (0.2, 0.4, 0.6)
    assert read_material.emissive_cd_m2 == (100.0, 50.0, 0.0)
    assert (read_material.metallic, read_material.roughness) == (0.25, 0.75)
    assert read_material.two_sided
    assert read_material.extensions["KHR_materials_transmission"] == {"transmissionFactor": 0.5}
    assert read_material.extensions["alpha"] == {"mode": "BLEND", "factor": 1.0}
    del document["meshes"][0]["primitives"][0]["material"]
    default = read(tmp_path, document).geometry.materials[0]
    assert (default.reflectance, default.metallic, default.two_sided) == ((1, 1, 1), 1.0, False)


def textured(image: dict[str, Any]) -> dict[str, Any]:
    document: Any = gltf_json()
    document["images"], document["textures"] = [image], [{"source": 0}]
    document["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
    return document


def test_textures_embedded_external_and_as_data(tmp_path: Path) -> None:
    texture = rgb().astype(np.uint8)
    data = pillow_bytes(texture, "PNG")
    (tmp_path / "t 1.png").write_bytes(data)
    uri = "data:image/png;base64," + base64.b64encode(data).decode()
    for image in ({"uri": "t%201.png"}, {"uri": uri}):
        read_texture = read(tmp_path, textured(image)).geometry.materials[0].texture
        np.testing.assert_array_equal(read_texture, texture)
    document = textured({"bufferView": 3, "mimeType": "image/png"})
    view = {"buffer": 0, "byteOffset": len(GLTF_BINARY), "byteLength": len(data)}
    document["bufferViews"].append(view)
    embedded = read(tmp_path, document, GLTF_BINARY + data).geometry.materials[0]
    np.testing.assert_array_equal(embedded.texture, texture)


def test_emission_with_a_texture_is_its_mean(tmp_path: Path) -> None:
    texture = rgb().astype(np.uint8)
    (tmp_path / "t.png").write_bytes(pillow_bytes(texture, "PNG"))
    document = textured({"uri": "t.png"})
    document["materials"][0]["emissiveTexture"] = {"index": 0}
    emitted = read(tmp_path, document).geometry.materials[0].emissive_cd_m2
    mean = srgb_decode(texture / 255).mean(axis=(0, 1))
    np.testing.assert_allclose(emitted, mean * [100, 50, 0], rtol=1e-12)


def test_texture_transform_and_second_coordinates(tmp_path: Path) -> None:
    (tmp_path / "t.png").write_bytes(pillow_bytes(rgb().astype(np.uint8), "PNG"))
    document = textured({"uri": "t.png"})
    info = document["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]
    info["extensions"] = {
        "KHR_texture_transform": {"offset": [0.5, 0.25], "rotation": math.pi / 2, "scale": [2, 3]}
    }
    uvs = read(tmp_path, document).geometry.uvs
    # Scaled (2u, 3v), turned by 90° to (3v, −2u), moved.
    np.testing.assert_allclose(
        uvs, np.stack([3 * QUAD_UV[:, 1] + 0.5, 0.25 - 2 * QUAD_UV[:, 0]], -1), atol=1e-12
    )
    info["texCoord"] = 1
    assert read(tmp_path, document).geometry.uvs is None  # the set is not there
    document["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = 1
    assert read(tmp_path, document).geometry.uvs is not None


def with_node(**node: Any) -> dict[str, Any]:
    document: Any = gltf_json()
    document["scenes"] = [{"nodes": [0]}]
    document["nodes"] = [{"mesh": 0, **node}]
    return document


def test_trs_and_matrix_are_the_same_transform(tmp_path: Path) -> None:
    half = math.sqrt(0.5)
    trs = with_node(translation=[1, 2, 3], rotation=[0, half, 0, half], scale=[1, 2, 3])
    # +90° about y: x → −z, z → x. Columns of R·S, then the translation.
    matrix = with_node(matrix=[0, 0, -1, 0, 0, 2, 0, 0, 3, 0, 0, 0, 1, 2, 3, 1])
    expected = QUAD * [1, 2, 3]
    expected = np.stack([expected[:, 2] + 1, expected[:, 1] + 2, 3 - expected[:, 0]], -1)
    for document in (trs, matrix):
        np.testing.assert_allclose(read(tmp_path, document).geometry.positions, expected, atol=1e-6)


def test_parents_carry_children_and_scenes_choose(tmp_path: Path) -> None:
    document: Any = gltf_json()
    document["nodes"] = [
        {"name": "root", "translation": [10, 0, 0], "children": [1, 2]},
        {"name": "a", "mesh": 0, "scale": [2, 2, 2]},
        {"name": "b", "mesh": 0, "translation": [0, 5, 0]},
        {"name": "other", "mesh": 0},
    ]
    document["scenes"] = [{"nodes": [3]}, {"nodes": [0]}]
    document["scene"] = 1
    mesh = read(tmp_path, document)
    assert mesh.names == ("root", "a", "b")
    both = np.concatenate([QUAD * 2 + [10, 0, 0], np.add(QUAD, [10, 5, 0])])
    np.testing.assert_array_equal(mesh.geometry.positions, both)
    del document["scene"]
    assert read(tmp_path, document).names == ("other",)
    del document["scenes"]
    assert read(tmp_path, document).names == ("root", "a", "b", "other")


def with_normals() -> tuple[dict[str, Any], bytes]:
    normals = np.tile(np.array([0, 0, 1], np.float32), (4, 1)).tobytes()
    document: Any = gltf_json()
    document["bufferViews"].append(
        {"buffer": 0, "byteOffset": len(GLTF_BINARY), "byteLength": len(normals)}
    )
    document["accessors"].append(
        {"bufferView": 3, "componentType": 5126, "count": 4, "type": "VEC3"}
    )
    document["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = 3
    return document, GLTF_BINARY + normals


@pytest.mark.parametrize("scale", [[1, 1, 1], [2, 1, 5], [-1, 1, 1], [1, -2, -3], [-1, -1, -4]])
def test_normals_stay_perpendicular_and_fronts_stay_in_front(
    scale: list[float], tmp_path: Path
) -> None:
    document, binary = with_normals()
    turn = np.array([0.1, 0.3, -0.2, 0.9])
    node = {"scale": scale, "rotation": (turn / np.linalg.norm(turn)).tolist()}
    document["nodes"][0] |= node
    geometry = read(tmp_path, document, binary).geometry
    a, b, c = (geometry.positions[geometry.triangles[:, i]] for i in range(3))
    facets = np.cross(b - a, c - a)
    facets /= np.linalg.norm(facets, axis=-1, keepdims=True)
    assert geometry.normals is not None
    np.testing.assert_allclose(geometry.normals[geometry.triangles[:, 0]], facets, atol=1e-6)


def test_primitives_without_normals_get_flat_ones_beside_others(tmp_path: Path) -> None:
    document, binary = with_normals()
    primitive = copy.deepcopy(document["meshes"][0]["primitives"][0])
    del primitive["attributes"]["NORMAL"]
    document["meshes"][0]["primitives"].append(primitive)
    geometry = read(tmp_path, document, binary).geometry
    assert len(geometry.positions) == 4 + 6
    assert geometry.normals is not None
    np.testing.assert_allclose(geometry.normals, np.tile([0, 0, 1], (10, 1)), atol=1e-12)


@pytest.mark.parametrize(
    ("mode", "indices", "expected"),
    [
        (4, [0, 1, 2, 0, 2, 3], [[0, 1, 2], [0, 2, 3]]),
        (5, [0, 1, 3, 2], [[0, 1, 3], [1, 2, 3]]),  # the second is turned round
        (6, [0, 1, 2, 3], [[0, 1, 2], [0, 2, 3]]),
    ],
)
@pytest.mark.parametrize("kind", [5121, 5123, 5125])
def test_triangles_strips_and_fans(
    mode: int, indices: list[int], expected: list[list[int]], kind: int, tmp_path: Path
) -> None:
    code = {5121: "B", 5123: "H", 5125: "I"}[kind]
    body = struct.pack(f"<{len(indices)}{code}", *indices)
    document: Any = gltf_json()
    document["bufferViews"][2] = {"buffer": 0, "byteOffset": 80, "byteLength": len(body)}
    document["accessors"][2] |= {"componentType": kind, "count": len(indices)}
    document["meshes"][0]["primitives"][0]["mode"] = mode
    mesh = read(tmp_path, document, GLTF_BINARY[:80] + body)
    points = np.add(QUAD, [0, 0, -1])[np.array(expected)]
    read_points = corner_points(mesh)
    for one, other in zip(read_points, points, strict=True):
        turns = [np.roll(other, k, axis=0) for k in range(3)]
        assert any(np.array_equal(one, turn) for turn in turns)  # same triangle, same side


def test_without_indices_every_three_vertices_are_a_triangle(tmp_path: Path) -> None:
    document: Any = gltf_json()
    del document["meshes"][0]["primitives"][0]["indices"]
    document["accessors"][0]["count"] = document["accessors"][1]["count"] = 3
    mesh = read(tmp_path, document)
    np.testing.assert_array_equal(corner_points(mesh), EXPECTED[:1])


def test_interleaved_and_normalised_attributes(tmp_path: Path) -> None:
    quantised = np.array([[0, 0, 0], [32767, 0, 0], [32767, -32768, 0], [0, 32767, 0]], "<i2")
    uvs = np.array([[0, 255], [255, 255], [255, 0], [0, 51]], np.uint8)
    rows = b"".join(
        p.tobytes() + b"\0\0" + t.tobytes() + b"\0\0" for p, t in zip(quantised, uvs, strict=True)
    )
    document: Any = gltf_json()
    document["extensionsRequired"] = ["KHR_mesh_quantization"]
    document["bufferViews"] = [
        {"buffer": 0, "byteLength": 48, "byteStride": 12},
        {"buffer": 0, "byteOffset": 48, "byteLength": 6},
    ]
    document["accessors"] = [
        {"bufferView": 0, "componentType": 5122, "normalized": True, "count": 4, "type": "VEC3"},
        {"bufferView": 0, "byteOffset": 8, "componentType": 5121, "normalized": True, "count": 4,
         "type": "VEC2"},
        {"bufferView": 1, "componentType": 5121, "count": 6, "type": "SCALAR"},
    ]  # fmt: skip
    geometry = read(tmp_path, document, rows + GLTF_BINARY[80:]).geometry
    np.testing.assert_array_equal(
        geometry.positions, [[0, 0, -1], [1, 0, -1], [1, -1, -1], [0, 1, -1]]
    )
    np.testing.assert_allclose(geometry.uvs, [[0, 1], [1, 1], [1, 0], [0, 0.2]])


@pytest.mark.parametrize("base", [True, False])
def test_sparse_accessors(base: bool, tmp_path: Path) -> None:
    extra = struct.pack("<HH3f3f", 1, 3, 9, 9, 9, 7, 7, 7)
    document: Any = gltf_json()
    at = len(GLTF_BINARY)
    document["bufferViews"] += [
        {"buffer": 0, "byteOffset": at, "byteLength": 4},
        {"buffer": 0, "byteOffset": at + 4, "byteLength": 24},
    ]
    accessor = document["accessors"][0]
    accessor["sparse"] = {
        "count": 2,
        "indices": {"bufferView": 3, "componentType": 5123},
        "values": {"bufferView": 4},
    }
    if not base:
        del accessor["bufferView"]
    expected = QUAD.copy() if base else np.zeros_like(QUAD)
    expected[[1, 3]] = [[9, 9, 9], [7, 7, 7]]
    geometry = read(tmp_path, document, GLTF_BINARY + extra).geometry
    np.testing.assert_array_equal(geometry.positions, np.add(expected, [0, 0, -1]))


def test_lights_are_placed(tmp_path: Path) -> None:
    document: Any = gltf_json()
    document["extensions"]["KHR_lights_punctual"]["lights"] = [
        {"type": "spot", "name": "beam", "intensity": 60, "color": [1, 0.5, 0], "range": 4,
         "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.5}},
        {"type": "point"},
        {"type": "directional", "intensity": 1000},
    ]  # fmt: skip
    half = math.sqrt(0.5)
    document["scenes"][0]["nodes"] = [0, 1, 2, 3]
    document["nodes"] = [
        {"mesh": 0},
        {"name": "n", "translation": [1, 2, 3], "rotation": [-half, 0, 0, half],
         "extensions": {"KHR_lights_punctual": {"light": 0}}},
        {"name": "bulb", "extensions": {"KHR_lights_punctual": {"light": 1}}},
        {"name": "sun", "extensions": {"KHR_lights_punctual": {"light": 2}}},
    ]  # fmt: skip
    beam, bulb, sun = read(tmp_path, document).lights
    assert (beam.name, beam.kind, beam.intensity, beam.colour) == ("beam", "spot", 60, (1, 0.5, 0))
    assert (beam.range, beam.inner_radians, beam.outer_radians) == (4.0, 0.1, 0.5)
    np.testing.assert_allclose(transform_points(beam.world_from_light, np.zeros(3)), [1, 2, 3])
    # −90° about x turns −z, along which it shines, to −y: straight down.
    down = rotate(beam.world_from_light, np.array([0.0, 0, -1]))
    np.testing.assert_allclose(down, [0, -1, 0], atol=1e-12)
    assert (bulb.name, bulb.kind, bulb.intensity, bulb.range) == ("bulb", "point", 1.0, None)
    assert (sun.kind, sun.intensity) == ("directional", 1000.0)


def test_skins_put_the_mesh_where_its_joints_are(tmp_path: Path) -> None:
    """Two joints: the left vertices stay, the right ones move with the second joint."""
    joints = bytes([0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0])
    weights = np.tile(np.array([2, 0, 0, 0], np.float32), (4, 1)).tobytes()  # need not add to 1
    bind = np.stack([np.eye(4), np.eye(4)])
    bind[1, :3, 3] = [-2, 0, 0]
    stored = bind.swapaxes(1, 2).astype(np.float32).tobytes()
    document: Any = gltf_json()
    at = len(GLTF_BINARY)
    for size in (len(joints), len(weights), len(stored)):
        document["bufferViews"].append({"buffer": 0, "byteOffset": at, "byteLength": size})
        at += size
    document["accessors"] += [
        {"bufferView": 3, "componentType": 5121, "count": 4, "type": "VEC4"},
        {"bufferView": 4, "componentType": 5126, "count": 4, "type": "VEC4"},
        {"bufferView": 5, "componentType": 5126, "count": 2, "type": "MAT4"},
    ]
    attributes = document["meshes"][0]["primitives"][0]["attributes"]
    attributes |= {"JOINTS_0": 3, "WEIGHTS_0": 4}
    document["skins"] = [{"joints": [1, 2], "inverseBindMatrices": 5}]
    document["scenes"] = [{"nodes": [0, 1]}]
    document["nodes"] = [
        {"mesh": 0, "skin": 0, "translation": [99, 99, 99]},  # ignored for a skinned mesh
        {"children": [2]},
        {"translation": [2, 0, 3]},
    ]
    mesh = read(tmp_path, document, GLTF_BINARY + joints + weights + stored)
    assert mesh.at_rest == ("skin",)
    np.testing.assert_allclose(
        mesh.geometry.positions, np.add(QUAD, [[0, 0, 0], [0, 0, 3], [0, 0, 3], [0, 0, 0]])
    )


def test_what_would_move_is_told(tmp_path: Path) -> None:
    """Of what is drawn: the skin of a node without a mesh moves nothing."""
    document: Any = gltf_json()
    assert read(tmp_path, document).at_rest == ()
    document["animations"] = [{"channels": [], "samplers": []}]
    assert read(tmp_path, document).at_rest == ("animation",)
    document["meshes"][0]["primitives"][0]["targets"] = [{"POSITION": 0}]
    assert read(tmp_path, document).at_rest == ("animation", "morph targets")


def change(document: dict[str, Any], path: str, value: Any) -> None:
    *parents, last = path.split(".")
    at: Any = document
    for key in parents:
        at = at[int(key)] if key.isdigit() else at[key]
    at[int(last) if last.isdigit() else last] = value


DRACO = "KHR_draco_mesh_compression"


@pytest.mark.parametrize(
    ("path", "value", "match"),
    [
        ("asset.version", "1.0", "must be glTF 2"),
        ("asset", {}, "asset: must have 'version'"),
        ("extensionsRequired", [DRACO], f"requires the extension '{DRACO}'"),
        ("extensionsRequired", ["EXT_meshopt_compression"], "export it without compression"),
        ("accessors.0.count", 5, "within its view"),
        ("accessors.0.count", -1, "must be 1"),
        ("accessors.0.count", 10**12, "must be 1"),
        ("accessors.0.count", True, "whole number"),
        ("accessors.0.componentType", 5130, "componentType"),
        ("accessors.0.type", "VEC2", "must be VEC3"),
        ("accessors.0.byteOffset", 1, "within its view"),
        ("accessors.0.bufferView", 9, "must be 0…2"),
        ("accessors.1.count", 3, "4 elements like POSITION"),
        ("accessors.2.componentType", 5120, "unsigned"),
        ("accessors.2.count", 5, "multiple of 3"),
        ("bufferViews.0.byteLength", 10**9, "within its buffer"),
        ("bufferViews.0.byteStride", 4, "byteStride of 12 or more"),
        ("nodes.0.children", [0], "one parent"),
        ("nodes.0.children", [1], "one parent"),
        ("nodes.0.children", [7], "must be 0…1"),
        ("nodes.0.rotation", [0, 0, 0, 0], "unit quaternion"),
        ("nodes.0.matrix", [1] * 15, "16 numbers"),
        ("nodes.0.scale", [1, "x", 1], r"nodes\[0\].scale\[1\]: must be a number"),
        ("nodes.0.mesh", 3, "must be 0…0"),
        ("nodes.0.name", 7, "must be text"),
        ("nodes.0.skin", 0, "refers to skins, of which there are none"),
        ("scene", 4, "must be 0…0"),
        ("meshes", [], "refers to meshes"),
        ("meshes.0.primitives", {}, "must be a list"),
        ("meshes.0.primitives.0.mode", 9, "must be 0…6"),
        ("meshes.0.primitives.0.mode", 1, "must have faces"),
        ("meshes.0.primitives.0.attributes", {}, "must have 'POSITION'"),
        ("meshes.0.primitives.0.material", 8, "must be 0…0"),
        ("materials.0.emissiveFactor", [1, 2, 3], "numbers in 0…1"),
        ("materials.0.emissiveTexture", {"index": 0}, "refers to textures"),
        ("extensions.KHR_lights_punctual.lights.0.type", "laser", "type of point"),
        ("extensions.KHR_lights_punctual.lights.0.intensity", -1, "finite number in 0"),
        ("extensions.KHR_lights_punctual.lights.0.spot", {"innerConeAngle": 1.5}, "innerConeAngle"),
        ("extensions", {}, "must have 'KHR_lights_punctual'"),
    ],
)
def test_broken_documents_are_refused(path: str, value: Any, match: str, tmp_path: Path) -> None:
    document = gltf_json()
    change(document, path, value)
    with pytest.raises(InputError, match=match):
        read(tmp_path, document)


def test_bad_numbers_in_the_arrays_are_refused(tmp_path: Path) -> None:
    for body, match in (
        (np.float32(np.nan).tobytes() + GLTF_BINARY[4:], "positions must be finite"),
        (GLTF_BINARY[:-1] + b"\x04", "vertex indices must be 0…3, one is 4"),
        (GLTF_BINARY[:48] + np.float32(np.inf).tobytes() + GLTF_BINARY[52:], "must be finite"),
    ):
        with pytest.raises(InputError, match=match):
            read(tmp_path, gltf_json(), body)


def test_textures_in_unread_formats_say_so(tmp_path: Path) -> None:
    document = textured({"uri": "t.ktx2"})
    document["textures"] = [{"extensions": {"KHR_texture_basisu": {"source": 0}}}]
    with pytest.raises(InputError, match="PNG or JPEG source, has only KHR_texture_basisu"):
        read(tmp_path, document)


def test_instances_count_against_the_limits(tmp_path: Path) -> None:
    document: Any = gltf_json()
    document["nodes"] = [{"mesh": 0} for _ in range(50)]
    document["scenes"] = [{"nodes": list(range(50))}]
    from dataclasses import replace

    from andon.files import DEFAULT_LIMITS

    assert len(read(tmp_path, document).geometry.triangles) == 100
    with pytest.raises(InputError, match="at most 99 triangles"):
        read_mesh(tmp_path / "a.glb", limits=replace(DEFAULT_LIMITS, max_triangles=99))


@pytest.mark.parametrize(
    ("data", "match"),
    [
        (b"{}", "must have 'asset'"),
        (b"[]", "must be a table"),
        (b'{"asset": {"version": "2.0"}, "x": NaN}', "NaN is no JSON number"),
        (b'{"asset": {"version": "2.0"}}', "must have faces"),
        (b"\xff\xff", "sound glTF JSON"),
        (struct.pack("<4sII", b"glTF", 1, 20) + bytes(8), "GLB version 2"),
        (struct.pack("<4sII", b"glTF", 2, 999) + bytes(8), "cut short"),
        (struct.pack("<4sIII4s", b"glTF", 2, 20, 0, b"BIN\0"), "begin with a JSON chunk"),
        (struct.pack("<4sIII4s", b"glTF", 2, 20, 99, b"JSON"), "chunk beyond its end"),
    ],
)
def test_broken_containers_are_refused(data: bytes, match: str, tmp_path: Path) -> None:
    path = tmp_path / "a.gltf"
    path.write_bytes(data)
    with pytest.raises(InputError, match=match):
        read_mesh(path)


def test_real_gltf_files(data_dir: Path) -> None:
    folder = data_dir / "gltf_models"
    man = read_mesh(folder / "CesiumMan.glb").geometry
    size = np.ptp(man.positions, axis=0)
    assert size[1] == pytest.approx(1.5, abs=0.05)  # stands upright, in metres
    assert len(man.triangles) == 4672
    lamp = read_mesh(folder / "AnisotropyBarnLamp/AnisotropyBarnLamp.gltf")
    assert lamp.names == ("Lamp Metal", "Lamp Filament", "Lamp Glass")
    emitted = [m.emissive_cd_m2 for m in lamp.geometry.materials if max(m.emissive_cd_m2)]
    assert emitted == [(25.0, 12.5, 6.25)]
    assert "KHR_materials_anisotropy" in lamp.geometry.materials[0].extensions
    box = read_mesh(folder / "CornellBox_bevy.glb").geometry
    assert box.materials[0].emissive_cd_m2 == (100.0, 100.0, 100.0)
    glass = read_mesh(folder / "AttenuationTest.glb").geometry
    assert any("KHR_materials_volume" in m.extensions for m in glass.materials)
