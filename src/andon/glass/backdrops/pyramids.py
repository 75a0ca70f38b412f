"""Pictures sampled with a footprint: mean of what a pixel covers, from coarser and coarser copies.

::

    level 0   │ 0 │ 1 │ 2 │ 3 │ 4 │        texel i of level k covers [i·2ᵏ, (i + 1)·2ᵏ) of level 0;
    level 1   │ 0   1 │ 2   3 │ 4   4 │    beyond the border the last column counts again
    level 2   │       0       │    1  …

A step of one pixel moves the place in the picture by the columns of a 2×2 matrix J. A pixel covers
an ellipse with the half axes of J's singular values s₁ ≥ s₂. Refraction at the rim of a ball
stretches them by 10 and more, so one round footprint is wrong either way: of diameter s₂ it
aliases along the major axis, of s₁ it blurs across it. `TAPS` round ones lie side by side along the
major axis instead, each of diameter max(s₁/TAPS, s₂); what is longer than TAPS·s₂ is blurred, since
aliasing flickers and blur does not. (Heckbert 1989 has the ellipse; Williams 1983 the pyramid.)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["MAX_LEVEL", "TAPS", "Pyramid", "levels_of", "pyramid", "sampled"]

Float = NDArray[np.float64]

# Of the coarsest level: a texel of 256² pixels. What is minified more has lost its contrast.
MAX_LEVEL = 8
# Footprints along the major axis.
TAPS = 2
# Squared singular values are kept below: (a picture's width)² and more is all of it.
MOST_SQUARED = 1e10


@dataclass(frozen=True)
class Pyramid:
    """A picture and its coarser copies.

    Attributes
    ----------
    levels : of them, (h, w, c) float; level k is ⌈h/2ᵏ⌉ × ⌈w/2ᵏ⌉.
    """

    levels: tuple[NDArray[Any], ...]

    @property
    def shape(self) -> tuple[int, int]:
        """(h, w) of the finest level."""
        return self.levels[0].shape[0], self.levels[0].shape[1]


def levels_of(width: int, height: int, /) -> int:
    """The coarsest level of a picture: 1 texel, or `MAX_LEVEL`."""
    return min(MAX_LEVEL, (max(width, height) - 1).bit_length())


def pyramid(picture: NDArray[Any], /) -> Pyramid:
    """A pyramid of means of 2×2 texels; `picture` (h, w, c) is its finest level."""
    levels = [picture]
    for _ in range(levels_of(picture.shape[1], picture.shape[0])):
        fine = levels[-1]
        odd = (fine.shape[0] % 2, fine.shape[1] % 2)
        even = np.pad(fine, ((0, odd[0]), (0, odd[1]), (0, 0)), mode="edge")
        rows = even[::2] + even[1::2]
        levels.append((rows[:, ::2] + rows[:, 1::2]) * 0.25)
    return Pyramid(tuple(levels))


def sampled(
    source: Pyramid, places: Float, steps: Float, /, *, repeats: tuple[bool, bool] = (False, False)
) -> Float:
    """(n, c) means of what n pixels cover.

    `places` (n, 2) column and row, texel *centres* at integers; `steps` (n, 2, 2): [:, k] is how
    far the place moves for a step of one pixel along axis k. `repeats`: columns, rows begin again
    at the border; else the last one goes on.
    """
    major, squared = _major_axis(steps)
    level = np.clip(0.5 * np.log2(np.maximum(squared, 1.0)), 0, len(source.levels) - 1)
    total = np.zeros((len(places), source.levels[0].shape[2]))
    for tap in range(TAPS):
        total += _trilinear(source, places + ((tap + 0.5) / TAPS - 0.5) * major, level, repeats)
    return total / TAPS


def _major_axis(steps: Float) -> tuple[Float, Float]:
    """(n, 2) the longer axis of the footprint, and (n,) the square of a tap's diameter."""
    a, b = steps[:, 0], steps[:, 1]
    xx, yy, xy = (a[:, i] * a[:, j] + b[:, i] * b[:, j] for i, j in ((0, 0), (1, 1), (0, 1)))
    half, mean = 0.5 * (xx - yy), 0.5 * (xx + yy)
    spread = np.hypot(half, xy)
    longest = np.minimum(mean + spread, MOST_SQUARED)
    shortest = np.maximum(mean - spread, 0)
    wide = (xx >= yy)[:, None]
    axis = np.where(
        wide, np.stack([spread + half, xy], axis=1), np.stack([xy, spread - half], axis=1)
    )
    length = np.linalg.norm(axis, axis=1, keepdims=True)
    axis = np.divide(axis, length, out=np.zeros_like(axis), where=length > 0)
    return axis * np.sqrt(longest)[:, None], np.maximum(longest / TAPS**2, shortest)


def _trilinear(source: Pyramid, places: Float, level: Float, repeats: tuple[bool, bool]) -> Float:
    result = np.zeros((len(places), source.levels[0].shape[2]))
    fine = np.minimum(np.floor(level).astype(np.int64), max(len(source.levels) - 2, 0))
    for index in np.unique(fine):
        rows = np.flatnonzero(fine == index)
        mix = (level[rows] - index)[:, None]
        low = _bilinear(source, int(index), places[rows], repeats)
        high = low
        if index + 1 < len(source.levels):
            high = _bilinear(source, int(index) + 1, places[rows], repeats)
        result[rows] = (1 - mix) * low + mix * high
    return result


def _bilinear(source: Pyramid, level: int, places: Float, repeats: tuple[bool, bool]) -> Float:
    texels = source.levels[level]
    at = (places + 0.5) / (1 << level) - 0.5
    first = np.floor(at).astype(np.int64)
    share = at - first
    sizes = (texels.shape[1], texels.shape[0])

    def index(axis: int, step: int) -> NDArray[np.int64]:
        place = first[:, axis] + step
        if repeats[axis]:
            return np.asarray(place % sizes[axis], np.int64)
        return np.clip(place, 0, sizes[axis] - 1)

    x, y = share[:, :1], share[:, 1:]
    top = texels[index(1, 0), index(0, 0)] * (1 - x) + texels[index(1, 0), index(0, 1)] * x
    bottom = texels[index(1, 1), index(0, 0)] * (1 - x) + texels[index(1, 1), index(0, 1)] * x
    return np.asarray(top * (1 - y) + bottom * y, np.float64)
