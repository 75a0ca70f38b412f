"""Triangles from the frame of their file to the world."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from andon.quantities import Geometry
from andon.spaces import transform_points

__all__ = ["middle_of", "placed", "placed_vertices"]

Float = NDArray[np.float64]


def placed(geometry: Geometry, world_from_mesh: Float, /) -> Geometry:
    """The geometry under an affine (4, 4) transform; a mirror turns its triangles round."""
    triangles = geometry.triangles
    if np.linalg.det(world_from_mesh[:3, :3]) < 0:
        triangles = triangles[:, ::-1]
    positions, normals = placed_vertices(geometry.positions, geometry.normals, world_from_mesh)
    return replace(geometry, positions=positions, triangles=triangles, normals=normals)


def placed_vertices(
    positions: Float, normals: Float | None, world_from_mesh: Float, /
) -> tuple[Float, Float | None]:
    """Positions (n, 3) and unit normals (n, 3), or None, under an affine (4, 4) transform."""
    moved = transform_points(world_from_mesh, positions)
    if normals is None:
        return moved, None
    turned = normals @ np.linalg.inv(world_from_mesh[:3, :3])
    length = np.sqrt(np.einsum("ni,ni->n", turned, turned))[:, None]
    return moved, np.divide(turned, length, out=np.zeros_like(turned), where=length > 0)


def middle_of(points: Float, /) -> Float:
    """(3,) the middle of the bounding box of points (…, 3)."""
    # Axis by axis: along the first axis of (n, 3) NumPy takes five times as long.
    axes = [points[..., axis] for axis in range(3)]
    return np.array([0.5 * (along.min() + along.max()) for along in axes])
