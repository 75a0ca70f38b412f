"""Indices of glare, from luminances, solid angles and places of sources."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from andon.errors import InputError

__all__ = [
    "DGP_RANGE",
    "TI_MOST_CD_M2",
    "UGR_SOLID_ANGLES_SR",
    "daylight_glare_probability",
    "position_index",
    "threshold_increment_percent",
    "unified_glare_rating",
]

Float = NDArray[np.float64]

# The exponent of TI = 65·L_v/L_av^0.8 was found for road luminances up to this (CIE 31:1976).
TI_MOST_CD_M2 = 5.0
# Sources that UGR was made for (CIE 117:1995); others have formulas of their own.
UGR_SOLID_ANGLES_SR = (3e-4, 0.1)
# Probabilities, and the illuminance at the eye, of the study (Wienold & Christoffersen 2006).
DGP_RANGE, DGP_LEAST_LUX = (0.2, 0.8), 380.0
# Beyond these evalglare goes no further, and the tables behind the formulas end.
LARGEST_INDEX, LARGEST_SLOPE = 16.0, 3.0


def position_index(
    directions: NDArray[np.float64], gaze: Float, up: Float, /, *, below: bool = True
) -> Float:
    """(n,) Guth's position index P ≥ 1 of sources at `directions` (n, 3), all unit vectors.

    Above the line of sight Guth's by Levin 1975; below it, where `below`, Iwata & Tokura 1997.
    Sources behind the eye (90° and more from `gaze`) have infinite P: they do not count.
    """
    forward = directions @ gaze
    rest = directions - forward[:, None] * gaze
    length = np.maximum(np.linalg.norm(rest, axis=1), 1e-12)
    vertical = up - (up @ gaze) * gaze
    height = rest @ vertical / np.linalg.norm(vertical) / length
    sigma = np.degrees(np.arctan2(length, forward))
    tau = np.degrees(np.arccos(np.clip(np.abs(height), 0, 1)))
    first = (35.2 - 0.31889 * tau - 1.22 * np.exp(-2 * tau / 9)) * 1e-3 * sigma
    second = (21 + 0.26667 * tau - 0.002963 * tau**2) * 1e-5 * sigma**2
    index = np.exp(first + second)
    if below:
        slope = np.tan(np.radians(np.minimum(sigma, 89.9)))
        lower = 1 + np.where(slope < 0.6, 0.8, 1.2) * np.minimum(slope, LARGEST_SLOPE)
        index = np.minimum(np.where(height < 0, lower, index), LARGEST_INDEX)
    return np.where(forward > 0, index, np.inf)


def unified_glare_rating(
    luminance_cd_m2: ArrayLike,
    solid_angle_sr: ArrayLike,
    index: ArrayLike,
    background_cd_m2: float,
    /,
) -> float | None:
    """UGR = 8·log₁₀(0.25/L_b·Σ L²ω/P²), CIE 117:1995; None where there is no source.

    Parameters
    ----------
    luminance_cd_m2, solid_angle_sr, index : (n,) of the sources.
    background_cd_m2 : L_b > 0: what arrives at the eye without the sources, divided by π.
    """
    _positive(background_cd_m2, "background_cd_m2")
    terms = np.asarray(luminance_cd_m2) ** 2 * np.asarray(solid_angle_sr) / np.asarray(index) ** 2
    total = float(np.sum(terms))
    return 8 * float(np.log10(0.25 / background_cd_m2 * total)) if total > 0 else None


def daylight_glare_probability(
    luminance_cd_m2: ArrayLike,
    solid_angle_sr: ArrayLike,
    index: ArrayLike,
    vertical_lux: float,
    /,
) -> float:
    """DGP = 5.87e-5·E_v + 9.18e-2·log₁₀(1 + Σ L²ω/(E_v^1.87·P²)) + 0.16, at most 1.

    Source: Wienold & Christoffersen 2006, equation 8; E_v > 0 in lux at the eye.
    """
    _positive(vertical_lux, "vertical_lux")
    terms = np.asarray(luminance_cd_m2) ** 2 * np.asarray(solid_angle_sr) / np.asarray(index) ** 2
    contrast = float(np.sum(terms)) / vertical_lux**1.87
    return min(1.0, 5.87e-5 * vertical_lux + 9.18e-2 * float(np.log10(1 + contrast)) + 0.16)


def threshold_increment_percent(veil_cd_m2: float, average_cd_m2: float, /) -> float:
    """TI = 65·L_v/L_av^0.8 in %, CIE 31:1976; made for L_av of 0.05 to 5 cd/m²."""
    _positive(average_cd_m2, "average_cd_m2")
    return 65 * veil_cd_m2 / average_cd_m2**0.8


def _positive(value: float, name: str) -> None:
    if not 0 < value < float("inf"):
        raise InputError(f"must be > 0 and finite, got {value:g}", field=name)
