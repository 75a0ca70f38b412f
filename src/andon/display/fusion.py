"""Exposure fusion: one picture in which every part is taken from where it is well exposed.

Mertens, Kautz & Van Reeth 2007: each pixel of each exposure is weighted by its contrast (absolute
Laplacian), its saturation (spread of the channels) and how well it is exposed (a Gaussian around
½, σ = 0.2), all to the power of 1; the weighted mean is taken band by band in Laplacian pyramids.
Done by OpenCV, whose exposure weight is 0 by default: all three are stated here.

======================  =============================================================
instead                 why not
======================  =============================================================
weighted mean           seams and halos where weights jump; the pyramids are there for this
HDR merge, tone curve   needs times and a response; a global curve flattens local contrast
======================  =============================================================

As a tone (`fused_codes`) it is given simulated photographs of one frame behind the neutral filters
of 100, 50, 25, 12.5 and 6.25 % of the paper on gaze and glass. The brightest is the frame's own
exposure: nothing gets lighter than a photograph shows it, night stays night, and up to 16 times
white is brought back. Identity is *not* kept, not even inside the range: every exposure keeps some
weight everywhere, so all parts get darker, bright ones most.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.display.model import Exposure
from andon.responses import Response

__all__ = ["FILTERS", "fuse", "fused_codes"]

# Transmittances of the neutral filters through which the paper photographs.
FILTERS = (1.0, 0.5, 0.25, 0.125, 0.0625)


def fuse(exposures: Sequence[NDArray[Any]], /) -> NDArray[np.uint8]:
    """One picture (H, W, 3) uint8 from several of the same scene and size.

    `exposures`: (H, W, 3) uint8, or float encoded values in [0, 1]; the order does not matter.
    Alike pictures give that picture; a single one is itself.

    Source: Mertens, Kautz & Van Reeth 2007, equations 1 to 6, weights C = S = E = 1.
    """
    import cv2

    # OpenCV divides by 255 whatever the type is, and takes its contrast of BGR.
    scales = (1.0 if picture.dtype == np.uint8 else 255.0 for picture in exposures)
    pictures = [
        np.ascontiguousarray(picture[..., ::-1], np.float32) * np.float32(scale)
        for picture, scale in zip(exposures, scales, strict=True)
    ]
    fused = np.asarray(cv2.createMergeMertens(1, 1, 1).process(pictures), np.float32)
    # The pyramids over- and undershoot beside edges.
    return np.asarray(np.clip(fused[..., ::-1], 0, 1) * 255 + 0.5, np.uint8)


def fused_codes(
    luminance_cd_m2: NDArray[Any],
    exposure: Exposure,
    response: Response,
    luminance_per_unit: float,
    /,
) -> NDArray[np.uint8]:
    """(H, W, 3) uint8 from luminance (H, W, 3) in cd/m²: `FILTERS` fused, encoded by `response`.

    Float codes go into the fusion, so that five roundings do not show as bands.
    """
    scale = exposure.units_per_cd_m2 or 1 / luminance_per_unit
    linear = np.asarray(luminance_cd_m2, np.float64) * scale
    return fuse([response.encode(np.clip(linear * share, 0, 1)) for share in FILTERS])
