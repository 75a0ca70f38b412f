"""How the camera moved between the photograph and its reference.

A lamp that is switched on changes ranks and edges of a picture, but not its fine structure. So
both are compared after their local mean and contrast are taken off; the motion is the one with the
largest correlation (Evangelidis & Psarakis 2008), from where the phases of their spectra agree
or from rest, whichever is better.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from andon.capture.align import at_scale, corner_motion_px

__all__ = ["Aligning", "Motion", "camera_motion"]

Float = NDArray[np.float64]
Single = NDArray[np.float32]
Mask = NDArray[np.bool_]
Aligning = Literal["auto", "none"]

# As of brackets (`capture.align`): fractions of a pixel are still found at this scale.
WORKING_SIDE = 1024
# What a motion below moves is blurred more by looking it up than it is off.
STILL_PX = 0.5
# Of the local mean and contrast, in pixels at the working scale: finer than shadows of lamps,
# coarser than what ECC's own filter leaves. The floor is the contrast of noise, encoded.
LOCAL_PX, LOCAL_FLOOR = 6.0, 0.01
ECC_STEPS, ECC_END, ECC_FILTER_PX = 200, 1e-7, 5
# Below it the two pictures have too little in common to tell any motion.
LEAST_CORRELATION = 0.2
STILL = np.eye(2, 3)


@dataclass(frozen=True, eq=False)
class Motion:
    """The motion that was found.

    Attributes
    ----------
    matrix : (2, 3) pixel of the reference from pixel of the photograph; the identity where it
        rests, moves less than `STILL_PX`, or cannot be told.
    corner_px : how far the corner that moves most was found to move.
    correlation : of the fine structure of both after the motion, −1…1; NaN where nobody looked.
    is_told : the two have enough in common to tell.
    """

    matrix: Float
    corner_px: float
    correlation: float
    is_told: bool

    @property
    def is_still(self) -> bool:
        """The reference stays as it is."""
        return bool((self.matrix == STILL).all())


NOT_ASKED = Motion(STILL, 0.0, float("nan"), False)


def camera_motion(photograph: Float, reference: Float, seen: Mask, /) -> Motion:
    """The motion between two grey pictures (H, W), encoded 0…1.

    `seen` (H, W) are pixels that both show.
    """
    import cv2

    scale = min(1.0, WORKING_SIDE / max(photograph.shape))
    near, far = (_fine(_scaled(grey, scale)) for grey in (photograph, reference))
    both = np.asarray(_scaled(seen.astype(np.float64), scale) > 1 - 1e-3, np.uint8)
    start = max((STILL, _shift(near, far)), key=lambda m: _agreement(near, far, both, m))
    criteria = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, ECC_STEPS, ECC_END)
    try:
        found = cv2.findTransformECC(
            near, far, start.astype(np.float32), cv2.MOTION_AFFINE, criteria, both, ECC_FILTER_PX
        )[1]
    except cv2.error:  # it did not converge: the start is the best that is known
        found = start
    matrix = np.asarray(found, np.float64)
    best = max((STILL, start, matrix), key=lambda m: _agreement(near, far, both, m))
    correlation = _agreement(near, far, both, best)
    if correlation < LEAST_CORRELATION:
        return Motion(STILL, 0.0, correlation, False)
    whole = at_scale(best, 1 / scale)
    away = corner_motion_px(whole, photograph.shape)
    return Motion(STILL if away < STILL_PX else whole, away, correlation, True)


def _scaled(grey: Float, scale: float) -> Single:
    import cv2

    single = grey.astype(np.float32)
    if scale == 1:
        return single
    shrunk = cv2.resize(single, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    return np.asarray(shrunk, np.float32)


def _fine(grey: Single) -> Single:
    """The picture without its local mean and contrast."""
    import cv2

    above = grey - cv2.GaussianBlur(grey, (0, 0), LOCAL_PX)
    contrast = np.sqrt(np.maximum(cv2.GaussianBlur(above * above, (0, 0), LOCAL_PX), 0))
    return np.asarray(above / (contrast + LOCAL_FLOOR), np.float32)


def _shift(near: Single, far: Single) -> Float:
    import cv2

    window = cv2.createHanningWindow(near.shape[::-1], cv2.CV_32F)
    # OpenCV lays its window over the pictures themselves where their size suits it.
    x, y = cv2.phaseCorrelate(near.copy(), far.copy(), window)[0]
    return np.array([[1.0, 0, x], [0, 1.0, y]])


def _agreement(near: Single, far: Single, both: NDArray[np.uint8], matrix: Float) -> float:
    """Correlation of what both show after the motion."""
    import cv2

    size, flags = (near.shape[1], near.shape[0]), cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    moved = np.asarray(cv2.warpAffine(far, matrix, size, flags=flags))
    cover = np.asarray(cv2.warpAffine(both.astype(np.float32), matrix, size, flags=flags))
    inside = (both > 0) & (cover > 1 - 1e-3)
    if inside.sum() < inside.size / 4:
        return -1.0
    a, b = near[inside] - near[inside].mean(), moved[inside] - moved[inside].mean()
    return float((a @ b) / max(float(np.sqrt((a @ a) * (b @ b))), 1e-12))
