"""Which triangles a face sees: most of a room is behind any one of the six."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["face_triangles"]


def face_triangles(
    positions: NDArray[np.float32], triangles: NDArray[np.int32], lamp: NDArray[np.float32], /
) -> list[NDArray[np.int32]]:
    """For each of the six faces around `lamp` (3,), the numbers (k,) of triangles it may see.

    A triangle is left out if all its corners lie outside one side of the face's pyramid. Vertex
    work is what a shadow map costs on a software rasteriser; this halves it and more.
    """
    offset = positions - lamp
    faces: list[NDArray[np.int32]] = []
    for axis in range(3):
        x, y, along = (offset[:, (axis + k) % 3] for k in (1, 2, 0))
        for z in (along, -along):
            outside = (x > z) * np.uint8(1)
            outside |= (x < -z) * np.uint8(2)
            outside |= (y > z) * np.uint8(4)
            outside |= (y < -z) * np.uint8(8)
            corners = outside[triangles]
            inside = (corners[:, 0] & corners[:, 1] & corners[:, 2]) == 0
            faces.append(np.flatnonzero(inside).astype(np.int32))
    return faces
