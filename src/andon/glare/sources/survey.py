"""What a picture holds, in tiles: enough to know the ambient level and where anything is bright."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.quantities import photometric
from andon.spaces import View

__all__ = ["SIDE_PX", "Survey", "ambient_level", "survey", "tile_solid_angles"]

Float = NDArray[np.float64]

# Of a tile. A byte a pixel and more would be read back with smaller ones.
SIDE_PX = 8


@dataclass(frozen=True, eq=False)
class Survey:
    """Photometric luminance of tiles of 8×8 pixels; those at the border may be smaller.

    Attributes
    ----------
    mean : (r, c) over a tile's pixels.
    peak : (r, c) of its brightest pixel.
    """

    mean: Float
    peak: Float


def survey(luminance: Float, /) -> Survey:
    """The tiles of a picture (H, W, 3) ≥ 0."""
    value = photometric(luminance)
    count = _blocks(np.ones(value.shape)).sum(axis=(1, 3))
    tiles = _blocks(value)
    return Survey(tiles.sum(axis=(1, 3)) / count, tiles.max(axis=(1, 3)))


def ambient_level(luminance: Float, solid_angle_sr: Float, contrast: float, /) -> float:
    """The a that is the mean of luminance (...) cut at `contrast`·a: what frames are held against.

    The mean of what is *not* brighter than that, which serves for single pictures, has two
    solutions while a source of some 2 % of the view grows, and jumps between them. This one is
    unique, and changes no faster than the light does. 0 where all but 1/contrast of it is dark.
    """
    order = np.argsort(-luminance, axis=None)
    value, weight = luminance.ravel()[order], solid_angle_sr.ravel()[order]
    # With the k brightest cut: a·Σω = Σ L·ω of the others + contrast·a·ω of those.
    others = np.cumsum((value * weight)[::-1])[::-1]
    room = weight.sum() - contrast * (np.cumsum(weight) - weight)
    fits = (room > 0) & (contrast * others >= value * room)
    return float(others[np.argmax(fits)] / room[np.argmax(fits)]) if fits.any() else 0.0


def tile_solid_angles(view: View, /) -> Float:
    """(r, c) sr of each tile."""
    return _blocks(view.solid_angles()).sum(axis=(1, 3))


def _blocks(values: Float) -> Float:
    """(r, 8, c, 8) of (H, W), zeros beyond the border."""
    rows, columns = (-(-size // SIDE_PX) for size in values.shape)
    padded = np.zeros((rows * SIDE_PX, columns * SIDE_PX))
    padded[: values.shape[0], : values.shape[1]] = values
    return padded.reshape(rows, SIDE_PX, columns, SIDE_PX)
