"""All pictures of a scene's glass in one: backdrops and stickers, with their coarser levels.

Rectangles stand on shelves, tallest first; each is as wide as level 0 and 1 beside each other, and
as high as level 0, rounded up to 2^levels (pyramids.wgsl draws it). What does not fit is halved,
the largest first, as often as it takes: the picture is less sharp then, and `notes` say so.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.glass.backdrops.pyramids import Pyramid, levels_of, pyramid
from andon.glass.model import Solid

__all__ = ["MOST_TEXELS", "Atlas", "Rectangle", "make_atlas", "premultiplied", "spread_levels"]

Float32 = NDArray[np.float32]

# 128 MB as half floats: two backdrops of 2048² and some stickers.
MOST_TEXELS = 1 << 24
# The largest half float.
MOST_LIGHT = 65504.0


@dataclass(frozen=True)
class Rectangle:
    """Where level 0 lies, in texels, and the coarsest level."""

    column: int
    row: int
    width: int
    height: int
    levels: int

    @property
    def extent(self) -> tuple[int, int]:
        """Columns and rows of all levels together."""
        columns = self.width + ((self.width + 1) >> 1 if self.levels else 0)
        return columns, -(-self.height >> self.levels) << self.levels


@dataclass(frozen=True)
class Atlas:
    """Packed pictures.

    Attributes
    ----------
    texels : (h, w, 4) float32; texel (0, 0) is 0: what a body without a picture has.
    backdrops, stickers : of each body.
    notes : what was made smaller.
    """

    texels: Float32
    backdrops: tuple[Rectangle, ...]
    stickers: tuple[Rectangle, ...]
    notes: tuple[str, ...] = ()


def premultiplied(picture: NDArray[Any], /) -> NDArray[Any]:
    """A sticker (h, w, 4) with reflectance times cover, so that means of it are right."""
    return np.concatenate([picture[..., :3] * picture[..., 3:], picture[..., 3:]], axis=2)


def make_atlas(solids: Sequence[Solid], side_limit: int, /) -> Atlas:
    """The pictures of `solids` in a square of at most `side_limit` texels a side."""
    pictures: dict[tuple[int, str], NDArray[Any]] = {}
    for index, solid in enumerate(solids):
        if solid.backdrop.picture is not None:
            pictures[index, "backdrop"] = _four(solid.backdrop.picture)
        if solid.sticker is not None:
            pictures[index, "sticker"] = premultiplied(solid.sticker.picture)
    notes: list[str] = []
    while True:
        places, size = _shelved(pictures, side_limit)
        if max(size) <= side_limit and size[0] * size[1] <= MOST_TEXELS:
            break
        key = max(pictures, key=lambda key: pictures[key].shape[0] * pictures[key].shape[1])
        height, width = pictures[key].shape[:2]
        pictures[key] = pyramid(pictures[key]).levels[1]
        name = f"{solids[key[0]].name}: the {key[1]}'s picture of {width}×{height}"
        notes.append(f"{name} is halved, all pictures exceed {side_limit} px or 2²⁴ texels")
    texels = np.zeros((size[1], size[0], 4), np.float32)
    for key, place in places.items():
        spread_levels(texels, place, pyramid(pictures[key]))
    empty = Rectangle(0, 0, 1, 1, 0)
    found = (
        tuple(places.get((index, kind), empty) for index in range(len(solids)))
        for kind in ("backdrop", "sticker")
    )
    return Atlas(texels, *found, notes=tuple(notes))


def _four(picture: NDArray[Any]) -> NDArray[Any]:
    return np.concatenate([picture, np.ones((*picture.shape[:2], 1), picture.dtype)], axis=2)


def _shelved(
    pictures: dict[tuple[int, str], NDArray[Any]], side_limit: int
) -> tuple[dict[tuple[int, str], Rectangle], tuple[int, int]]:
    """Rectangle of each picture; columns and rows of the whole. The first shelf is texel (0, 0)."""
    found: dict[tuple[int, str], Rectangle] = {}
    column, row, shelf, widest = 1, 0, 1, 1
    for key in sorted(pictures, key=lambda key: -pictures[key].shape[0]):
        height, width = pictures[key].shape[:2]
        place = Rectangle(0, 0, width, height, levels_of(width, height))
        columns, rows = place.extent
        if column > 1 and column + columns > side_limit:
            column, row, shelf = 0, row + shelf, 0
        found[key] = Rectangle(column, row, width, height, place.levels)
        column, shelf = column + columns, max(shelf, rows)
        widest = max(widest, column)
    return found, (widest, row + shelf)


def spread_levels(texels: NDArray[Any], place: Rectangle, source: Pyramid, /) -> None:
    """Writes all levels of a picture into `texels` (h, w, 4), where `place` says."""
    padded = place.extent[1]
    for level, picture in enumerate(source.levels):
        row = place.row + (padded - (2 * padded >> level) if level else 0)
        column = place.column + (place.width if level else 0)
        height, width = picture.shape[:2]
        texels[row : row + height, column : column + width] = np.clip(picture, 0, MOST_LIGHT)
