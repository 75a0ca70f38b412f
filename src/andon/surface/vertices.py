"""Triangles as the rasteriser reads them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.gbuffer import VERTEX
from andon.quantities import Geometry
from andon.rays import face_normals

__all__ = ["corner_numbers", "is_flat", "vertex_arrays"]


def is_flat(geometry: Geometry, /) -> bool:
    """Every triangle has one normal and one colour."""
    if geometry.uvs is not None and any(m.texture is not None for m in geometry.materials):
        return False
    if geometry.normals is None:
        return True
    corners = geometry.normals[geometry.triangles]
    return bool((corners == corners[:, :1]).all())


def vertex_arrays(geometry: Geometry, /) -> tuple[NDArray[Any], NDArray[np.uint32]]:
    """Vertices (n,) of `VERTEX` and indices (3m,); flat shading gets its own three corners."""
    triangles, ids = geometry.triangles, geometry.material_ids
    corner = corner_numbers(geometry)
    shared = geometry.normals is not None and (ids is None or not ids.any())
    vertices = np.zeros(len(corner), VERTEX)
    vertices["position"] = geometry.positions[corner]
    if geometry.normals is not None:
        vertices["normal"] = geometry.normals[corner]
    else:
        vertices["normal"] = np.repeat(face_normals(geometry), 3, axis=0)
    if geometry.uvs is not None:
        vertices["uv"] = geometry.uvs[corner]
    if ids is not None and not shared:
        vertices["material"] = np.repeat(ids, 3)
    indices = triangles.ravel() if shared else np.arange(len(corner))
    return vertices, indices.astype(np.uint32)


def corner_numbers(geometry: Geometry, /) -> NDArray[np.intp]:
    """(n,) which of the geometry's vertices each vertex of `vertex_arrays` is."""
    ids = geometry.material_ids
    if geometry.normals is not None and (ids is None or not ids.any()):
        return np.arange(len(geometry.positions))
    return geometry.triangles.ravel().astype(np.intp)
