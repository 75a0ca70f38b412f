"""Geometry as Radiance is told it: polygons of one material, and meshes where there is a texture.

Surfaces are flat: normals that are interpolated would make a lamp shine round a corner.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from andon.quantities import Geometry, Material
from andon.transport.baked.radiance.materials import finish_of, material_text
from andon.transport.baked.radiance.text import polygons_text
from andon.transport.baked.radiance.textures import (
    mesh_obj,
    picture_bytes,
    picture_size,
    texture_text,
)

__all__ = ["Surfaces", "surfaces_of", "without_near"]

Float = NDArray[np.float64]


@dataclass(frozen=True)
class Surfaces:
    """Scene text, its pictures, and Wavefront files (without ``.obj``) that become meshes."""

    text: str
    pictures: Mapping[str, bytes] = field(default_factory=dict[str, bytes])
    meshes: Mapping[str, bytes] = field(default_factory=dict[str, bytes])


def surfaces_of(parts: Sequence[Geometry], /, *, emission: bool, black: bool) -> Surfaces:
    """All materials of all parts, each with its triangles."""
    text, pictures, meshes = list[str](), dict[str, bytes](), dict[str, bytes]()
    for part, geometry in enumerate(parts):
        for number, own in _by_material(geometry):
            material, name = geometry.materials[number], f"part{part}.{number}"
            place = f"parts[{part}].materials[{number}]"
            finish = finish_of(material, place, emission=emission, black=black)
            if material.texture is None or geometry.uvs is None or not finish.reflectance.any():
                text.append(material_text(name, finish))
                text.append(polygons_text(geometry.positions[own], name))
            elif mesh := mesh_obj(geometry, own):
                size = picture_size(material.texture, geometry, own)
                pictures[f"{name}.hdr"] = _picture(material, size, place)
                text.append(texture_text(f"{name}.t", size, f"{name}.hdr"))
                text.append(material_text(name, finish, pattern=f"{name}.t"))
                text.append(f"{name} mesh {name}.m 1 {name}.rtm 0 0\n")
                meshes[name] = mesh
    return Surfaces("".join(text), pictures, meshes)


def _by_material(geometry: Geometry) -> list[tuple[int, NDArray[np.int32]]]:
    """Numbers of the materials that have triangles, and these (k, 3)."""
    count = len(geometry.triangles)
    ids = np.zeros(count, np.int32) if geometry.material_ids is None else geometry.material_ids
    order = np.argsort(ids, kind="stable")
    numbers, first = np.unique(ids[order], return_index=True)
    parts = np.split(geometry.triangles[order], first[1:])
    return [(int(number), own) for number, own in zip(numbers, parts, strict=False) if len(own)]


def _picture(material: Material, size: tuple[int, int], field: str) -> bytes:
    assert material.texture is not None
    # No surface reflects more than all.
    most = 1 / np.maximum(np.asarray(material.reflectance, np.float64), 1e-6)
    return picture_bytes(material.texture, size, most, f"{field}.texture")


def without_near(geometry: Geometry, place: Float, radius_m: float, /) -> Geometry:
    """The geometry without triangles that lie wholly within `radius_m` of `place` (3,): a lamp's
    own socket and glass, see `Shadow.near_m`."""
    corners = geometry.positions[geometry.triangles] - place
    kept = (np.linalg.norm(corners, axis=2) > radius_m).any(axis=1)
    if kept.all():
        return geometry
    ids = geometry.material_ids
    return replace(
        geometry,
        triangles=geometry.triangles[kept],
        material_ids=None if ids is None else ids[kept],
    )
