"""Pixels that are no light, counted and taken out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.spaces import View

__all__ = ["MAX_PIXELS", "Cleaned", "cleaned"]

# In float64 with directions, solid angles and what is between them a pixel takes some 250 bytes.
MAX_PIXELS = 1 << 25


@dataclass(frozen=True, eq=False)
class Cleaned:
    """Light that can be summed.

    Attributes
    ----------
    light : (H, W, 3) float64, finite, ≥ 0.
    nan, infinite, negative : pixels with such a channel; the channel became 0.
    outside : pixels that show nothing.
    """

    light: NDArray[np.float64]
    nan: int = 0
    infinite: int = 0
    negative: int = 0
    outside: int = 0


def cleaned(
    luminance_cd_m2: NDArray[np.floating[Any]], view: View, shows: NDArray[np.bool_] | None, /
) -> Cleaned:
    """The picture (H, W, 3) with NaN, ±Inf and negative values as 0, and so where nothing shows.

    Raises
    ------
    InputError
        if it has no pixels, more than 2²⁵ of them, or another size than the view.
    """
    shape = np.shape(luminance_cd_m2)
    if len(shape) != 3 or shape[2] != 3 or 0 in shape:
        raise InputError(f"must be (H, W, 3) with pixels, got {shape}", field="luminance_cd_m2")
    if shape[:2] != view.shape:
        raise InputError(
            f"must be {view.width}×{view.height} px as the view, got {shape[1]}×{shape[0]}",
            field="luminance_cd_m2",
        )
    if shape[0] * shape[1] > MAX_PIXELS:
        raise InputError(
            f"must have at most {MAX_PIXELS} pixels, has {shape[0] * shape[1]}",
            field="luminance_cd_m2",
            remedy="scale the picture down: the veil has no details finer than 0.1°",
        )
    light = np.array(luminance_cd_m2, np.float64)
    if shows is not None:
        light[~shows] = 0
    nan, infinite, negative = np.isnan(light), np.isinf(light), light < 0
    light[nan | infinite | negative] = 0
    counts = [int(np.count_nonzero(bad.any(axis=-1))) for bad in (nan, infinite, negative)]
    outside = 0 if shows is None else int(np.count_nonzero(~shows))
    return Cleaned(light, counts[0], counts[1], counts[2], outside)
