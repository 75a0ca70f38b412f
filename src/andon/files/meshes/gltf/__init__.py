"""glTF 2.0 and GLB: triangles, materials, lights, skins and animations.

An own reader, because the alternatives either follow ``../`` in strangers' files (pygltflib) or
drop lights and material extensions (trimesh). Cameras are ignored.

=============== ==============================================================
module          idea
=============== ==============================================================
`container`     JSON and binary chunk, versions, required extensions
`buffers`       bytes → arrays: views, strides, sparse, normalised, data URIs
`materials`     metallic-roughness → `Material`, textures, emission in cd/m²
`nodes`         the tree of transforms, and the lights in it
`locators`      named nodes as places, read and written
`primitives`    triangles, strips and fans, morph targets, as they are stored
`skins`         joints, and which vertices hang on them
`posing`        vertices in the world: placed, mirrored, skinned, morphed
`bound`         all primitives of a scene as one geometry of any pose
`clips`, `keys` animations as tracks, and the values between their keys
`motion`        the tree of transforms while a clip plays
`animated`      all of it together: a mesh at any time
=============== ==============================================================

Skinning is the linear blend of joints' matrices (3.7.3.3), in float64 by NumPy: 3,000 vertices
take less than a millisecond, which a shader could not better before ten times as many, and the
same positions serve shadow maps, rays and the G-buffer of both engines.

Source: Khronos Group, "glTF 2.0 Specification" (2021), and the texts of KHR_lights_punctual,
KHR_materials_emissive_strength, KHR_mesh_quantization and KHR_texture_transform.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from andon.errors import InputError
from andon.files.limits import DEFAULT_LIMITS, Limits
from andon.files.meshes.gltf.animated import AnimatedMesh
from andon.files.meshes.gltf.bound import BoundMesh, bind
from andon.files.meshes.gltf.buffers import BufferStore
from andon.files.meshes.gltf.clips import read_clips
from andon.files.meshes.gltf.container import Document, open_document
from andon.files.meshes.gltf.locators import GltfNode, read_gltf_nodes, write_gltf_nodes
from andon.files.meshes.gltf.motion import NodeTree
from andon.files.meshes.gltf.nodes import PlacedNode, place_nodes, read_light
from andon.files.meshes.model import MeshFile, MeshLight

__all__ = [
    "GltfNode",
    "read_gltf",
    "read_gltf_animated",
    "read_gltf_lights",
    "read_gltf_nodes",
    "write_gltf_nodes",
]


def read_gltf(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> MeshFile:
    """A .gltf or .glb file in its pose of rest: metres, +Y up, as glTF demands.

    Primitives with and without normals may be mixed: the latter get flat ones. A primitive
    without material gets glTF's default (white, rough metal 1, one-sided) as reflectance 1.
    """
    document = open_document(path, limits)
    nodes = place_nodes(document)
    mesh = _bound(document, BufferStore(document), nodes, moving=False)
    return MeshFile(
        mesh.geometry(_world(nodes), str(path)),
        _lights(document, nodes),
        tuple(node.name for node in nodes),
        _at_rest(document, nodes),
    )


def read_gltf_animated(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> AnimatedMesh:
    """A .gltf or .glb file with all that moves in it; see `read_gltf`."""
    document = open_document(path, limits)
    nodes = place_nodes(document)
    buffers = BufferStore(document)
    mesh = _bound(document, buffers, nodes, moving=True)
    places = {node.number: place for place, node in enumerate(nodes)}
    clips = read_clips(document, buffers, places)
    tree = NodeTree(nodes)
    tree.check(clips)
    return AnimatedMesh(str(path), mesh.geometry(tree.rest, str(path)), clips, mesh, tree)


def read_gltf_lights(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> tuple[MeshLight, ...]:
    """The lights of a .gltf or .glb file, in the order of their nodes; its meshes are not read."""
    document = open_document(path, limits)
    return _lights(document, place_nodes(document))


def _bound(
    document: Document, buffers: BufferStore, nodes: Sequence[PlacedNode], *, moving: bool
) -> BoundMesh:
    mesh = bind(document, buffers, nodes, moving=moving)
    if not mesh.parts:
        raise InputError("a mesh must have faces, this scene has none", file=document.path)
    return mesh


def _world(nodes: Sequence[PlacedNode]) -> np.ndarray:
    return np.array([node.world_from_node for node in nodes])


def _at_rest(document: Document, nodes: Sequence[PlacedNode]) -> tuple[str, ...]:
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


def _lights(document: Document, nodes: Sequence[PlacedNode]) -> tuple[MeshLight, ...]:
    found = (read_light(document, node) for node in nodes)
    return tuple(light for light in found if light is not None)
