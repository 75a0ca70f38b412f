"""The glow in float64: every tap of the Gaussian."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.glow.model import Glow
from andon.spaces import View

__all__ = ["add_glow", "filtered", "gaussian_sum", "gaussian_taps"]

Float = NDArray[np.float64]

# exp(−8²/2) = 1.3e-14 of the middle tap: what is cut off is below the rounding of the sum.
REACH_SIGMAS = 8.0


def gaussian_sum(sigma: float, /) -> float:
    """Σ exp(−x²/2σ²) over all integers x.

    The integral σ·√(2π) from σ = 2 on: by Poisson's sum they differ by 2·exp(−2π²σ²) < 1e-33.
    """
    if sigma >= 2:
        return sigma * np.sqrt(2 * np.pi)
    offsets = np.arange(-16, 17)
    return float(np.exp(-((offsets / sigma) ** 2) / 2).sum())


def gaussian_taps(sigma: float, longest: int, /) -> Float:
    """(2·n + 1,) taps k·exp(−x²/2σ²) with k = 1/Σ, for offsets of at most `longest` px.

    Offsets that no two pixels of a picture have are left out, but count in Σ, so that light that
    leaves the picture is lost and not put back. Source: the relighting paper, equation 2.
    """
    radius = int(min(np.ceil(REACH_SIGMAS * sigma), longest))
    offsets = np.arange(-radius, radius + 1)
    return np.exp(-((offsets / sigma) ** 2) / 2) / gaussian_sum(sigma)


def _along(values: Float, taps: Float, axis: int) -> Float:
    """`values` filtered along one axis, zero beyond the border, by a padded transform."""
    radius, size = len(taps) // 2, values.shape[axis]
    if radius == 0:
        return values * taps
    length = size + 2 * radius
    shape = [1] * values.ndim
    shape[axis] = length // 2 + 1
    spectrum = np.fft.rfft(values, length, axis) * np.fft.rfft(taps, length).reshape(shape)
    whole = np.moveaxis(np.fft.irfft(spectrum, length, axis), axis, 0)[radius : radius + size]
    # Where nothing arrives the transform leaves ±1e-16 of the brightest.
    return np.maximum(np.moveaxis(whole, 0, axis), 0)


def filtered(bodies: NDArray[Any], glow: Glow, view: View, /) -> Float:
    """G∗B, (H, W, 3) in the unit of `bodies`: the bodies' light as if all of it were scattered.

    Raises `InputError` unless `bodies` is (H, W, 3) of the view, finite and ≥ 0.
    """
    light = np.asarray(bodies, np.float64)
    if light.shape != (*view.shape, 3):
        raise InputError(f"must be {(*view.shape, 3)}, got {light.shape}", field="glow.bodies")
    if not (np.isfinite(light).all() and (light >= 0).all()):
        raise InputError("must be finite and ≥ 0", field="glow.bodies")
    for axis, sigma in zip((1, 0), glow.sigma_pixels(view), strict=True):
        light = _along(light, gaussian_taps(sigma, light.shape[axis] - 1), axis)
    return light


def add_glow(
    luminance: NDArray[Any], bodies: NDArray[Any], glow: Glow, view: View, /
) -> NDArray[Any]:
    """L + fraction·(G∗B − B), (H, W, 3), both in one unit; `luminance` contains the `bodies`.

    A fraction of 0 gives `luminance` itself.
    """
    if glow.fraction == 0:
        return luminance
    scattered = filtered(bodies, glow, view) - bodies
    return np.asarray(luminance, np.float64) + glow.fraction * scattered
