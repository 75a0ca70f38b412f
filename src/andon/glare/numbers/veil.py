"""The veil towards a direction, summed over all pixels: no pyramid, no approximation."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.glare.kernel import Kernel
from andon.spaces import View

__all__ = ["veil_towards", "vertical_illuminance"]

Float = NDArray[np.float64]

# Pairs of a direction and a pixel that are held at once: 8 MB a temporary.
PAIRS = 1 << 20


def veil_towards(directions: Float, luminance_cd_m2: Float, view: View, kernel: Kernel, /) -> Float:
    """(n, 3) veil in cd/m² over what is seen in `directions` (n, 3), unit, camera frame.

    Σ K(θ)·L·ω over the pixels of `luminance_cd_m2` (H, W, 3), which are points here: light within
    θ_min is no veil. Light that is not in the picture is not in the sum.
    """
    lit = np.flatnonzero(luminance_cd_m2.max(axis=-1).ravel() > 0)
    pixels = view.directions().reshape(-1, 3)[lit]
    lux = (luminance_cd_m2 * view.solid_angles()[..., None]).reshape(-1, 3)[lit]
    out = np.zeros((len(directions), 3))
    step = max(1, PAIRS // max(len(lit), 1))
    for start in range(0, len(directions), step):
        towards = directions[start : start + step]
        out[start : start + step] = _kernel(towards, pixels, kernel) @ lux
    return out


def vertical_illuminance(luminance_cd_m2: Float, view: View, gaze: Float, /) -> Float:
    """(3,) lux on a plane that faces `gaze` (3,), unit: ∫ L·cos θ dω over the half before it."""
    cosine = np.maximum(view.directions() @ gaze, 0)
    weight = (cosine * view.solid_angles()).ravel()
    return weight @ luminance_cd_m2.reshape(-1, 3)


def _kernel(towards: Float, pixels: Float, kernel: Kernel) -> Float:
    """(n, m) K(θ); the chord keeps small angles exact, where a cosine would lose them."""
    chord2 = np.maximum(2 - 2 * towards @ pixels.T, 0)
    near = chord2 < 1e-3
    if near.any():
        first, second = np.nonzero(near)
        chord2[near] = np.sum((towards[first] - pixels[second]) ** 2, axis=-1)
    return kernel.per_sr(2 * np.arcsin(np.minimum(np.sqrt(chord2) / 2, 1)))
