"""The common lampshade as triangles: a cylinder or cone, open above and below."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.lamps.shells.model import Drum
from andon.quantities import Geometry

__all__ = ["drum_mesh", "rim_loop"]

Float = NDArray[np.float64]


def drum_mesh(drum: Drum, around: int, along: int, wider: float = 1.0, /) -> Geometry:
    """`around` × `along` flat panels about the lamp at the origin, outside counter-clockwise.

    Normals are the cone's own. Radii are `wider` times the drum's.
    """
    turn, share = np.meshgrid(
        np.linspace(0, 2 * np.pi, around, endpoint=False), np.linspace(0, 1, along + 1)
    )
    radius = wider * (drum.radius_m + share * (drum.top_radius_m - drum.radius_m))
    height = share * drum.height_m - drum.drop_m
    points = np.stack([radius * np.sin(turn), height, radius * np.cos(turn)], axis=-1)
    # Across the cone's slant.
    rise = wider * (drum.radius_m - drum.top_radius_m) / drum.height_m
    normals = np.stack([np.sin(turn), np.full_like(turn, rise), np.cos(turn)], axis=-1)
    normals /= np.sqrt(1 + rise**2)
    column, row = np.meshgrid(np.arange(around), np.arange(along))
    first, after = row * around + column, row * around + (column + 1) % around
    corners = [first, after, after + around, first, after + around, first + around]
    triangles = np.stack(corners, axis=-1).reshape(-1, 3).astype(np.int32)
    return Geometry(points.reshape(-1, 3), triangles, normals.reshape(-1, 3))


def rim_loop(drum: Drum, around: int, wider: float = 1.0, /, *, above: bool) -> Float:
    """(around, 3) the upper or the lower rim, counter-clockwise as seen from outside."""
    turn = np.linspace(0, 2 * np.pi, around, endpoint=False)
    radius = wider * (drum.top_radius_m if above else drum.radius_m)
    height = drum.height_m - drum.drop_m if above else -drum.drop_m
    loop = np.stack([radius * np.sin(turn), np.full(around, height), radius * np.cos(turn)], axis=1)
    return loop if above else loop[::-1]
