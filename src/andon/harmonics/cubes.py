"""Cube maps: where their texels look, and how much of the sphere each of them is.

Faces +X, −X, +Y, −Y, +Z, −Z in the layout of OpenGL, KTX and three.js, world axes. Row 0 lies at
v = −1, column 0 at u = −1; seen from inside, side faces are mirrored::

         v = −1                 +X (1, −v, −u)     −X (−1, −v, u)
      ┌──────────┐              +Y (u, 1, v)       −Y (u, −1, −v)
      │ ─▷ u     │ row 0        +Z (u, −v, 1)      −Z (−u, −v, −1)
      │ ▽ v      │
      └──────────┘

Source: OpenGL 4.6 core profile, table 8.19 (cube map coordinates).
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError

__all__ = [
    "MAX_CUBE_SIZE",
    "SolidAngle",
    "check_cube_size",
    "cube_directions",
    "cube_solid_angles",
    "face_directions",
]

Float = NDArray[np.float64]
SolidAngle = Literal["exact", "paper"]

# Of a face, in pixels: the directions of such a cube are 150 MB.
MAX_CUBE_SIZE = 1024


def check_cube_size(size: int, /) -> None:
    """Refuses sizes outside 1…1024 px."""
    if not 1 <= size <= MAX_CUBE_SIZE:
        raise InputError(f"must be 1…{MAX_CUBE_SIZE} px, got {size}", field="cube size")


def _centres(size: int) -> Float:
    check_cube_size(size)
    return np.asarray((np.arange(size) + 0.5) * (2 / size) - 1, np.float64)


def face_directions(u: Float, v: Float, /) -> Float:
    """(6, ..., 3) directions on the cube of half side 1, not normalised, at (u, v) in −1…1."""
    u, v = np.broadcast_arrays(u, v)
    one = np.ones_like(u)
    faces = [
        (one, -v, -u),
        (-one, -v, u),
        (u, one, v),
        (u, -one, -v),
        (u, -v, one),
        (-u, -v, -one),
    ]
    return np.stack([np.stack(face, axis=-1) for face in faces])


def cube_directions(size: int, /) -> Float:
    """(6, size, size, 3) unit directions, world, through the texel centres; `size` in
    1…1024 px.
    """
    at = _centres(size)
    directions = face_directions(at[None, :], at[:, None])
    length: Float = np.linalg.norm(directions, axis=-1, keepdims=True)
    return directions / length


def cube_solid_angles(size: int, /, kind: SolidAngle = "exact") -> Float:
    """(size, size) solid angle of the texels of one face in sr; all faces have the same.

    exact: of the four corners, q(x, y) = atan2(xy, √(x² + y² + 1)); six faces sum to 4π.
    paper: (4/size²)/(1 + u² + v²)^{3/2} at the centre, the capture paper's; its worst texel,
    once the sum is 4π, is off by 1.0e-2 of its value at 8 px and by 4.6e-5 at 128 px.
    """
    if kind == "paper":
        at = _centres(size)
        square = 1 + at[None, :] ** 2 + at[:, None] ** 2
        return (4 / size**2) / (square * np.sqrt(square))
    if kind == "exact":
        check_cube_size(size)
        edge = np.arange(size + 1) * (2 / size) - 1
        x, y = edge[None, :], edge[:, None]
        corner = np.arctan2(x * y, np.sqrt(x * x + y * y + 1))
        return np.diff(np.diff(corner, axis=0), axis=1)
    raise InputError(f"must be 'exact' or 'paper', got {kind!r}", field="solid_angle")
