"""Fixed windows: bands are dimmed, the higher the more, whatever the light.

Good against what a known filter does; no cure for ringing (see `deringing`). Source: Sloan 2008,
section "Windowing".
"""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.harmonics.basis import coefficient_count, order_of

__all__ = ["Window", "window_factors", "windowed"]

Float = NDArray[np.float64]
Window = Literal["hann", "lanczos", "gaussian"]


def window_factors(window: Window, width: float, order: int = 2, /) -> Float:
    """((order + 1)²,) factor of each coefficient; 1 in band 0.

    With x = l/width: hann (1 + cos πx)/2 and lanczos sin(πx)/(πx), both 0 from x = 1 on; gaussian
    exp(−(πx)²/2). `width` in bands, > 0.
    """
    if not width > 0:
        raise InputError(f"must be > 0 bands, got {width}", field="window width")
    coefficient_count(order)
    bands = np.arange(order + 1)
    x = bands / width
    if window == "hann":
        factors = np.where(x < 1, (1 + np.cos(np.pi * x)) / 2, 0)
    elif window == "lanczos":
        factors = np.where(x < 1, np.sinc(x), 0)
    elif window == "gaussian":
        factors = np.exp(-((np.pi * x) ** 2) / 2)
    else:
        raise InputError(f"must be hann, lanczos or gaussian, got {window!r}", field="window")
    return np.repeat(factors, 2 * bands + 1)


def windowed(
    coefficients: NDArray[Any], window: Window = "hann", *, width: float | None = None
) -> Float:
    """Coefficients (..., k, 3) under a window that is `width` bands wide.

    Default: order + 1 bands, so that the first band that is not there would be 0.
    """
    given = np.asarray(coefficients, np.float64)
    order = order_of(given.shape[-2])
    factors = window_factors(window, order + 1 if width is None else width, order)
    return given * factors[:, None]
