"""Lamps mirrored in glass, in Phong's lobe (float64)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from andon.glass.model import Highlight

__all__ = ["highlight_luminance", "phong_lobe"]

Float = NDArray[np.float64]


def phong_lobe(cosine: Float, exponent: float, /) -> Float:
    """1/sr: (m + 1)/2π·cosᵐα, 0 behind; its integral over the half space is 1.

    A mirror gives a lamp's light to one direction; the lobe spreads it and keeps its sum. The
    paper's highlight is Phong's (section 4.1) without a norm.
    """
    return (exponent + 1) / (2 * np.pi) * np.maximum(cosine, 0) ** exponent


def highlight_luminance(
    highlights: Sequence[Highlight], points: Float, mirrored: Float, exponent: float, /
) -> Float:
    """Luminance (n, 3) in cd/m² of lamps of one solid, for a perfect mirror.

    Parameters
    ----------
    points, mirrored : (n, 3) where a view ray meets the glass, metres, and where it is thrown.
    exponent : m of the lobe.
    """
    total = np.zeros_like(points)
    for highlight in highlights:
        if highlight.distant:
            cosine, lux = mirrored @ highlight.towards, highlight.light
            total += phong_lobe(cosine, exponent)[:, None] * lux
            continue
        reach = highlight.towards - points
        distance = np.linalg.norm(reach, axis=-1)
        cosine = np.einsum("ni,ni->n", mirrored, reach) / distance
        total += (phong_lobe(cosine, exponent) / distance**2)[:, None] * highlight.light
    return total
