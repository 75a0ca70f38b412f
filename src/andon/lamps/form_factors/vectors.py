"""Dot products and quotients that stay finite."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["Float", "dot", "frame", "quotient"]

Float = NDArray[np.float64]


def dot(a: Float, b: Float, /) -> Float:
    """Σ a·b along the last axis, broadcast."""
    return np.sum(a * b, axis=-1)


def quotient(a: Float, b: Float, /) -> Float:
    """a/b, and 0 where b is 0."""
    return np.divide(a, b, out=np.zeros(np.broadcast_shapes(a.shape, b.shape)), where=b != 0)


def frame(axis: Float, /) -> tuple[Float, Float]:
    """Two unit vectors (..., 3) perpendicular to unit `axis` (..., 3) and to one another."""
    helper = np.where(np.abs(axis[..., :1]) < 0.6, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0])
    first: Float = np.cross(axis, helper)
    first = first / np.sqrt(dot(first, first))[..., None]
    return first, np.asarray(np.cross(axis, first), np.float64)
