"""Depth of fewer pixels than the picture: the sensors of phones have 256×192 for 1920×1440.

============ ================================ ===============================================
method       of a slanted wall                of an edge
============ ================================ ===============================================
nearest      steps; their normals face you    sharp
linear in z  bent between the samples         smeared: points in the air
this one     exact: 1/z of a plane is affine  sharp: no mean over a jump, the nearest instead
             in the pixels, and so is linear
============ ================================ ===============================================
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["ASPECT_TOLERANCE", "SAME_PICTURE", "resampled", "same_aspect"]

Float = NDArray[np.float64]

# Two pictures of one camera: sides of a scaled picture are rounded, to whole pixels or to 8 or 14.
ASPECT_TOLERANCE = 0.02
# What to do about a depth of other sides.
SAME_PICTURE = (
    "give depth and camera of one picture; the depth may have fewer pixels, but the same sides"
)


def same_aspect(a: tuple[int, int], b: tuple[int, int], /) -> bool:
    """Whether pictures of shapes (height, width) can show the same, but for the rounding."""
    return any(
        abs(height - width * other[0] / other[1]) <= max(1, ASPECT_TOLERANCE * height)
        for (height, width), other in ((a, b), (b, a))
    )


def resampled(depth: Float, shape: tuple[int, int], /, *, max_jump: float = 0.05) -> Float:
    """Depth (H, W) of `shape` from depth (h, w) in metres > 0, NaN in holes.

    1/z is interpolated between four samples of which none is a hole and the farthest at most
    (1 + max_jump) times as far as the nearest; elsewhere a pixel has its nearest sample, so holes
    and edges stay where they are to half a sample. Pictures share their outer borders: pixel
    centres are at integers, as in `View.resized`.
    """
    rows, row_share, near_rows = _places(depth.shape[0], shape[0])
    columns, column_share, near_columns = _places(depth.shape[1], shape[1])
    below = np.minimum(rows + 1, depth.shape[0] - 1)
    right = np.minimum(columns + 1, depth.shape[1] - 1)
    corners = [depth[np.ix_(r, c)] for r in (rows, below) for c in (columns, right)]
    v, u = row_share[:, None], column_share[None, :]
    weights = [(1 - v) * (1 - u), (1 - v) * u, v * (1 - u), v * u]
    # NaN where a corner is a hole: those are no surface, by the comparison.
    joined = np.maximum.reduce(corners) <= (1 + max_jump) * np.minimum.reduce(corners)
    inverse = np.zeros(shape)
    for weight, corner in zip(weights, corners, strict=True):
        inverse += weight / corner
    nearest = depth[np.ix_(near_rows, near_columns)]
    # Continued beyond the border, a steep enough slope would end at infinity.
    with np.errstate(divide="ignore"):
        return np.where(joined & (inverse > 0), 1 / inverse, nearest)


def _places(old: int, new: int) -> tuple[NDArray[np.intp], Float, NDArray[np.intp]]:
    """Of `new` pixels along a side: the sample before each, how far beyond it, the nearest."""
    at = (np.arange(new) + 0.5) * old / new - 0.5
    # Half a sample at either border is continued from the outer two.
    before = np.clip(np.floor(at).astype(np.intp), 0, max(old - 2, 0))
    nearest = np.clip(np.floor(at + 0.5).astype(np.intp), 0, old - 1)
    return before, at - before, nearest
