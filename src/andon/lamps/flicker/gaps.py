"""Gaps of a mask: where light comes through, and how much of it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.pictures import Picture, read_picture
from andon.quantities import photometric

__all__ = ["GapMap", "gaps_of", "is_open", "read_gaps"]

# Lighter than this share of white, of light and not of codes, is open.
OPEN = 0.5
# More are noise, not gaps.
MOST_GAPS = 100_000


@dataclass(frozen=True, eq=False)
class GapMap:
    """The gaps of one mask.

    Attributes
    ----------
    labels : (H, W) int32: 0 closed, else 1 + the gap's number.
    pixels : (n,) of each gap, n ≥ 1, in the order in which rows meet them.
    middles : (n, 2) x, y of each in pixels.
    """

    labels: NDArray[np.int32]
    pixels: NDArray[np.int64]
    middles: NDArray[np.float64]


def gaps_of(open_pixels: NDArray[np.bool_], /) -> GapMap:
    """Groups of open pixels that touch at an edge or a corner.

    Raises `InputError` where nothing is open, or more than `MOST_GAPS` are.
    """
    import cv2

    count, labels, facts, middles = cv2.connectedComponentsWithStats(
        np.asarray(open_pixels, np.uint8), connectivity=8, ltype=cv2.CV_32S
    )
    if count == 1:
        raise InputError("has no gap: nothing is white", field="mask")
    if count - 1 > MOST_GAPS:
        raise InputError(f"has {count - 1} gaps, at most {MOST_GAPS} are held", field="mask")
    return GapMap(
        np.asarray(labels, np.int32),
        np.asarray(facts[1:, cv2.CC_STAT_AREA], np.int64),
        np.asarray(middles[1:], np.float64),
    )


def is_open(mask: Picture, /) -> NDArray[np.bool_]:
    """(H, W) whether a picture's pixels are open: its light is at least half of white."""
    return photometric(mask.linear()) >= OPEN


def read_gaps(path: Path, /) -> GapMap:
    """The gaps of a mask file. Raises `InputError` as `gaps_of`, with the file's name."""
    try:
        return gaps_of(is_open(read_picture(path)))
    except InputError as error:
        if error.file is not None:
            raise
        raise InputError(error.rule, file=path) from error
