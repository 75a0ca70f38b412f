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
# Within so many pixels K is integrated over each pixel's area, by so many points each way: of a
# pixel of 0.7° every part is then half of θ_min wide.
NEAR_PIXELS, PARTS = 4, 16


def veil_towards(directions: Float, luminance_cd_m2: Float, view: View, kernel: Kernel, /) -> Float:
    """(n, 3) veil in cd/m² over what is seen in `directions` (n, 3), unit, camera frame.

    Σ K(θ)·L·ω over the pixels of `luminance_cd_m2` (H, W, 3); those within `NEAR_PIXELS` are cut
    into `PARTS`², since K varies over them. Light within θ_min is no veil, also not the nearer part
    of the pixel that is looked at. Light that is not in the picture is not in the sum.
    """
    lit = np.flatnonzero(luminance_cd_m2.max(axis=-1).ravel() > 0)
    pixels = view.directions().reshape(-1, 3)[lit]
    omega = view.solid_angles().ravel()[lit]
    # Towards the poles pixels get narrow, but stay as high as they are.
    size2 = np.maximum(omega, (np.pi / view.height) ** 2) if view.projection == "latlong" else omega
    light = luminance_cd_m2.reshape(-1, 3)[lit]
    out = np.zeros((len(directions), 3))
    step = max(1, PAIRS // max(len(lit), 1))
    for start in range(0, len(directions), step):
        towards = directions[start : start + step]
        chord2 = _chord2(towards, pixels)
        near = chord2 < NEAR_PIXELS**2 * size2
        weights = np.where(near, 0, kernel.per_sr(_angle(chord2))) * omega
        at, pixel = np.nonzero(near)
        weights[near] = _in_parts(towards[at], lit[pixel], view, kernel)
        out[start : start + step] = weights @ light
    return out


def vertical_illuminance(luminance_cd_m2: Float, view: View, gaze: Float, /) -> Float:
    """(3,) lux on a plane that faces `gaze` (3,), unit: ∫ L·cos θ dω over the half before it."""
    cosine = np.maximum(view.directions() @ gaze, 0)
    weight = (cosine * view.solid_angles()).ravel()
    return weight @ luminance_cd_m2.reshape(-1, 3)


def _chord2(towards: Float, pixels: Float) -> Float:
    """(n, m) squared chords; near ones by differences, where the cosine would lose them."""
    chord2 = np.maximum(2 - 2 * towards @ pixels.T, 0)
    first, second = np.nonzero(chord2 < 1e-3)
    chord2[first, second] = np.sum((towards[first] - pixels[second]) ** 2, axis=-1)
    return chord2


def _angle(chord2: Float) -> Float:
    return 2 * np.arcsin(np.minimum(np.sqrt(chord2) / 2, 1))


def _in_parts(towards: Float, pixel: NDArray[np.intp], view: View, kernel: Kernel) -> Float:
    """(n,) ∫ K dω over pixels (n,) by their number, seen from `towards` (n, 3)."""
    rows, columns = np.divmod(pixel, view.width)
    offset = (np.arange(PARTS) + 0.5) / PARTS - 0.5
    y, x = (part.ravel() for part in np.meshgrid(offset, offset, indexing="ij"))
    places = np.stack([columns[:, None] + x, rows[:, None] + y], axis=-1)
    parts = view.directions_at(places)
    weight = np.ones(places.shape[:2])
    if view.projection == "latlong":
        weight = np.hypot(parts[..., 0], parts[..., 2])
    weight *= (view.solid_angles().ravel()[pixel] / weight.sum(axis=1))[:, None]
    chord2 = np.sum((parts - towards[:, None]) ** 2, axis=-1)
    return np.sum(kernel.per_sr(_angle(chord2)) * weight, axis=1)
