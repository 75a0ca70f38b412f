"""The display in float64."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.display.fusion import fused_codes
from andon.display.model import Exposure
from andon.responses import Response

__all__ = ["SHOULDER_START", "encode", "shown_codes", "tone_curve"]

# Below this share of white the shoulder is the identity, so that most of a picture is untouched.
SHOULDER_START = 0.6
# White to the last bit in either precision, and finite in both: ∞/(1 + ∞) would be NaN.
LARGEST = 1e30


def tone_curve(linear: NDArray[Any], tone: str, /) -> NDArray[Any]:
    """Display-linear values in [0, 1] from unbounded ones (..., 3); but for ``hue`` per channel.

    ``hue``: where the largest channel m is above 1, y = x/m + (1 − x/m)·(1 − 1/√m): ratios of the
    channels fade to white as light grows, instead of turning yellow where one channel after the
    other is clipped. Up to white it is the identity.
    ``reinhard``: y = s + (1−s)·x'/(1+x') with x' = (x−s)/(1−s) above s = 0.6: slope 1 at s, white
    only at infinity (the operator of Reinhard et al. 2002, equation 3, applied to the shoulder).
    """
    if tone == "none":
        return np.clip(linear, 0, 1)
    if tone == "hue":
        light = np.clip(linear, 0, LARGEST)
        most = np.maximum(light.max(axis=-1, keepdims=True), 1)
        return light / most + (1 - light / most) * (1 - 1 / np.sqrt(most))
    # Half floats end at 65504; what is beyond comes as infinity, and is white.
    over = np.clip((linear - SHOULDER_START) / (1 - SHOULDER_START), 0, LARGEST)
    bent = SHOULDER_START + (1 - SHOULDER_START) * over / (1 + over)
    return np.where(linear > SHOULDER_START, bent, np.maximum(linear, 0))


def encode(
    luminance_cd_m2: NDArray[Any],
    exposure: Exposure,
    response: Response,
    luminance_per_unit: float,
    /,
) -> NDArray[np.uint8]:
    """(H, W, 3) uint8 from luminance (H, W, 3) in cd/m²; rounded to nearest."""
    if exposure.tone == "fusion":
        return fused_codes(luminance_cd_m2, exposure, response, luminance_per_unit)
    codes = shown_codes(luminance_cd_m2, exposure, response, luminance_per_unit)
    return np.asarray(codes + 0.5, np.uint8)


def shown_codes(
    luminance_cd_m2: NDArray[Any],
    exposure: Exposure,
    response: Response,
    luminance_per_unit: float,
    /,
) -> NDArray[np.float64]:
    """(H, W, 3) in [0, 255], not rounded, of `encode`; of any tone but ``fusion``."""
    scale = exposure.units_per_cd_m2 or 1 / luminance_per_unit
    encoded = response.encode(tone_curve(luminance_cd_m2 * scale, exposure.tone))
    return np.asarray(np.clip(encoded, 0, 1) * 255, np.float64)
