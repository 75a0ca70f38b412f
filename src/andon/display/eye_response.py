"""Pictures for print of light that spans many decades: as the cones answer to it.

::

    R = Lⁿ/(Lⁿ + σⁿ)        L luminance, σ that of half the response, n = 0.74

The curve of Naka & Rushton is steep nowhere and flat only at its ends, so that a lamp, its halo and
the wall behind it, four decades apart, keep their differences in one picture where a camera's curve
leaves white blobs. Each channel by itself, as each kind of cone, so what is very bright pales.
Equal steps of sRGB codes look about equal, as equal steps of the response do: codes are 255·R.

A smooth glow over many pixels is less than one step of 8 bits from pixel to pixel: it is rounded up
or down at random, with the share that keeps its mean, or steps would show as contours.

Sources: Naka & Rushton 1966 (the curve); Valeton & van Norren 1983 (n of primate cones).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["CONE_EXPONENT", "cone_response", "printed"]

CONE_EXPONENT = 0.74


def cone_response(
    luminance_cd_m2: NDArray[np.floating], half_cd_m2: float, exponent: float = CONE_EXPONENT, /
) -> NDArray[np.float64]:
    """(...) response in [0, 1) to light (...) ≥ 0, 0.5 at `half_cd_m2` > 0."""
    light = (np.maximum(luminance_cd_m2, 0.0) / half_cd_m2) ** exponent
    return light / (1 + light)


def printed(
    luminance_cd_m2: NDArray[np.floating],
    half_cd_m2: float,
    /,
    *,
    exponent: float = CONE_EXPONENT,
    finer: int = 1,
    seed: int = 0,
) -> NDArray[np.uint8]:
    """(H/finer, W/finer, 3) sRGB codes of light (H, W, 3) in cd/m²; `seed` of the rounding.

    A code is the mean of `finer` × `finer` responses: the mean of the light itself would leave the
    edges of bright things jagged.
    """
    answer = cone_response(luminance_cd_m2, half_cd_m2, exponent)
    height, width = answer.shape[0] // finer, answer.shape[1] // finer
    blocks = answer[: height * finer, : width * finer].reshape(height, finer, width, finer, 3)
    codes: NDArray[np.float64] = 255 * blocks.mean(axis=(1, 3))
    grain = np.random.default_rng(seed).random(codes.shape[:2])[..., None]
    return np.asarray(np.clip(np.floor(codes + grain), 0, 255), np.uint8)
