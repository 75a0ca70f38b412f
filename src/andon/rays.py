"""Rays against triangles by Embree: the reference's eyes and shadows.

Embree works in float32. Hits are therefore only *chosen* by it; where a hit point is needed it is
recomputed in float64 from the plane of the triangle that was hit.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.quantities import Geometry

__all__ = ["Hits", "RayScene", "face_normals"]

Float = NDArray[np.float64]

# Embree is fed in slices so that a 4K frame does not need gigabytes of float32 copies.
RAYS_PER_CALL = 1 << 20
# Shadow rays end this share of their length before the lamp: float32 has 6e-8, a lamp on a
# surface would otherwise shadow itself.
LAMP_GAP = 1e-4


def face_normals(geometry: Geometry) -> Float:
    """(m, 3) unit geometric normals; zero for degenerate triangles."""
    a, b, c = (geometry.positions[geometry.triangles[:, i]] for i in range(3))
    normals = np.cross(b - a, c - a)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.divide(normals, length, out=np.zeros_like(normals), where=length > 0)


@dataclass(frozen=True)
class Hits:
    """First hits of n rays.

    Attributes
    ----------
    triangle : (n,) int32, −1 where nothing was hit.
    distance : (n,) float64 metres along the unit direction, inf where nothing was hit.
    barycentric : (n, 3) float64 weights of the triangle's corners, NaN where nothing was hit.
    """

    triangle: NDArray[np.int32]
    distance: Float
    barycentric: Float


class RayScene:
    """Triangles that rays can be shot at."""

    def __init__(self, geometry: Geometry) -> None:
        from embreex import mesh_construction, rtcore_scene

        embree: Any = rtcore_scene
        meshes: Any = mesh_construction

        self.geometry = geometry
        # Robust: rays do not slip through the edge that two triangles share.
        self._scene: Any = embree.EmbreeScene(robust=True)
        if len(geometry.triangles):
            # The mesh has to outlive the queries: the scene only borrows its buffers.
            self._mesh: Any = meshes.TriangleMesh(
                self._scene,
                np.ascontiguousarray(geometry.positions, np.float32),
                np.ascontiguousarray(geometry.triangles, np.int32),
            )

    @cached_property
    def _corners(self) -> Float:
        return self.geometry.positions[self.geometry.triangles]

    def _run(self, origins: Float, directions: Float, **options: Any) -> NDArray[np.int32]:
        if len(self.geometry.triangles) == 0:
            return np.full(len(origins), -1, np.int32)
        parts: list[NDArray[np.int32]] = []
        limits = options.pop("dists", None)
        for start in range(0, len(origins), RAYS_PER_CALL):
            rays = slice(start, start + RAYS_PER_CALL)
            extra = {} if limits is None else {"dists": limits[rays].astype(np.float32)}
            found = self._scene.run(
                np.ascontiguousarray(origins[rays], np.float32),
                np.ascontiguousarray(directions[rays], np.float32),
                **options,
                **extra,
            )
            parts.append(np.asarray(found, np.int32))
        return np.concatenate(parts) if parts else np.empty(0, np.int32)

    def first_hits(self, origins: Float, directions: Float, /) -> Hits:
        """First hits of rays from `origins` (n, 3) along unit `directions` (n, 3)."""
        triangle = self._run(origins, directions, query="INTERSECT")
        hit = triangle >= 0
        distance = np.full(len(triangle), np.inf)
        barycentric = np.full((len(triangle), 3), np.nan)
        distance[hit], barycentric[hit] = _intersect_plane(
            origins[hit], directions[hit], self._corners[triangle[hit]]
        )
        return Hits(triangle, distance, barycentric)

    def is_visible(self, points: Float, target: Float, /) -> NDArray[np.bool_]:
        """(n,) bool: nothing stands between `points` (n, 3) and `target` (3,) or (n, 3)."""
        reach = target - points
        distance = np.linalg.norm(reach, axis=-1)
        with np.errstate(invalid="ignore", divide="ignore"):
            directions = reach / distance[:, None]
        hits = self._run(points, directions, query="OCCLUDED", dists=distance * (1 - LAMP_GAP))
        return hits < 0

    def sees_infinity(self, points: Float, direction: Float, /) -> NDArray[np.bool_]:
        """(n,) bool: nothing stands in `direction` (3,) from `points` (n, 3)."""
        directions = np.broadcast_to(direction, points.shape)
        return self._run(points, directions, query="OCCLUDED") < 0

    def crossings(self, origin: Float, directions: Float, /) -> NDArray[np.int64]:
        """(n,) how many triangles each ray from `origin` (3,) crosses (brute force, exact)."""
        a, b, c = np.moveaxis(self._corners, 1, 0)
        edge1, edge2, offset = b - a, c - a, origin - a
        counts = np.zeros(len(directions), np.int64)
        for index, direction in enumerate(directions):  # Möller & Trumbore 1997
            p = np.cross(direction, edge2)
            determinant = np.einsum("ij,ij->i", edge1, p)
            with np.errstate(divide="ignore", invalid="ignore"):
                u = np.einsum("ij,ij->i", offset, p) / determinant
                q = np.cross(offset, edge1)
                v = (q @ direction) / determinant
                t = np.einsum("ij,ij->i", edge2, q) / determinant
            counts[index] = np.count_nonzero((u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0))
        return counts


def _intersect_plane(origins: Float, directions: Float, corners: Float) -> tuple[Float, Float]:
    a, b, c = np.moveaxis(corners, 1, 0)
    edge1, edge2, offset = b - a, c - a, origins - a
    p, q = np.cross(directions, edge2), np.cross(offset, edge1)
    inverse = 1 / np.einsum("ij,ij->i", edge1, p)
    u = np.einsum("ij,ij->i", offset, p) * inverse
    v = np.einsum("ij,ij->i", directions, q) * inverse
    distance = np.einsum("ij,ij->i", edge2, q) * inverse
    # Embree's float32 may call a hit that lies a hair outside the triangle: clamp to it.
    weights = np.clip(np.stack([1 - u - v, u, v], axis=1), 0, 1)
    return distance, weights / weights.sum(axis=1, keepdims=True)
