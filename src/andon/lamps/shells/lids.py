"""Openings of a shell as flat polygons."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.lamps.polygons import vector_area

__all__ = ["fan", "flat_lid"]

Float = NDArray[np.float64]

# Corners of a lid: a circle as so many corners is a circle within 1.2 % of its radius.
MAX_CORNERS = 20


def fan(loop: Float, /) -> Float:
    """Triangles (k, 3, 3) from the middle of a loop (k, 3) to its edges."""
    middle = np.broadcast_to(loop.mean(axis=0), loop.shape)
    return np.stack([middle, loop, np.roll(loop, -1, axis=0)], axis=1)


def flat_lid(loop: Float, /) -> Float:
    """A flat polygon (≤ 20, 3) with the vector area of a loop (k, 3).

    It lies in the plane through the loop's middle whose normal is the vector area's: what a
    diffuse lid sends afar depends on the vector area alone, however the rim bends.
    """
    area = vector_area(loop)
    size = np.linalg.norm(area)
    normal = area / size
    middle = loop.mean(axis=0)
    flat = loop - np.outer((loop - middle) @ normal, normal)
    while len(flat) > MAX_CORNERS:
        before, after = np.roll(flat, 1, axis=0), np.roll(flat, -1, axis=0)
        cut_off = np.abs(np.cross(flat - before, after - before) @ normal)
        # The first of equals, not the one that rounding prefers.
        least = np.flatnonzero(cut_off <= (1 + 1e-6) * cut_off.min())[0]
        flat = np.delete(flat, least, axis=0)
    kept = float(vector_area(flat) @ normal)
    return middle + (flat - middle) * np.sqrt(size / kept) if kept > 0 else flat
