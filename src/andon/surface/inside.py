"""Is a lamp inside a wall?"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.quantities import Geometry
from andon.rays import RayScene

__all__ = ["is_buried"]

# Directions of the votes: an icosahedron's corners, turned so that none runs along an axis of a
# room (rays in a plane of triangles count them wrongly).
_GOLDEN = (1 + 5**0.5) / 2
_CORNERS = np.array([(0, 1, _GOLDEN), (1, _GOLDEN, 0), (_GOLDEN, 0, 1), (0, -1, _GOLDEN)])
_TURN = np.linalg.qr(np.array([[0.3, 0.9, 0.2], [-0.8, 0.4, 0.5], [0.2, -0.1, 0.9]]))[0]
DIRECTIONS = np.concatenate([_CORNERS, -_CORNERS]) / np.sqrt(1 + _GOLDEN**2) @ _TURN


def is_buried(point: NDArray[np.float64], eye: NDArray[np.float64], geometry: Geometry, /) -> bool:
    """`point` (3,) is on the other side of closed surfaces than `eye` (3,), both in metres.

    Rays from a point to infinity cross closed surfaces an even number of times outside and an odd
    number inside. All eight directions must agree for both points; where surfaces are open they do
    not, and nothing is claimed.
    """
    scene = RayScene(geometry)
    own = scene.crossings(point, DIRECTIONS) % 2
    camera = scene.crossings(eye, DIRECTIONS) % 2
    unanimous = own.min() == own.max() and camera.min() == camera.max()
    return bool(unanimous and own[0] != camera[0])
