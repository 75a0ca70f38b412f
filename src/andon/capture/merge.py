"""From a bracket to light: the camera's response, and the radiance of each pixel.

============================  ====================================================================
choice                        why not the other
============================  ====================================================================
**own least squares**         OpenCV's takes pixels of a regular grid, whatever they show: borders,
                              clipped ones and what moved are in its equations
**response recovered**        sRGB assumed errs by up to a factor of 2 in the shadows of cameras
                              that make their pictures pleasing
**per channel**               a common curve colours film, whose layers differ
============================  ====================================================================

The unit: code 128 of the reference photograph (the middle one) is the linear value that sRGB gives
it, 0.216, in each channel. So grey stays grey, and the picture is what `capture` makes of the
reference, only without its clipping. It is relative: nothing in a bracket says how bright 1 is.

Sources: Debevec & Malik 1997, equations 4 to 6; Mann & Picard 1995 for the weight of certainty.
The response is found by `recovery`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.capture.brackets import Bracket
from andon.capture.recovery import CODES, MIDDLE, certainty_of, recover_curves, seconds_of
from andon.responses import Response, srgb_decode

__all__ = ["Merged", "merge"]

Float = NDArray[np.float64]


@dataclass(frozen=True)
class Merged:
    """The light of a bracket.

    Attributes
    ----------
    linear : (H, W, 3) float32, relative; see the module for the unit. 0 where nothing was seen.
    response : the camera's, recovered, per channel.
    clipped_share, black_share : share of pixels with a channel that is white (or black) in every
        photograph: only a lower (or upper) bound of it is known, and stands there.
    unseen_share : share of pixels that are border in every photograph.
    range_ratio : 99.9th to 0.1st percentile of luminance over all pixels seen.
    """

    linear: NDArray[np.float32]
    response: Response
    clipped_share: float
    black_share: float
    unseen_share: float
    range_ratio: float


def merge(bracket: Bracket, /) -> Merged:
    """The light of each pixel: the mean over its photographs, weighted by how certain they are.

    The weight of a code is `certainty_of` it. `check_exposures` must have passed.
    """
    recovery = recover_curves(bracket)
    curves, seconds = recovery.curves, seconds_of(bracket)
    planes = [_merged_channel(bracket, curves[:, c], seconds, c) for c in range(3)]
    light = np.stack([plane[0] for plane in planes], axis=-1)
    seen = np.logical_or.reduce(list(bracket.seen))
    scale = seconds[bracket.middle] * float(srgb_decode(np.array(MIDDLE / 255)))
    linear = np.where(seen[..., None], light * scale, 0.0)
    luminance = (linear @ [0.2126, 0.7152, 0.0722])[seen]
    low, high = np.percentile(luminance, [0.1, 99.9])
    states = [np.logical_or.reduce([plane[k] for plane in planes]) & seen for k in (1, 2)]
    return Merged(
        linear.astype(np.float32),
        recovery.response,
        float(states[0].mean()),
        float(states[1].mean()),
        float(1 - seen.mean()),
        float(high / max(low, 1e-30)),
    )


def _merged_channel(
    bracket: Bracket, curve: Float, seconds: Float, channel: int
) -> tuple[Float, NDArray[np.bool_], NDArray[np.bool_]]:
    """Light of one channel (H, W), and where only a bound of it is known: from below, above."""
    certainty = certainty_of(curve)
    shape = bracket.codes[0].shape[:2]
    weight, total = np.zeros(shape), np.zeros(shape)
    least, most = np.full(shape, np.inf), np.full(shape, -np.inf)
    for codes, seen, t in zip(bracket.codes, bracket.seen, seconds, strict=True):
        plane = codes[..., channel]
        w = np.where(seen, certainty[plane], 0.0)
        weight += w
        total += w * (curve[plane] - np.log(t))
        white, black = seen & (plane == CODES - 1), seen & (plane == 0)
        # The shortest that is white bounds from below, the longest that is black from above.
        most = np.where(white, np.maximum(most, curve[-1] - np.log(t)), most)
        least = np.where(black, np.minimum(least, curve[0] - np.log(t)), least)
    known = weight > 0
    is_white, is_black = (
        ~known & np.isfinite(most),
        ~known & ~np.isfinite(most) & np.isfinite(least),
    )
    bound = np.where(is_white, most, np.where(is_black, least, -np.inf))
    logs = np.where(known, total / np.where(known, weight, 1.0), bound)
    return np.exp(logs), is_white, is_black
