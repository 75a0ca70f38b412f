"""Mesh files as a scene means them: in metres with +Y up, with textures that both engines read."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.meshes import MeshFile, read_mesh
from andon.quantities import Geometry
from andon.scene import Scene
from andon.surface.placing import placed
from andon.surface.textures import with_linear_textures

__all__ = ["check_textures", "read_geometry", "rest_note"]

Float = NDArray[np.float64]

# An array texture has at least 256 layers on every adapter (WebGPU, table of limits).
MAX_TEXTURES = 256

# Units and axes are the scene's for formats that do not define them; glTF is metres, +Y up.
UNITLESS_SUFFIXES = {".obj", ".ply"}
Y_UP_FROM_Z_UP = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])


def read_geometry(scene: Scene, path: Path, world_from_mesh: Float) -> tuple[Geometry, MeshFile]:
    """The triangles of a file in the world, at rest, and the file as it was read."""
    mesh = read_mesh(path)
    if path.suffix.lower() in UNITLESS_SUFFIXES:
        scale = np.eye(4)
        scale[:3, :3] = np.eye(3) if scene.scene.up == "y" else Y_UP_FROM_Z_UP
        scale[:3, :3] *= scene.scene.metres_per_unit
        world_from_mesh = world_from_mesh @ scale
    return with_linear_textures(placed(mesh.geometry, world_from_mesh)), mesh


def rest_note(path: Path, mesh: MeshFile, remedy: str = "and does not move") -> tuple[str, ...]:
    """What is to be said of a file with things that would move and do not."""
    if not mesh.at_rest:
        return ()
    what = " and ".join(mesh.at_rest)
    return (f"{path.name} has {what}: it is drawn in its pose of rest, {remedy}",)


def check_textures(geometry: Geometry, scene: Scene, field: str) -> None:
    """Refuses more textures than one draw can have."""
    textured = sum(material.texture is not None for material in geometry.materials)
    if textured > MAX_TEXTURES:
        raise InputError(
            f"has {textured} materials with a texture, at most {MAX_TEXTURES} can be drawn",
            file=scene.file,
            field=field,
            remedy="let parts share materials, or put several textures into one picture",
        )
