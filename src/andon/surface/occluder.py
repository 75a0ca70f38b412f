"""Fewer triangles for shadow maps, and what that costs in metres."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.quantities import Geometry
from andon.rays import RayScene
from andon.surface.nearest import nearest_distance

__all__ = ["Occluder", "decimated"]

# Points that measure the decimation's error; 4096 samples give the 95th percentile within ±0.7 %
# of the population (binomial, 2σ).
ERROR_SAMPLES = 4096
# A point farther than this share of its distance from the eye from all that is left was not moved
# but removed. Depth cameras and stereo scatter by half of it at most: no noise is called a loss.
LOST = 0.01


@dataclass(frozen=True)
class Occluder:
    """What casts shadows.

    Attributes
    ----------
    geometry : triangles in the world.
    triangles_before : how many there were before decimation.
    error_m : 95th percentile of the distance from the original surface, as far as the eye sees
        it, to the nearest place of the decimated one; 0 where nothing was decimated.
    lost_share : of the original surface, as the eye sees it, that has nothing decimated in its
        line of sight or nothing within 1 % of its distance: rims that shrank and small pieces
        that vanished, before a wall too. They cast no shadow.
    """

    geometry: Geometry
    triangles_before: int
    error_m: float
    lost_share: float = 0.0


def decimated(geometry: Geometry, max_triangles: int, eye: NDArray[Any]) -> Occluder:
    """At most `max_triangles` by quadric edge collapse (Garland & Heckbert 1997).

    `eye` (3,) is where the surface is looked at from, metres in the world. 0 keeps everything.
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
    # Only what the eye sees is asked: nothing else is lit and shown.
    before = RayScene(geometry)
    corners = _seen(before, _thinned(geometry.positions), eye)
    middles = _seen(before, geometry.positions[_thinned(geometry.triangles)].mean(axis=1), eye)
    # Moves at vertices, where they are largest; losses at middles of triangles, since a ray
    # through a vertex on the rim meets the rim only by chance. Moves are distances to the nearest
    # place, not to the one in the line of sight: along a slanted surface the same gap would count
    # many times over, and behind a silhouette that drew back the line of sight ends on a wall.
    moved = _moves_m(fewer, corners, eye)
    moved = moved[np.isfinite(moved)]
    if not len(moved) or not len(middles):
        return Occluder(geometry, count, 0.0)  # nothing to judge the decimation by: keep all
    met = np.isfinite(_sight_m(RayScene(fewer), middles, eye))
    lost = ~(met & np.isfinite(_moves_m(fewer, middles, eye)))
    return Occluder(fewer, count, float(np.percentile(moved, 95)), float(lost.mean()))


def _moves_m(after: Geometry, points: NDArray[Any], eye: NDArray[Any]) -> NDArray[np.float64]:
    """(n,) metres from `points` (n, 3) to what is left of the surface; inf where they are lost."""
    away = nearest_distance(points, after)
    return np.where(away <= LOST * np.linalg.norm(points - eye, axis=1), away, np.inf)


# A point counts as seen if the ray to it ends there, within this share of its distance.
SAME_PLACE = 1e-3


def _seen(scene: RayScene, points: NDArray[Any], eye: NDArray[Any]) -> NDArray[Any]:
    distance = np.linalg.norm(points - eye, axis=1)
    return points[np.abs(_sight_m(scene, points, eye) - distance) <= SAME_PLACE * distance]


def _sight_m(scene: RayScene, points: NDArray[Any], eye: NDArray[Any]) -> NDArray[np.float64]:
    """(n,) metres along the ray from `eye` (3,) through each of `points`; inf where it is free."""
    reach = points - eye
    distance = np.linalg.norm(reach, axis=1, keepdims=True)
    return scene.first_hits(np.broadcast_to(eye, points.shape), reach / distance).distance


def _thinned(rows: NDArray[Any]) -> NDArray[Any]:
    return rows[:: max(1, len(rows) // ERROR_SAMPLES)]
