"""Fewer triangles for shadow maps, and what that costs in metres."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

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
        the decimated surface, where there still is one; 0 where nothing was decimated.
    lost_share : of the original surface, as seen by the eye, that has nothing decimated in its
        line of sight, nearer or farther: small pieces that vanished and rims that shrank. They
        cast no shadow and have no error in metres.
    """

    geometry: Geometry
    triangles_before: int
    error_m: float
    lost_share: float = 0.0


def decimated(geometry: Geometry, max_triangles: int, eye: NDArray[Any]) -> Occluder:
    """At most `max_triangles` by quadric edge collapse (Garland & Heckbert 1997).

    `eye` (3,) is where the error is looked at from, metres in the world. 0 keeps everything.
    """
    count = len(geometry.triangles)
    if max_triangles <= 0 or count <= max_triangles:
        return Occluder(geometry, count, 0.0)
    import fast_simplification

    simplify: Any = fast_simplification.simplify  # its annotations promise float64 only
    points, triangles = simplify(
        np.ascontiguousarray(geometry.positions, np.float32),
        np.ascontiguousarray(geometry.triangles, np.int32),
        target_count=max_triangles,
    )
    fewer = Geometry(np.asarray(points, np.float64), np.asarray(triangles, np.int32))
    before, after = RayScene(geometry), RayScene(fewer)
    # Errors at vertices, where they are largest; losses at middles of triangles, since a ray
    # through a vertex on the rim meets the rim only by chance.
    # Only what the eye sees is asked: before a hidden vertex stands something else, not an error.
    corners = _seen(before, _thinned(geometry.positions), eye)
    middles = _seen(before, geometry.positions[_thinned(geometry.triangles)].mean(axis=1), eye)
    errors = _errors_m(after, corners, eye)
    found = errors[np.isfinite(errors)]
    if not len(found) or not len(middles):
        return Occluder(geometry, count, 0.0)  # nothing to judge the decimation by: keep all
    lost = ~np.isfinite(_errors_m(after, middles, eye))
    return Occluder(fewer, count, float(np.percentile(found, 95)), float(lost.mean()))


# A point counts as seen if the ray to it ends there, within this share of its distance.
SAME_PLACE = 1e-3


def _seen(scene: RayScene, points: NDArray[Any], eye: NDArray[Any]) -> NDArray[Any]:
    distance = np.linalg.norm(points - eye, axis=1)
    return points[_errors_m(scene, points, eye) <= SAME_PLACE * distance]


def _thinned(rows: NDArray[Any]) -> NDArray[Any]:
    return rows[:: max(1, len(rows) // ERROR_SAMPLES)]


def _errors_m(after: RayScene, points: NDArray[Any], eye: NDArray[Any]) -> NDArray[np.float64]:
    reach = points - eye
    distance = np.linalg.norm(reach, axis=1)
    hits = after.first_hits(np.broadcast_to(eye, points.shape), reach / distance[:, None])
    return np.abs(hits.distance - distance)


def merged(*parts: Geometry) -> Geometry:
    """One geometry from several; normals, textures and materials are left behind."""
    offsets = np.cumsum([0, *(len(part.positions) for part in parts)])
    return Geometry(
        np.concatenate([part.positions for part in parts]),
        np.concatenate(
            [part.triangles + offset for part, offset in zip(parts, offsets, strict=False)]
        ).astype(np.int32),
    )
