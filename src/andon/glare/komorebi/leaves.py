"""What is seen of the leaves where the sun does not shine through."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["behind_gaps", "lit_leaves"]

Float = NDArray[np.float64]

# Light through a leaf, as a share of the sky's; photometric value 1 in sum of shares.
GREEN = np.array([0.45, 1.25, 0.15])
# Of one leaf, and of many behind one another.
THIN, THICK = 0.28, 0.035
# Leaves lie over one another deeper inside, over this share of the picture's height.
DEEPER = 0.03


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


def lit_leaves(gaps: NDArray[np.bool_], sky_cd_m2: float, /) -> Float:
    """(H, W, 3) cd/m² of leaves against the light, thin beside the gaps and thick farther off."""
    import cv2

    off = cv2.distanceTransform(np.asarray(~gaps, np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
    thin = np.exp(-np.asarray(off, np.float64) / (DEEPER * len(gaps)))
    share = THICK + (THIN - THICK) * thin
    # Light that passed several leaves is greener: red goes first.
    hue = GREEN ** (1 + 0.5 * (1 - thin[..., None]))
    return sky_cd_m2 * share[..., None] * hue
