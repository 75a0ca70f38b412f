"""Flat polygons as triangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.lamps.triangles import triangle_areas

__all__ = ["check_flat", "polygon_triangles", "vector_area"]

Float = NDArray[np.float64]

# A corner may lie this share of the polygon's size beside its plane.
FLATNESS = 1e-3


def vector_area(loop: Float, /) -> Float:
    """(3,) area of any surface that spans a loop (k, 3), along its mean normal, in m² (Newell)."""
    relative = loop - loop.mean(axis=0)
    return np.cross(relative, np.roll(relative, -1, axis=0)).sum(axis=0) / 2


def check_flat(vertices: Float, /) -> float:
    """Area in m² of a polygon (k, 3). Raises `InputError` if it has none, or is not flat."""
    relative = vertices - vertices.mean(axis=0)
    size = float(np.linalg.norm(relative, axis=1).max())
    along = vector_area(vertices)
    area = float(np.linalg.norm(along))
    if not area > 1e-9 * size**2:
        raise InputError("has no area", field="vertices", remedy="give corners in order")
    beside = float(np.abs(relative @ (along / area)).max())
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
    along = vector_area(vertices)
    area = float(np.linalg.norm(along))
    normal = along / max(area, np.finfo(float).tiny)
    left = list(range(len(vertices)))
    ears: list[tuple[int, int, int]] = []
    while len(left) > 3:
        at = _ear(vertices[left], normal)
        ears.append((left[at - 1], left[at], left[(at + 1) % len(left)]))
        del left[at]
    ears.append((left[0], left[1], left[2]))
    triangles = np.array(ears, np.int32)
    if not np.isclose(triangle_areas(vertices[triangles]).sum(), area, rtol=1e-6):
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
