"""Rotations as unit quaternions (x, y, z, w): matrices of them, and what lies between two."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["rotation_matrices", "slerp"]

Float = NDArray[np.float64]

# Below this angle between two quaternions sin θ loses digits, and the straight way is as good: it
# is off by the order of θ³, below what float64 tells apart.
STRAIGHT_RADIANS = 1e-5


def rotation_matrices(quaternions: Float, /) -> Float:
    """(..., 3, 3) of quaternions (..., 4), normalised first; none may be 0."""
    unit = quaternions / np.linalg.norm(quaternions, axis=-1, keepdims=True)
    x, y, z, w = np.moveaxis(unit, -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


def slerp(first: Float, second: Float, share: float, /) -> Float:
    """(..., 4) unit quaternions at `share` 0…1 of the shorter way between two (..., 4).

    At a constant rate on the great circle (Shoemake, "Animating rotation with quaternion curves",
    1985). Of two that are opposite, q and −q are the same rotation: there is no way to go.
    """
    a: Float = first / np.linalg.norm(first, axis=-1, keepdims=True)
    other: Float = second / np.linalg.norm(second, axis=-1, keepdims=True)
    cosine: Float = np.einsum("...i,...i->...", a, other)[..., None]
    b: Float = np.where(cosine < 0, -other, other)
    # atan2 of half chords keeps small angles exact, where acos loses half the digits.
    chord: Float = np.linalg.norm(b - a, axis=-1, keepdims=True)
    middle: Float = np.linalg.norm(b + a, axis=-1, keepdims=True)
    angle = 2 * np.arctan2(chord, middle)
    curved = angle > STRAIGHT_RADIANS
    sine = np.where(curved, np.sin(angle), 1.0)
    before = np.where(curved, np.sin((1 - share) * angle) / sine, 1 - share)
    after = np.where(curved, np.sin(share * angle) / sine, share)
    blended: Float = before * a + after * b
    return blended / np.linalg.norm(blended, axis=-1, keepdims=True)
