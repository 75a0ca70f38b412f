"""Peak signal to noise: how far a picture is from another, in dB."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["psnr_db"]


def psnr_db(ours: NDArray[Any], truth: NDArray[Any], /, *, peak: float = 1.0) -> float:
    """10·log10(peak² / MSE) of values in [0, peak] of one shape, in dB; ∞ where they are equal."""
    away = np.asarray(ours, np.float64) - np.asarray(truth, np.float64)
    with np.errstate(divide="ignore"):
        return float(-10 * np.log10((away**2).mean() / peak**2))
