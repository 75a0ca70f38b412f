"""How noisy a photograph is, by itself: what stays where nothing is drawn.

A 3×3 mask that edges and slopes leave at zero is laid over the picture (Immerkær 1996). Of the
pixels of like brightness, those in the flattest quarter of their surroundings are taken, and of
what the mask finds there the median: texture that is left would show in a mean. One spread for each
of 16 ranges of codes, since noise grows with light and compression with detail.

It sees noise that changes from pixel to pixel: a camera that smooths its pictures hides a part.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.quantities import CameraFrame

__all__ = ["noise_codes"]

Float = NDArray[np.float64]

MASK = np.array([[1.0, -2, 1], [-2, 4, -2], [1, -2, 1]])
RANGES = 16
# Of a range of codes: fewer pixels tell nothing, and the flattest of them are taken.
LEAST_PIXELS, FLATTEST = 400, 0.25
# Median of |x| of a normal distribution, in its σ.
MEDIAN_OF_NORMAL = 0.6745


def noise_codes(frame: CameraFrame, /) -> Float:
    """(H, W, 3) standard deviation of each captured value, as an encoded value (1 is white).

    At least that of the rounding to codes, step/√12, which is in what is measured. Floats have
    none that can be told from texture: 0. A picture without a flat part has that of its rounding.
    """
    if frame.code_step == 0:
        return np.zeros(frame.linear.shape)
    encoded = np.asarray(frame.response.encode(np.asarray(frame.linear, np.float64)), np.float64)
    planes = [_channel(encoded[..., c], frame.code_step) for c in range(3)]
    return np.stack(planes, axis=-1)


def _channel(encoded: Float, step: float) -> Float:
    import cv2

    found = np.abs(cv2.filter2D(encoded, -1, MASK, borderType=cv2.BORDER_REFLECT_101))
    found = np.asarray(found, np.float64) / np.sqrt((MASK**2).sum())
    # Flatness is told from means, in which the noise that is sought hardly shows.
    smooth = np.asarray(cv2.blur(encoded, (5, 5)), np.float64)
    steep = np.hypot(cv2.Sobel(smooth, -1, 1, 0), cv2.Sobel(smooth, -1, 0, 1))
    level = np.clip(smooth * RANGES, 0, RANGES - 1).astype(np.int64)
    # What is cut off at black or white has no noise to show.
    inside = (smooth > 2 * step) & (smooth < 1 - 2 * step)
    rounding = step / np.sqrt(12)
    middles: list[float] = []
    sigmas: list[float] = []
    for number in range(RANGES):
        own = inside & (level == number)
        if np.count_nonzero(own) < LEAST_PIXELS:
            continue
        flat = own & (steep <= np.quantile(steep[own], FLATTEST))
        middles.append(float(smooth[flat].mean()))
        sigmas.append(float(np.median(found[flat])) / MEDIAN_OF_NORMAL)
    if not middles:
        return np.full(encoded.shape, rounding)
    return np.maximum(np.interp(smooth, middles, sigmas), rounding)
