"""Hand-held brackets brought into one frame.

Each photograph is compared with its neighbour in exposure, whose codes are the most alike, and the
steps are put together towards the middle one.

==========  ===================================================  ==================================
method      finds                                                source
==========  ===================================================  ==================================
shift       whole pixels: the better of bitmaps of what is       Ward 2003
            brighter than the median and of phase correlation,
            if it is better than none
ecc         shift and turn, to fractions of a pixel, by the      Evangelidis & Psarakis 2008
            correlation of ranks (which a response keeps)
**auto**    ecc from where shift ends, where the ranks then
            agree clearly better than at rest; what moves the
            corners by less than half a pixel stays as it is
==========  ===================================================  ==================================

Not found: parallax between near and far things, and things that move by themselves.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal, TypeVar

import numpy as np
from numpy.typing import NDArray

from andon.capture.brackets import Bracket
from andon.errors import InputError

__all__ = [
    "ALIGNMENTS",
    "Alignment",
    "Move",
    "align",
    "at_scale",
    "corner_motion_px",
    "moved_picture",
]

Value = TypeVar("Value", np.uint8, np.float32)
Alignment = Literal["auto", "none", "shift", "ecc"]
ALIGNMENTS = ("auto", "none", "shift", "ecc")

# ECC works at this many pixels of the longer side: fractions of a pixel are still found, in a
# second a photograph.
WORKING_SIDE = 1024
STILL_PX = 0.5
# Ward's pyramid of 6 levels finds up to 2⁶ pixels.
PYRAMID_LEVELS = 6
ECC_STEPS, ECC_END = 100, 1e-6
# Of `auto`: a motion has to explain this share of what the ranks at rest disagree by (resampling
# alone explains up to a third, by averaging noise), and to leave this share of the picture in both.
LEAST_GAIN = 0.5
LEAST_SHARE = 0.25


@dataclass(frozen=True)
class Move:
    """How a photograph was moved to lie on the reference.

    Attributes
    ----------
    matrix : (2, 3) pixel of this photograph from pixel of the reference.
    shift_px : (x, y) at the middle of the picture, of what it shows against the reference.
    turn_degrees : positive is clockwise on the screen.
    """

    matrix: NDArray[np.float64]
    shift_px: tuple[float, float]
    turn_degrees: float

    @property
    def is_still(self) -> bool:
        """It stays as it is."""
        return bool((self.matrix == STILL).all())


STILL = np.eye(2, 3)


def align(bracket: Bracket, method: Alignment, /) -> tuple[Bracket, tuple[Move, ...]]:
    """The bracket in the frame of its middle photograph, and how each was moved.

    Raises `InputError` where `ecc` finds no agreement between neighbours.
    """
    order, middle = bracket.order, bracket.order.index(bracket.middle)
    shape = bracket.codes[0].shape[:2]
    moves = {bracket.middle: STILL}
    if method != "none":
        for chain in (order[middle:], order[middle::-1]):
            for near, far in pairwise(chain):
                step = _step(_Pair(bracket, near, far), method, bracket.names[far])
                moves[far] = _product(step, moves[near])
    found = [moves.get(i, STILL) for i in range(len(bracket.codes))]
    if method == "auto":
        found = [STILL if corner_motion_px(m, shape) < STILL_PX else m for m in found]
    codes, seen = zip(
        *(
            moved_picture(c, s, m)
            for c, s, m in zip(bracket.codes, bracket.seen, found, strict=True)
        ),
        strict=True,
    )
    return replace(bracket, codes=codes, seen=seen), tuple(_described(m, shape) for m in found)


class _Pair:
    """Two neighbours in exposure as grey pictures, and as ranks at the working scale."""

    def __init__(self, bracket: Bracket, near: int, far: int) -> None:
        import cv2

        self.greys = [
            np.asarray(cv2.cvtColor(bracket.codes[i], cv2.COLOR_RGB2GRAY), np.uint8)
            for i in (near, far)
        ]
        self.scale = min(1.0, WORKING_SIDE / max(self.greys[0].shape))
        small = [_scaled(grey, self.scale) for grey in self.greys]
        self.seen = [
            _scaled(255 * bracket.seen[i].astype(np.uint8), self.scale) == 255 for i in (near, far)
        ]
        self.ranks = [_ranks(grey, seen) for grey, seen in zip(small, self.seen, strict=True)]

    def agreement(self, matrix: NDArray[np.float64]) -> float:
        """Correlation of the ranks with the second photograph moved by `matrix`, −1…1."""
        near, far = self.ranks
        moved, seen = moved_picture(far, self.seen[1], at_scale(matrix, self.scale))
        both = self.seen[0] & seen
        if both.sum() < LEAST_SHARE * both.size:
            return -1.0
        a, b = near[both] - near[both].mean(), moved[both] - moved[both].mean()
        return float((a @ b) / max(np.sqrt((a @ a) * (b @ b)), 1e-12))


def _step(pair: _Pair, method: Alignment, name: str) -> NDArray[np.float64]:
    """(2, 3) pixel of the second photograph from pixel of the first."""
    import cv2

    still = pair.agreement(STILL)
    # Bitmaps of a nearly black photograph are of its noise, and give any shift.
    start = max((STILL, *_shifts(pair)), key=pair.agreement)
    if method == "shift":
        return start
    try:
        found = _by_correlation(pair, start)
    except cv2.error as error:
        if method == "auto":
            return _if_better(pair, start, still)
        raise InputError(
            "cannot be aligned: it shows too little of what its neighbour in exposure shows",
            file=name,
            field="--align",
            remedy="use --align shift, or none for photographs from a tripod",
        ) from error
    if method == "ecc":
        return found
    return _if_better(pair, max((start, found), key=pair.agreement), still)


def _if_better(pair: _Pair, matrix: NDArray[np.float64], still: float) -> NDArray[np.float64]:
    """The motion, if it explains enough of the disagreement at rest; else none."""
    gained = (pair.agreement(matrix) - still) / max(1 - still, 1e-12)
    return matrix if gained > LEAST_GAIN else STILL


def _shifts(pair: _Pair) -> list[NDArray[np.float64]]:
    """Whole shifts that may be: by Ward's bitmaps, and by the phases of the ranks' spectra."""
    import cv2

    x, y = cv2.createAlignMTB(PYRAMID_LEVELS).calculateShift(*pair.greys)
    near, far = pair.ranks
    window = cv2.createHanningWindow(near.shape[::-1], cv2.CV_32F)
    # OpenCV lays its window over the pictures themselves where their size suits it.
    moved = np.array(cv2.phaseCorrelate(near.copy(), far.copy(), window)[0]) / pair.scale
    return [np.array([[1.0, 0, dx], [0, 1.0, dy]]) for dx, dy in ((-x, -y), np.round(moved))]


def _by_correlation(pair: _Pair, start: NDArray[np.float64]) -> NDArray[np.float64]:
    import cv2

    warp = at_scale(start, pair.scale).astype(np.float32)
    criteria = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, ECC_STEPS, ECC_END)
    # OpenCV's mask is of the second picture.
    mask = pair.seen[1].astype(np.uint8)
    _, found = cv2.findTransformECC(
        pair.ranks[0], pair.ranks[1], warp, cv2.MOTION_EUCLIDEAN, criteria, mask, 5
    )
    return at_scale(np.asarray(found, np.float64), 1 / pair.scale)


def _scaled(grey: NDArray[np.uint8], scale: float) -> NDArray[np.uint8]:
    import cv2

    if scale == 1:
        return grey
    return np.asarray(
        cv2.resize(grey, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA), np.uint8
    )


def at_scale(matrix: NDArray[np.float64], scale: float, /) -> NDArray[np.float64]:
    """The same motion in a picture scaled by `scale`; pixel centres are at integers."""
    linear, half = matrix[:, :2], np.full(2, 0.5)
    # x' + ½ = scale·(x + ½): the middle of the first pixel is not the picture's corner.
    offset = scale * (linear @ -half + matrix[:, 2] + half) + linear @ half - half
    return np.column_stack([linear, offset])


def _ranks(grey: NDArray[np.uint8], seen: NDArray[np.bool_]) -> NDArray[np.float32]:
    """Share of pixels that are darker, 0…1: the same whatever the response and the exposure."""
    counts = np.bincount(grey[seen], minlength=256)
    share = (np.cumsum(counts) - 0.5 * counts) / max(counts.sum(), 1)
    return np.where(seen, share[grey], 0.5).astype(np.float32)


def _product(second: NDArray[np.float64], first: NDArray[np.float64]) -> NDArray[np.float64]:
    """The motion `first`, then `second`."""
    whole = np.vstack([second, [0, 0, 1]]) @ np.vstack([first, [0, 0, 1]])
    return whole[:2]


def corner_motion_px(matrix: NDArray[np.float64], shape: tuple[int, ...], /) -> float:
    """How far a motion (2, 3) moves the corner of a picture (height, width) that it moves most."""
    height, width = shape
    corners = np.array([[0, 0], [width - 1, 0], [0, height - 1], [width - 1, height - 1]], float)
    return float(np.linalg.norm(corners @ matrix[:, :2].T + matrix[:, 2] - corners, axis=1).max())


def moved_picture(
    codes: NDArray[Value], seen: NDArray[np.bool_], matrix: NDArray[np.float64], /
) -> tuple[NDArray[Value], NDArray[np.bool_]]:
    """A picture and what it saw, looked up at `matrix` (2, 3) × pixel."""
    import cv2

    if (matrix == STILL).all():
        return codes, seen
    size = (codes.shape[1], codes.shape[0])
    is_whole = (matrix[:, :2] == np.eye(2)).all() and (matrix[:, 2] == np.round(matrix[:, 2])).all()
    kind = cv2.INTER_NEAREST if is_whole else cv2.INTER_LINEAR
    moved = cv2.warpAffine(codes, matrix, size, flags=kind | cv2.WARP_INVERSE_MAP)
    # A pixel that takes any part of its light from beyond the edge or from a border saw nothing.
    cover = cv2.warpAffine(seen.astype(np.float32), matrix, size, flags=kind | cv2.WARP_INVERSE_MAP)
    return np.asarray(moved, codes.dtype), np.asarray(cover) > 1 - 1e-3


def _described(matrix: NDArray[np.float64], shape: Sequence[int]) -> Move:
    middle = np.array([(shape[1] - 1) / 2, (shape[0] - 1) / 2])
    x, y = (matrix[:, :2] @ middle + matrix[:, 2] - middle).tolist()
    turn = float(np.degrees(np.arctan2(matrix[1, 0], matrix[0, 0])))
    return Move(matrix, (x, y), turn)
