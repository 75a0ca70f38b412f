"""Flat polygons as triangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError

__all__ = ["check_flat", "polygon_triangles"]

Float = NDArray[np.float64]

# A corner may lie this share of the polygon's size beside its plane.
FLATNESS = 1e-3


def check_flat(vertices: Float, /) -> float:
    """Area in m² of a polygon (k, 3). Raises `InputError` if it has none, or is not flat."""
    relative = vertices - vertices.mean(axis=0)
    size = float(np.linalg.norm(relative, axis=1).max())
    double = np.cross(relative, np.roll(relative, -1, axis=0)).sum(axis=0)
    area = float(np.linalg.norm(double)) / 2
    if not area > 1e-9 * size**2:
        raise InputError("has no area", field="vertices", remedy="give corners in order")
    beside = float(np.abs(relative @ (double / (2 * area))).max())
    if beside > FLATNESS * size:
        raise InputError(
            f"is not flat: a corner lies {beside:.3g} m beside its plane",
            field="vertices",
            remedy="use several polygons, or kind 'mesh'",
        )
    return area


def polygon_triangles(vertices: Float, /) -> NDArray[np.int32]:
    """Triangles (k − 2, 3) of a simple polygon (k, 3), wound like it, by cutting off ears.

    Raises `InputError` for one that crosses itself.
    """
    relative = vertices - vertices.mean(axis=0)
    double = np.cross(relative, np.roll(relative, -1, axis=0)).sum(axis=0)
    normal = double / max(float(np.linalg.norm(double)), np.finfo(float).tiny)
    left = list(range(len(vertices)))
    ears: list[tuple[int, int, int]] = []
    while len(left) > 3:
        at = _ear(vertices[left], normal)
        ears.append((left[at - 1], left[at], left[(at + 1) % len(left)]))
        del left[at]
    ears.append((left[0], left[1], left[2]))
    triangles = np.array(ears, np.int32)
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    spanned = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()
    if not np.isclose(spanned, np.linalg.norm(double), rtol=1e-6):
        raise _crossing()
    return triangles


def _ear(ring: Float, normal: Float) -> int:
    """Number of a corner of `ring` (k, 3) whose triangle holds no other corner."""
    before, after = np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0)
    turn = np.cross(ring - before, after - ring) @ normal
    tolerance = 1e-12 * float(np.abs(turn).max())
    straight = np.flatnonzero(np.abs(turn) <= tolerance)
    if len(straight):
        return int(straight[0])
    for at in np.flatnonzero(turn > 0).tolist():
        corners = np.stack([before[at], ring[at], after[at]])
        others = np.delete(ring, [(at - 1) % len(ring), at, (at + 1) % len(ring)], axis=0)
        sides = [
            np.cross(corners[(k + 1) % 3] - corners[k], others - corners[k]) @ normal
            for k in range(3)
        ]
        if not (np.min(sides, axis=0) >= -tolerance).any():
            return at
    raise _crossing()


def _crossing() -> InputError:
    return InputError("crosses itself", field="vertices", remedy="give corners in order")
