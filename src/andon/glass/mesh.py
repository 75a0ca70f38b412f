"""Rays and closed meshes: Embree finds the triangles, float64 the points on them.

Light is refracted at the interpolated normals of the corners, so that facets do not show; where it
goes and whether it enters or leaves is the business of the facets.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from andon.glass.model import Closed
from andon.glass.refraction import dot
from andon.quantities import Geometry
from andon.rays import RayScene

__all__ = ["MeshBody", "mesh_body"]

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]
Int = NDArray[np.int64]

# Steps over boundaries of the wrong side, as a share of the size: ten roundings of float32.
STEP = 1e-6
# Boundaries of the wrong side are stepped over so often: where a ray starts, and where a mesh
# overlaps itself.
MAX_STEPS = 8
# Ways in which a point looks for the next boundary, to know what it is inside of; along no axis.
WAYS = np.array([[0.36, 0.48, 0.8], [-0.8, 0.36, -0.48], [0.48, -0.8, -0.36]])
KEPT = 32


class MeshBody:
    """A closed mesh, ready for rays.

    Attributes
    ----------
    size : metres, half its largest extent.
    """

    def __init__(self, geometry: Geometry) -> None:
        low, high = geometry.positions.min(axis=0), geometry.positions.max(axis=0)
        # Embree's float32 is finest around its origin.
        self._middle: Float = (low + high) / 2
        self._half: Float = (high - low) / 2
        self.size = float(self._half.max())
        self._geometry = geometry
        centred = geometry.positions - self._middle
        self._rays = RayScene(Geometry(centred, geometry.triangles))
        a, b, c = (centred[geometry.triangles[:, i]] for i in range(3))
        across = np.cross(b - a, c - a)
        twice = np.maximum(np.linalg.norm(across, axis=1, keepdims=True), np.finfo(float).tiny)
        self._facets: Float = across / twice
        # How a corner's weight grows along the triangle: from the edge that it is opposite to.
        edges = np.stack([c - b, a - c, b - a], axis=1)
        self._slopes: Float = np.cross(self._facets[:, None], edges) / twice[:, None]

    def crossing(
        self, origins: Float, directions: Float, inside: Bool, /
    ) -> tuple[Float, Int, Float]:
        """Distance, triangle (n,) and weights (n, 3) of the next boundary; see `shapes.hit`."""
        start = origins - self._middle
        t, part = np.full(len(start), np.inf), np.full(len(start), -1, np.int64)
        weights = np.zeros((len(start), 3))
        left, gone = self._near(start, directions), np.zeros(len(start))
        for _ in range(MAX_STEPS):
            found = self._rays.first_hits(
                start[left] + gone[left, None] * directions[left], directions[left]
            )
            is_hit = found.triangle >= 0
            left, triangle = left[is_hit], found.triangle[is_hit]
            reach = gone[left] + found.distance[is_hit]
            right = (dot(directions[left], self._facets[triangle]) > 0) == inside[left]
            done = left[right]
            t[done], part[done] = np.maximum(reach[right], 0), triangle[right]
            weights[done] = found.barycentric[is_hit][right]
            left = left[~right]
            gone[left] = np.maximum(reach[~right], gone[left]) + STEP * self.size
            if not len(left):
                break
        return t, part, weights

    def boundary(self, part: Int, weights: Float, /) -> tuple[Float, Float, Float, Float, Float]:
        """The fields of `Boundary`."""
        corners = self._geometry.triangles[part]
        facet = self._facets[part]
        uv, uv_slope = np.full((len(part), 2), np.nan), np.zeros((len(part), 2, 3))
        if self._geometry.uvs is not None:
            uv = np.einsum("nk,nki->ni", weights, self._geometry.uvs[corners])
            uv_slope = np.einsum("nki,nkj->nij", self._geometry.uvs[corners], self._slopes[part])
        if self._geometry.normals is None:
            return facet, facet, np.zeros((len(part), 3, 3)), uv, uv_slope
        normals = self._geometry.normals[corners]
        mixed = np.einsum("nk,nki->ni", weights, normals)
        length = np.linalg.norm(mixed, axis=1)
        length = np.copysign(np.maximum(length, np.finfo(float).tiny), dot(mixed, facet))
        normal = mixed / length[:, None]
        turning = np.einsum("nki,nkj->nij", normals, self._slopes[part]) / length[:, None, None]
        turning -= normal[:, :, None] * np.einsum("ni,nij->nj", normal, turning)[:, None]
        return normal, facet, turning, uv, uv_slope

    def contains(self, points: Float, margin_m: float, /) -> Bool:
        """(n,) bool: the next boundary around is one to leave by; `margin_m` shrinks the box."""
        inside = np.all(np.abs(points - self._middle) < self._half - margin_m, axis=-1)
        near = points[inside] - self._middle
        votes = np.zeros(len(near), np.int64)
        for way in WAYS / np.linalg.norm(WAYS, axis=1, keepdims=True):
            directions = np.broadcast_to(way, near.shape)
            found = self._rays.first_hits(near, directions)
            is_hit = found.triangle >= 0
            votes[is_hit] += dot(directions[is_hit], self._facets[found.triangle[is_hit]]) > 0
        inside[inside] = 2 * votes > len(WAYS)
        return inside

    def _near(self, start: Float, directions: Float) -> Int:
        """Rays (k,) that meet the sphere around the mesh."""
        along = np.maximum(-dot(start, directions), 0)
        closest = start + along[:, None] * directions
        return np.flatnonzero(dot(closest, closest) <= 1.001 * float(self._half @ self._half))


class _Same:
    """A mesh as a key: the same one, whatever its contents."""

    def __init__(self, closed: Closed) -> None:
        self.closed = closed

    def __hash__(self) -> int:
        return id(self.closed)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Same) and other.closed is self.closed


def mesh_body(closed: Closed, /) -> MeshBody:
    """What rays are shot at for a mesh; made once for each."""
    return _body(_Same(closed))


@lru_cache(maxsize=KEPT)
def _body(key: _Same) -> MeshBody:
    return MeshBody(key.closed.geometry)
