"""Meshes: OBJ, PLY and glTF as triangles with materials.

The readers are ours, because each general one fails at a point that matters here: wrong bounds
for negative OBJ indices (trimesh), ``../`` followed in strangers' files (pygltflib), lights and
material extensions dropped (trimesh). They share their last steps in `assemble`.

====== ========================= =========================================== ==================
format units and axes            materials                                   textures
====== ========================= =========================================== ==================
OBJ    unknown: the scene says   .mtl: Kd, Ke, map_Kd                        beside the file
PLY    unknown: the scene says   none (gray 0.5)                             none
glTF   metres, +Y up             metallic-roughness, extensions handed on    beside, or inside
====== ========================= =========================================== ==================
"""

from __future__ import annotations

from pathlib import Path

from andon.errors import InputError
from andon.files.limits import DEFAULT_LIMITS, Limits
from andon.files.meshes.gltf import read_gltf, read_gltf_animated, read_gltf_lights
from andon.files.meshes.gltf.animated import AnimatedMesh
from andon.files.meshes.model import MeshFile, MeshLight
from andon.files.meshes.obj import read_obj
from andon.files.meshes.ply import read_ply
from andon.files.reader import Reader, choose_reader

__all__ = [
    "MESH_READERS",
    "AnimatedMesh",
    "MeshFile",
    "MeshLight",
    "read_animated",
    "read_lights",
    "read_mesh",
]

MESH_READERS = (
    Reader("mesh.obj", (".obj",), read_obj),
    Reader("mesh.ply", (".ply",), read_ply),
    Reader("mesh.gltf", (".gltf",), read_gltf),
    Reader("mesh.glb", (".glb",), read_gltf),
)


def read_lights(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> tuple[MeshLight, ...]:
    """The lights of a glTF file, in metres with +Y up; other formats have none and are refused."""
    _check_gltf(path, "lights")
    return read_gltf_lights(path, limits=limits)


def read_animated(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> AnimatedMesh:
    """The mesh of a glTF file with its animations, in metres with +Y up.

    Raises `InputError` for other formats, and for what `read_mesh` refuses; for times of keys that
    do not rise, samplers that are missing, unknown paths and values that do not fit.
    """
    _check_gltf(path, "animations")
    return read_gltf_animated(path, limits=limits)


def _check_gltf(path: str | Path, what: str) -> None:
    if Path(path).suffix.lower() not in (".gltf", ".glb"):
        raise InputError(
            f"only glTF files have {what}", file=path, remedy="use a .gltf or .glb file"
        )


def read_mesh(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> MeshFile:
    """The triangles, materials and lights of a mesh file, in the file's own units and axes.

    Raises
    ------
    InputError
        if the suffix is unknown, the mesh has no faces, an index is out of range, a position is
        not finite, a reference leaves the folder, or the file is damaged or too large.
    """
    mesh: MeshFile = choose_reader(path, MESH_READERS, "mesh").read(path, limits=limits)
    return mesh
