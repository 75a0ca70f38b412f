"""Narrow gaps of a depth image closed, where its user asks for it.

Two sorts of gaps let light through that nothing let through in the room::

    ───────┐  ┌────     holes: rims of things, dark and shiny ones, where nothing was measured.
     wall  │▒▒│ wall    Their surface goes on from the farther rim, in 1/z, which is linear
           └──┘         over a plane.
    ═══════   ═════     what a thing hides: the table behind the stem of a lamp has no
     table  ▐▌ table    triangles, and the lamp over it shines on the floor. For shadows the
                        table goes on there.

Both are guesses, along rows or columns, whichever gap is narrower, and only as wide as is stated.
A hole at the picture's border has one rim, and that one goes on.
"""

from __future__ import annotations

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from andon.quantities import Geometry
from andon.spaces import View
from andon.surface.triangulate import triangulate_depth

__all__ = ["filled", "hidden_behind"]

Float = NDArray[np.float64]
Int = NDArray[np.int64]

# A slope is that of so many pixels from the rim inwards: over fewer it is noise.
SLOPE_PX = 8
# What is deeper by this share is behind something; less is noise of the same surface. Not a jump:
# where the stem meets the table its skirts leave no cut, but a tent, in which the lamp stands.
DEEPER = 0.015


def filled(depth: Float, widest_px: int, /, *, max_jump: float) -> Float:
    """Depth (H, W) in metres whose holes of up to `widest_px` across have a depth, too."""
    inverse = 1 / depth
    rows, row_gap = _along_rows(inverse, max_jump)
    columns, column_gap = (x.T for x in _along_rows(inverse.T, max_jump))
    by_row = row_gap <= column_gap
    value = np.where(by_row, rows, columns)
    narrow = np.where(by_row, row_gap, column_gap) <= widest_px
    with np.errstate(invalid="ignore"):
        taken = np.isnan(depth) & narrow & (value > 0)
    return np.where(taken, 1 / np.where(taken, value, 1.0), depth)


def _along_rows(inverse: Float, max_jump: float) -> tuple[Float, Int]:
    """Of each pixel: 1/z by the rims of its hole in its row, and the hole's width in pixels.

    Rims of one surface are joined by a line; else the farther one goes on.
    """
    height, width = inverse.shape
    column = np.indices(inverse.shape)[1]
    known = np.isfinite(inverse)
    left = np.maximum.accumulate(np.where(known, column, -1), axis=1)
    open_right = np.array(np.where(known, column, width), np.intp)
    right = np.minimum.accumulate(open_right[:, ::-1], axis=1)[:, ::-1]
    start, end = np.clip(left, 0, None), np.clip(right, None, width - 1)
    first, last = (np.take_along_axis(inverse, at, axis=1) for at in (start, end))
    ahead = np.take_along_axis(_slopes(inverse, max_jump), start, axis=1)
    back = np.take_along_axis(_slopes(inverse[:, ::-1], max_jump)[:, ::-1], end, axis=1)
    across = end - start
    with np.errstate(invalid="ignore"):
        # A surface that is seen at a slant gets farther by more than a jump within a hole.
        joined = _alike(first, last, max_jump)
        joined |= _alike(first + across * ahead, last, max_jump)
        joined |= _alike(last + across * back, first, max_jump)
        line = first + (column - start) / np.maximum(across, 1) * (last - first)
        on_left = first + (column - start) * ahead
        on_right = last + (end - column) * back
        from_left = (left >= 0) & ((right == width) | (first < last))
        one_side: Float = np.asarray(np.where(from_left, on_left, on_right), np.float64)
        value: Float = np.asarray(np.where(joined, line, one_side), np.float64)
    gap = np.where((left >= 0) | (right < width), right - left - 1, width + height)
    return value, gap


def _alike(a: Float, b: Float, max_jump: float) -> NDArray[np.bool_]:
    return np.asarray(np.maximum(a, b) <= (1 + max_jump) * np.minimum(a, b), bool)


def _slopes(inverse: Float, max_jump: float) -> Float:
    """(H, W) change of 1/z a pixel on the surface that ends there, from its left; 0 if unknown."""
    back = np.full_like(inverse, np.nan)
    back[:, SLOPE_PX:] = inverse[:, :-SLOPE_PX]
    with np.errstate(invalid="ignore"):
        whole = np.pad(_alike(inverse[:, 1:], inverse[:, :-1], max_jump), ((0, 0), (1, 0)))
        steps = np.cumsum(whole, axis=1)
        same = np.zeros(inverse.shape, bool)
        same[:, SLOPE_PX:] = steps[:, SLOPE_PX:] - steps[:, :-SLOPE_PX] == SLOPE_PX
    return np.where(same, (inverse - back) / SLOPE_PX, 0.0)


def hidden_behind(depth: Float, view: View, widest_px: int, /, *, max_jump: float) -> Geometry:
    """Triangles, in the world, of what things of up to `widest_px` across hide of a surface that
    is on both sides of them.

    Along each row and column the nearer of the two sides goes on: a closing of the depth (Serra
    1982) with a line as its element; of row and column the farther.
    """
    known = np.where(np.isfinite(depth), depth, 0.0)
    behind = np.maximum(_closed(known, widest_px), _closed(known.T, widest_px).T)
    hidden = behind > (1 + DEEPER) * known
    whole = np.where(hidden, behind, depth)
    return triangulate_depth(np.where(_touched(hidden), whole, np.nan), view, max_jump=max_jump)


def _closed(values: Float, width: int) -> Float:
    """(H, W) the closing of each row by a segment of `width` + 1 pixels; no wider gap is closed."""
    size = width + 1
    highest = sliding_window_view(np.pad(values, ((0, 0), (size - 1, size - 1))), size, axis=1)
    return sliding_window_view(highest.max(axis=-1), size, axis=1).min(axis=-1)


def _touched(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """(H, W) pixels that are in `mask`, or one of whose eight neighbours is."""
    padded = np.pad(mask, 1)
    return np.logical_or.reduce(sliding_window_view(padded, (3, 3)), axis=(2, 3))
