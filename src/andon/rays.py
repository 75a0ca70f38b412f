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

    def is_visible(
        self, points: Float, target: Float, /, *, near_m: float = 0.0
    ) -> NDArray[np.bool_]:
        """(n,) bool: nothing stands between `points` (n, 3) and `target` (3,) or (n, 3).

        What is nearer than `near_m` to the target does not count.
        """
        reach = target - points
        distance = np.linalg.norm(reach, axis=-1)
        with np.errstate(invalid="ignore", divide="ignore"):
            directions = reach / distance[:, None]
        free = np.maximum(np.minimum(distance * (1 - LAMP_GAP), distance - near_m), 0)
        hits = self._run(points, directions, query="OCCLUDED", dists=free)
        return hits < 0

    def sees_infinity(self, points: Float, direction: Float, /) -> NDArray[np.bool_]:
        """(n,) bool: nothing stands in `direction` (3,) from `points` (n, 3)."""
        directions = np.broadcast_to(direction, points.shape)
        return self._run(points, directions, query="OCCLUDED") < 0

    def crossings(self, origin: Float, directions: Float, /) -> NDArray[np.int64]:
        """(n,) how many triangles each ray from `origin` (3,) crosses (brute force, exact).

        A ray on an edge or a corner counts as one that passes a hair beside it, the same hair for
        all triangles, so that closed surfaces are crossed an odd number of times from inside.
        Triangles without an area are never crossed.
        """
        corners = np.moveaxis(self._corners - origin, (1, 2), (0, 1))  # (corner, xyz, triangle)
        counts = np.zeros(len(directions), np.int64)
        for index, direction in enumerate(directions):
            # Seen along the ray: corners as points of a plane, the ray at its origin.
            x, y, z = (_along(corners, axis) for axis in _frame(direction))
            seen = [_side(x[i - 2], y[i - 2], x[i - 1], y[i - 1]) for i in range(3)]
            around = np.abs(sum(sign for _, sign in seen)) == 3
            # Barycentric weights times depths: of the sign of the hit's, whatever the area's.
            ahead = sum(weight * z[i] for i, (weight, _) in enumerate(seen))
            counts[index] = np.count_nonzero(around & (ahead * seen[0][1] > 0))
        return counts


def _frame(direction: Float) -> Float:
    """(3, 3) rows: two axes across `direction`, and itself."""
    aside = np.cross(direction, np.eye(3)[np.abs(direction).argmin()])
    return np.asarray([aside, np.cross(direction, aside), direction], np.float64)


def _along(corners: Float, axis: Float) -> Float:
    # Written out: a matrix product may add the last columns in another order and round otherwise,
    # and one corner of two triangles would be two points.
    return corners[:, 0] * axis[0] + corners[:, 1] * axis[1] + corners[:, 2] * axis[2]


def _side(ax: Float, ay: Float, bx: Float, by: Float) -> tuple[Float, Float]:
    """Twice the area (n,) that an edge from a to b spans with the origin; and its sign, exactly.

    The sign says on which side of the edge the origin lies. Exactly on it, the origin counts as
    (ε, ε²) (simulation of simplicity, Edelsbrunner & Mücke 1990): 0 only where a is b.
    """
    left, right = ax * by, ay * bx
    # Rounding is monotonic: unequal rounded products differ the same way as the exact ones.
    sign = np.sign(left - right)
    tied = np.flatnonzero(sign == 0)
    if len(tied):
        a, b = (ax[tied], ay[tied]), (bx[tied], by[tied])
        exact = np.sign(_rounding(a[0], b[1]) - _rounding(a[1], b[0]))
        for shift in (a[1] - b[1], b[0] - a[0]):
            exact = np.where(exact == 0, np.sign(shift), exact)
        sign[tied] = exact
    return left - right, sign


def _rounding(x: Float, y: Float) -> Float:
    """x·y less its rounded value, exactly (Dekker 1971)."""
    (x1, x0), (y1, y0) = _halves(x), _halves(y)
    error: Float = ((x1 * y1 - x * y) + x1 * y0 + x0 * y1) + x0 * y0
    return error


def _halves(x: Float) -> tuple[Float, Float]:
    scaled = x * 134217729.0  # 2²⁷ + 1: of 53 bits, 26 in each half
    high = scaled - (scaled - x)
    return high, x - high


def _intersect_plane(origins: Float, directions: Float, corners: Float) -> tuple[Float, Float]:
    a, b, c = np.moveaxis(corners, 1, 0)  # Möller & Trumbore 1997
    edge1, edge2, offset = b - a, c - a, origins - a
    p, q = np.cross(directions, edge2), np.cross(offset, edge1)
    inverse = 1 / np.einsum("ij,ij->i", edge1, p)
    u = np.einsum("ij,ij->i", offset, p) * inverse
    v = np.einsum("ij,ij->i", directions, q) * inverse
    distance = np.einsum("ij,ij->i", edge2, q) * inverse
    # Embree's float32 may call a hit that lies a hair outside the triangle: clamp to it.
    weights = np.clip(np.stack([1 - u - v, u, v], axis=1), 0, 1)
    return distance, weights / weights.sum(axis=1, keepdims=True)
