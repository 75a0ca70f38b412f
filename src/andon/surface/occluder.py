"""Fewer triangles for shadow maps, and what that costs in metres."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from andon.quantities import Geometry
from andon.rays import RayScene

__all__ = ["Occluder", "decimated", "merged"]

# Rays that measure the decimation's error; 4096 samples give the 95th percentile within ±0.7 %
# of the population (binomial, 2σ).
ERROR_SAMPLES = 4096


@dataclass(frozen=True)
class Occluder:
    """What casts shadows.

    Attributes
    ----------
    geometry : triangles in the world.
    triangles_before : how many there were before decimation.
    error_m : 95th percentile of the distance, along the line of sight, between the original and
        the decimated surface; 0 where nothing was decimated.
    """

    geometry: Geometry
    triangles_before: int
    error_m: float


def decimated(geometry: Geometry, max_triangles: int, eye: np.ndarray) -> Occluder:
    """At most `max_triangles` by quadric edge collapse (Garland & Heckbert 1997).

    `eye` (3,) is where the error is looked at from, metres in the world. 0 keeps everything.
    """
    count = len(geometry.triangles)
    if max_triangles <= 0 or count <= max_triangles:
        return Occluder(geometry, count, 0.0)
    import fast_simplification

    points, triangles = fast_simplification.simplify(
        np.ascontiguousarray(geometry.positions, np.float32),
        np.ascontiguousarray(geometry.triangles, np.int32),
        target_count=max_triangles,
    )
    fewer = Geometry(np.asarray(points, np.float64), np.asarray(triangles, np.int32))
    return Occluder(fewer, count, _error_m(geometry, fewer, eye))


def _error_m(before: Geometry, after: Geometry, eye: np.ndarray) -> float:
    step = max(1, len(before.positions) // ERROR_SAMPLES)
    points = before.positions[::step]
    reach = points - eye
    distance = np.linalg.norm(reach, axis=1)
    hits = RayScene(after).first_hits(
        np.broadcast_to(eye, points.shape), reach / distance[:, None]
    )
    found = np.isfinite(hits.distance)
    if not found.any():
        return float("inf")
    return float(np.percentile(np.abs(hits.distance[found] - distance[found]), 95))


def merged(*parts: Geometry) -> Geometry:
    """One geometry from several; normals, textures and materials are left behind."""
    offsets = np.cumsum([0, *(len(part.positions) for part in parts)])
    return Geometry(
        np.concatenate([part.positions for part in parts]),
        np.concatenate(
            [part.triangles + offset for part, offset in zip(parts, offsets, strict=False)]
        ).astype(np.int32),
    )
