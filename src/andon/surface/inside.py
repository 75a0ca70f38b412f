"""Is a lamp inside a wall?"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.quantities import Geometry
from andon.rays import RayScene

__all__ = ["is_buried"]

Float = NDArray[np.float64]

# Directions of the votes: an icosahedron's corners, turned so that none runs along an axis of a
# room (rays in a plane of triangles count them wrongly).
_GOLDEN = (1 + 5**0.5) / 2
_CORNERS = np.array([(0, 1, _GOLDEN), (1, _GOLDEN, 0), (_GOLDEN, 0, 1), (0, -1, _GOLDEN)])
_TURN = np.linalg.qr(np.array([[0.3, 0.9, 0.2], [-0.8, 0.4, 0.5], [0.2, -0.1, 0.9]]))[0]
DIRECTIONS = np.concatenate([_CORNERS, -_CORNERS]) / np.sqrt(1 + _GOLDEN**2) @ _TURN

# Rays that look for an opening: one that takes 1/2048 of what the lamp sees is found as a rule.
OPENING_RAYS = 2048
# Lift of what they hit before it is looked at, as a share of the ray's length.
LIFT = 1e-4


def is_buried(point: Float, eye: Float, geometry: Geometry, /) -> bool:
    """`point` (3,) is on the other side of closed surfaces than `eye` (3,), both in metres.

    Rays from a point to infinity cross closed surfaces an even number of times outside and an odd
    number inside. All eight directions must agree for both points; where surfaces are open they
    rarely do. Where they do by chance, a light at `point` must also reach nothing that `eye` sees:
    a lamp before a window or a missing wall is not buried.
    """
    scene = RayScene(geometry)
    own = scene.crossings(point, DIRECTIONS) % 2
    camera = scene.crossings(eye, DIRECTIONS) % 2
    unanimous = own.min() == own.max() and camera.min() == camera.max()
    if not unanimous or own[0] == camera[0]:
        return False
    return not _lights_something_seen(scene, point, eye)


def _lights_something_seen(scene: RayScene, point: Float, eye: Float) -> bool:
    directions = _all_around(OPENING_RAYS)
    hits = scene.first_hits(np.broadcast_to(point, directions.shape), directions)
    lit = hits.triangle >= 0
    lit_points = point + directions[lit] * (hits.distance[lit, None] * (1 - LIFT))
    return bool(scene.is_visible(lit_points, eye).any())


def _all_around(count: int) -> Float:
    """(count, 3) unit directions, evenly spread (a Fibonacci lattice)."""
    index = np.arange(count) + 0.5
    height, turn = 1 - 2 * index / count, 2 * np.pi * index / _GOLDEN
    radius = np.sqrt(1 - height**2)
    return np.column_stack([radius * np.cos(turn), radius * np.sin(turn), height])
