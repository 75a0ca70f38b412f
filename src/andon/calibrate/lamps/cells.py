"""Pictures as means over small squares: what the fit looks at.

Means of linear light are linear light, so nothing is lost of a model that is linear; noise, which
would bias a product of two photographs, and small misalignment are. Pixels at the white end of the
reference have cells of their own: of them only the least that they were is known.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Cells", "cells_of"]

Float = NDArray[np.float64]
Mask = NDArray[np.bool_]

# Side of the squares at least, and of squares at most.
LEAST_SIDE_PX = 2
MOST_CELLS = 100_000


@dataclass(frozen=True, eq=False)
class Cells:
    """Which pixels make which cells.

    Attributes
    ----------
    side_px : of the squares.
    open, white : (H, W, 3) bool, pixels whose reference is a number, and those at its white end.
    counts : (n, 3) pixels of each cell; those of open pixels come first, then those at the end.
    is_white : (n,) bool.
    rows, columns : (n,) of the square of each cell.
    kept : (2, h, w) bool, squares that have any pixel, of both sorts.
    """

    side_px: int
    open: Mask
    white: Mask
    counts: Float
    is_white: Mask
    rows: NDArray[np.intp]
    columns: NDArray[np.intp]
    kept: Mask

    def of(self, picture: Float, /) -> Float:
        """(n, 3) means of a picture (H, W, 3); 0 of channels that a cell has no pixel of."""
        sums = [
            _sums(np.where(member, picture, 0), self.side_px)[kept]
            for member, kept in zip((self.open, self.white), self.kept, strict=True)
        ]
        return np.concatenate(sums) / np.maximum(self.counts, 1)


def cells_of(open_: Mask, white: Mask, /) -> Cells:
    """Cells of pixels (H, W, 3) whose reference is a number, and of those at its white end."""
    pixels = open_.shape[0] * open_.shape[1]
    side = max(LEAST_SIDE_PX, int(np.ceil(np.sqrt(pixels / MOST_CELLS))))
    counts = [_sums(member.astype(np.float64), side) for member in (open_, white)]
    kept = np.stack([count.any(axis=-1) for count in counts])
    places = [np.nonzero(mask) for mask in kept]
    return Cells(
        side,
        open_,
        white,
        np.concatenate([count[mask] for count, mask in zip(counts, kept, strict=True)]),
        np.repeat([False, True], [len(place[0]) for place in places]),
        np.concatenate([place[0] for place in places]),
        np.concatenate([place[1] for place in places]),
        kept,
    )


def _sums(picture: Float, side: int) -> Float:
    """(h, w, 3) sums over squares; those at the right and lower edge may be smaller."""
    height, width = (-(-length // side) for length in picture.shape[:2])
    whole = np.zeros((height * side, width * side, 3))
    whole[: picture.shape[0], : picture.shape[1]] = picture
    return whole.reshape(height, side, width, side, 3).sum(axis=(1, 3))
