"""What is seen of the leaves where the sun does not shine through."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.glare.komorebi.foliage import foliage

__all__ = ["behind_gaps", "lit_leaves"]

Float = NDArray[np.float64]

# Through what lies over all that is drawn, so that a mask's leaves have no gaps but the mask's.
LEAST_COVER = np.array([0.13, 0.25, 0.03])
# Leaves are lit from below as well, by what is around.
AROUND = 0.008 * np.array([0.7, 1.0, 0.5])


def behind_gaps(light: Float, gaps: NDArray[np.bool_], /) -> Float:
    """The picture (H, W, 3) with its gaps closed: by leaves like those around each.

    The mean of what is no gap, weighted by a Gaussian that is as wide as it has to be.
    """
    import cv2

    closed = light.copy()
    grown = cv2.dilate(np.asarray(gaps, np.uint8), np.ones((3, 3), np.uint8)) > 0
    known = np.asarray(~grown, np.float64)
    missing = gaps.copy()
    sigma = 2.0
    while missing.any() and sigma < max(light.shape):
        weight = cv2.GaussianBlur(known, (0, 0), sigma)
        mean = cv2.GaussianBlur(light * known[..., None], (0, 0), sigma)
        found = missing & (weight > 1e-2)
        closed[found] = mean[found] / weight[found][:, None]
        missing &= ~found
        sigma *= 2
    return closed


def lit_leaves(shape: tuple[int, int], sky_cd_m2: float, /) -> Float:
    """(H, W, 3) cd/m² of leaves against the light, without a gap."""
    through = np.minimum(foliage(shape[1], shape[0]), LEAST_COVER)
    return sky_cd_m2 * (through + AROUND)
