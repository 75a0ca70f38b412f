"""CIEDE2000: how different two colours look.

Source: Sharma, Wu & Dalal 2005, "The CIEDE2000 color-difference formula", with their supplementary
pairs as the test; ISO/CIE 11664-4 (L*a*b*), IEC 61966-2-1 (sRGB's primaries and white, D65).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["delta_e_2000", "lab_of_linear"]

Float = NDArray[np.float64]

# Linear Rec.709 → XYZ, D65; its row sums are the white.
XYZ_FROM_RGB = np.array(
    [
        [0.4123907992659595, 0.3575843393838780, 0.1804807884018343],
        [0.2126390058715104, 0.7151686787677560, 0.0721923153607337],
        [0.0193308187155918, 0.1191947797946260, 0.9505321522496607],
    ]
)
# Below δ³ the cube root is a straight line.
DELTA = 6 / 29


def lab_of_linear(rgb: Float, /) -> Float:
    """(…, 3) L*a*b* of linear Rec.709 (…, 3), where 1, 1, 1 is the white."""
    t = rgb @ (XYZ_FROM_RGB / XYZ_FROM_RGB.sum(axis=1, keepdims=True)).T
    line: Float = t / (3 * DELTA**2) + 4 / 29
    root: Float = np.cbrt(t)
    f = np.where(t > DELTA**3, root, line)
    x, y, z = np.moveaxis(f, -1, 0)
    return np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], axis=-1)


def delta_e_2000(one: Float, other: Float, /) -> Float:
    """(…) ΔE₀₀ of two L*a*b* colours (…, 3); k_L = k_C = k_H = 1."""
    (l1, a1, b1), (l2, a2, b2) = (np.moveaxis(lab, -1, 0) for lab in (one, other))
    mean_chroma = (np.hypot(a1, b1) + np.hypot(a2, b2)) / 2
    stretch = 1.5 - 0.5 * np.sqrt(mean_chroma**7 / (mean_chroma**7 + 25.0**7))
    c1, c2 = np.hypot(stretch * a1, b1), np.hypot(stretch * a2, b2)
    h1, h2 = (np.degrees(np.arctan2(b, stretch * a)) % 360 for a, b in ((a1, b1), (a2, b2)))
    both = (c1 > 0) & (c2 > 0)
    turn = np.where(both, (h2 - h1 + 180) % 360 - 180, 0.0)
    # Exactly opposite hues: the formula turns the way that their order has.
    turn = np.where(both & (np.abs(h2 - h1) == 180), h2 - h1, turn)
    hue_step = 2 * np.sqrt(c1 * c2) * np.sin(np.radians(turn) / 2)
    lightness, chroma = (l1 + l2) / 2, (c1 + c2) / 2
    hue = _mean_hue(h1, h2, both)
    return _weighed((l2 - l1, c2 - c1, hue_step), lightness, chroma, hue)


def _mean_hue(h1: Float, h2: Float, both: NDArray[np.bool_]) -> Float:
    total = h1 + h2
    far = np.abs(h1 - h2) > 180
    mean = np.where(far, np.where(total < 360, total + 360, total - 360), total) / 2
    return np.where(both, mean, total)


def _weighed(steps: tuple[Float, Float, Float], lightness: Float, c: Float, hue: Float) -> Float:
    def cosine(factor: int, shift: float) -> Float:
        return np.cos(np.radians(factor * hue + shift))

    t = 1 - 0.17 * cosine(1, -30) + 0.24 * cosine(2, 0) + 0.32 * cosine(3, 6)
    t -= 0.20 * cosine(4, -63)
    off = (lightness - 50) ** 2
    s_l, s_c, s_h = 1 + 0.015 * off / np.sqrt(20 + off), 1 + 0.045 * c, 1 + 0.015 * c * t
    turned = np.radians(60) * np.exp(-(((hue - 275) / 25) ** 2))
    r = -2 * np.sqrt(c**7 / (c**7 + 25.0**7)) * np.sin(turned)
    light, chroma, step = steps[0] / s_l, steps[1] / s_c, steps[2] / s_h
    return np.sqrt(light**2 + chroma**2 + step**2 + r * chroma * step)
