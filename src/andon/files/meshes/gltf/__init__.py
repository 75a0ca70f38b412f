"""glTF 2.0 and GLB, static: triangles, materials and lights in the pose that the file shows.

An own reader, because the alternatives either follow ``../`` in strangers' files (pygltflib) or
drop lights and material extensions (trimesh). Animation and morph targets are left at rest; skins
are applied, since without them a skinned mesh stands in no meaningful place. Cameras are ignored.

=============== ==============================================================
module          idea
=============== ==============================================================
`container`     JSON and binary chunk, versions, required extensions
`buffers`       bytes → arrays: views, strides, sparse, normalised, data URIs
`materials`     metallic-roughness → `Material`, textures, emission in cd/m²
`nodes`         the tree of transforms, and the lights in it
`locators`      named nodes as places, read and written
`primitives`    triangles, strips and fans, placed, mirrored and skinned
=============== ==============================================================

Source: Khronos Group, "glTF 2.0 Specification" (2021), and the texts of KHR_lights_punctual,
KHR_materials_emissive_strength, KHR_mesh_quantization and KHR_texture_transform.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from andon.errors import InputError
from andon.files.limits import DEFAULT_LIMITS, Limits, check_at_most
from andon.files.meshes.assemble import check_geometry, concatenate, unit_normals
from andon.files.meshes.gltf.buffers import BufferStore
from andon.files.meshes.gltf.container import Document, open_document
from andon.files.meshes.gltf.locators import GltfNode, read_gltf_nodes, write_gltf_nodes
from andon.files.meshes.gltf.materials import MaterialReader, TextureUse
from andon.files.meshes.gltf.nodes import PlacedNode, place_nodes, read_light
from andon.files.meshes.gltf.primitives import (
    Part,
    read_part,
    skin_matrices,
    with_facet_normals,
)
from andon.files.meshes.model import MeshFile, MeshLight
from andon.files.tree import Tree
from andon.quantities import Geometry, Material

__all__ = ["GltfNode", "read_gltf", "read_gltf_lights", "read_gltf_nodes", "write_gltf_nodes"]

# glTF 2.0, 3.7.2.1: a primitive without material has the values of an empty one.
DEFAULT_MATERIAL = Material("default", (1.0, 1.0, 1.0), metallic=1.0, two_sided=False)


def read_gltf(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> MeshFile:
    """A .gltf or .glb file: metres, +Y up, as glTF demands.

    Primitives with and without normals may be mixed: the latter get flat ones. A primitive
    without material gets glTF's default (white, rough metal 1, one-sided) as reflectance 1.
    """
    document = open_document(path, limits)
    nodes = place_nodes(document)
    lights = _lights(document, nodes)
    parts, materials = _Collector(document).collect(nodes)
    if not parts:
        raise InputError("a mesh must have faces, this scene has none", file=path)
    return MeshFile(
        _merge(parts, materials, str(path), limits.max_vertices),
        lights,
        tuple(node.name for node in nodes),
        _at_rest(document, nodes),
    )


def _at_rest(document: Document, nodes: list[PlacedNode]) -> tuple[str, ...]:
    """What would move in a player and stands still here."""
    drawn = [node for node in nodes if node.entry.get("mesh") is not None]
    meshes = [document.entry("meshes", node.entry.at("mesh")) for node in drawn]
    primitives = [part for mesh in meshes for part in mesh.at("primitives").elements()]
    found = {
        "skin": any(node.entry.get("skin") is not None for node in drawn),
        "animation": bool(document.root.list_of("animations")),
        "morph targets": any(part.get("targets") is not None for part in primitives),
    }
    return tuple(name for name, is_there in found.items() if is_there)


def read_gltf_lights(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> tuple[MeshLight, ...]:
    """The lights of a .gltf or .glb file, in the order of their nodes; its meshes are not read."""
    document = open_document(path, limits)
    return _lights(document, place_nodes(document))


def _lights(document: Document, nodes: list[PlacedNode]) -> tuple[MeshLight, ...]:
    found = (read_light(document, node) for node in nodes)
    return tuple(light for light in found if light is not None)


class _Collector:
    """Gathers the primitives of all placed nodes, and the materials that they use."""

    def __init__(self, document: Document) -> None:
        self._document = document
        self._buffers = BufferStore(document)
        self._reader = MaterialReader(document, self._buffers)
        self._numbers: dict[str, int] = {}
        self._materials: list[Material] = []
        self._uses: list[TextureUse] = []

    def collect(self, nodes: list[PlacedNode]) -> tuple[list[Part], tuple[Material, ...]]:
        limits, path = self._document.limits, self._document.path
        world = {node.number: node.world_from_node for node in nodes}
        parts: list[Part] = []
        visited = vertices = triangles = 0
        for node in nodes:
            reference = node.entry.get("mesh")
            if reference is None:
                continue
            skin = skin_matrices(self._document, self._buffers, node, world)
            mesh = self._document.entry("meshes", reference)
            for primitive in mesh.at("primitives").elements():
                visited += 1
                check_at_most(visited, limits.max_nodes, "primitives", path)
                number = self._material(primitive)
                part = read_part(
                    self._document, self._buffers, primitive, node, self._uses[number], number, skin
                )
                if part is None:
                    continue
                parts.append(part)
                # Instances share bytes in the file but not here: count what they add up to.
                vertices, triangles = (
                    vertices + len(part.positions),
                    triangles + len(part.triangles),
                )
                check_at_most(vertices, limits.max_vertices, "vertices", path)
                check_at_most(triangles, limits.max_triangles, "triangles", path)
        return parts, tuple(self._materials)

    def _material(self, primitive: Tree) -> int:
        reference = primitive.get("material")
        entry = self._document.entry("materials", reference) if reference else None
        key = entry.place if entry else ""
        if key not in self._numbers:
            found = self._reader.read(entry) if entry else (DEFAULT_MATERIAL, TextureUse())
            self._numbers[key] = len(self._materials)
            self._materials.append(found[0])
            self._uses.append(found[1])
        return self._numbers[key]


def _merge(parts: list[Part], materials: tuple[Material, ...], file: str, most: int) -> Geometry:
    """All parts as one geometry."""
    if any(part.normals is not None for part in parts):
        parts = [part if part.normals is not None else with_facet_normals(part) for part in parts]
    check_at_most(sum(len(part.positions) for part in parts), most, "vertices", file)
    starts = np.cumsum([0, *(len(part.positions) for part in parts)])
    positions = concatenate([part.positions for part in parts])
    triangles = concatenate(
        [part.triangles + start for part, start in zip(parts, starts, strict=False)]
    )
    check_geometry(positions, triangles, file)
    normals = uvs = None
    if parts[0].normals is not None:
        stored = [part.normals for part in parts if part.normals is not None]
        normals = unit_normals(concatenate(stored), positions, triangles, file)
    if any(part.uvs is not None for part in parts):
        uvs = concatenate(
            [np.zeros((len(p.positions), 2)) if p.uvs is None else p.uvs for p in parts]
        )
    ids = concatenate([np.full(len(p.triangles), p.material, np.int32) for p in parts])
    return Geometry(positions, triangles.astype(np.int32), normals, uvs, ids, materials)
