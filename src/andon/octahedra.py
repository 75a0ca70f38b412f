"""Square pictures of all directions: the octahedral map.

::

    y ▲ ┌───────┐    The sphere is pressed onto an octahedron (|x| + |y| + |z| = 1) and its lower
      │ │ ╱ − ╲ │    half, z < 0, is folded out into the corners of the square. Crossing an edge
      │ │╱  +  ╲│    of the square at e leads to the place that mirrors e on the same edge.
      │ │╲     ╱│
      │ │ ╲ − ╱ │    Rows run along y, columns along x, texel centres at (index + ½).
        └───────┘ ▶ x

Cigolle et al. 2014, section 2; `andon/gpu/octahedral.wgsl` has the same map.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["bilinear_taps", "directions_of", "square_of"]

Float = NDArray[np.float64]


def square_of(directions: Float, /) -> Float:
    """(..., 2) in [−1, 1]² of directions (..., 3), of any length but 0."""
    size = np.abs(directions).sum(axis=-1, keepdims=True)
    flat = directions[..., :2] / size
    return np.asarray(np.where(directions[..., 2:] >= 0, flat, _folded(flat)), np.float64)


def directions_of(places: Float, /) -> Float:
    """Unit directions (..., 3) of places (..., 2) in [−1, 1]²."""
    z = 1 - np.abs(places).sum(axis=-1, keepdims=True)
    direction = np.concatenate([np.where(z >= 0, places, _folded(places)), z], axis=-1)
    length: Float = np.linalg.norm(direction, axis=-1, keepdims=True)
    return direction / length


def _folded(places: Float) -> Float:
    """What lies inside goes out into the corners, and back."""
    return (1 - np.abs(places[..., ::-1])) * np.where(places >= 0, 1.0, -1.0)


def bilinear_taps(directions: Float, side: int, /) -> tuple[NDArray[np.int64], Float]:
    """The four texels around each direction, as flat indices, and their weights.

    Parameters
    ----------
    directions : (..., 3), of any length but 0.
    side : texels along an edge of the square.

    Returns
    -------
    (..., 4) indices row · side + column, and (..., 4) weights that sum to 1; continuous across
    the edges of the square.
    """
    at = (square_of(directions) + 1) * (side / 2) - 0.5
    first = np.floor(at).astype(np.int64)
    x, y = np.moveaxis(at - first, -1, 0)
    column, row = np.moveaxis(first, -1, 0)
    indices = [_wrapped(row + dy, column + dx, side) for dy in (0, 1) for dx in (0, 1)]
    weights = [(1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y]
    return np.stack(indices, axis=-1), np.stack(weights, axis=-1)


def _wrapped(row: NDArray[np.int64], column: NDArray[np.int64], side: int) -> NDArray[np.int64]:
    """Flat index of a texel that may lie one step outside the square."""
    across = (row < 0) | (row >= side)
    column = np.where(across, side - 1 - column, column)
    row = np.clip(row, 0, side - 1)
    beside = (column < 0) | (column >= side)
    row = np.where(beside, side - 1 - row, row)
    return row * side + np.clip(column, 0, side - 1)
