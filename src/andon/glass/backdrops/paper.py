"""The paper's own blur of what is seen through glass: a Gaussian on the backdrop's picture.

::

    D_b = A_p·|d_b − d_f|/d_f          diameter in metres, on the backdrop
    K_g = (W_p/W_l)·D_b                in texels: the window is ±K_g/2, and σ² = K_g/2

σ² is in texels² and K_g in texels, so the blur's width depends on the picture's resolution: kept as
the mode `paper`, since it is what was shown. Two things are mended: the weights sum to 1 (as
printed they sum to 0.32 at K_g = 1 and to 0.95 at 8), and K_g < 1 is no blur. The order (blur,
then refraction) is the paper's, too: blur discs are stretched by the glass like the picture.

Source: the paper on transparent objects, equations 4 to 7.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.glass.model import Backdrop, Solid

__all__ = [
    "blur_metres",
    "preblurred",
    "taps_of",
    "texels_per_metre",
    "with_blurred_pictures",
]

Float = NDArray[np.float64]


def blur_metres(pupil_m: float, backdrop_m: float, focus_m: float, /) -> float:
    """D_b, metres on the backdrop, of a pupil's diameter and two distances from the eye (> 0).

    Source: equation 7; for distances at infinity its limits, and backdrops there are not blurred.
    """
    if np.isinf(backdrop_m):
        return 0.0
    if np.isinf(focus_m):
        return pupil_m
    return pupil_m * abs(backdrop_m - focus_m) / focus_m


def texels_per_metre(backdrop: Backdrop, pixels_per_radian: float, backdrop_m: float, /) -> float:
    """W_p/W_l: of a picture its own, of the frame that of its pixels `backdrop_m` away."""
    if backdrop.kind == "texture" and backdrop.picture is not None:
        return backdrop.picture.shape[1] / (2 * float(np.linalg.norm(backdrop.right_m)))
    return pixels_per_radian / backdrop_m


def with_blurred_pictures(solids: Sequence[Solid], blur_m: float, /) -> tuple[Solid, ...]:
    """`solids` whose backdrops' pictures are blurred by `blur_m` metres; other kinds stay."""
    return tuple(
        solid
        if solid.backdrop.picture is None
        else replace(
            solid,
            backdrop=replace(
                solid.backdrop,
                picture=preblurred(
                    solid.backdrop.picture, texels_per_metre(solid.backdrop, 1.0, 1.0), blur_m
                ),
            ),
        )
        for solid in solids
    )


def taps_of(kernel_texels: float, /) -> Float:
    """(n + 1,) weights along one axis for K_g = `kernel_texels`: the middle one, and one side.

    They sum to 1 with both sides. K_g < 1 is no blur.
    """
    if not kernel_texels >= 1:
        return np.ones(1)
    # σ² = K_g/2, so exp(−i²/2σ²) = exp(−i²/K_g).
    weights = np.exp(-(np.arange(int(kernel_texels / 2) + 1) ** 2) / kernel_texels)
    return np.asarray(weights / (weights[0] + 2 * weights[1:].sum()), np.float64)


def preblurred(picture: NDArray[Any], texels_per_m: float, blur_m: float, /) -> NDArray[Any]:
    """`picture` (h, w, c) through the paper's Gaussian; K_g = `texels_per_m`·`blur_m`.

    `texels_per_m` is W_p/W_l; of a frame the pixels per metre at the backdrop's distance: focal
    length in pixels over metres. Beyond the border its last texel goes on.
    """
    taps = taps_of(texels_per_m * blur_m)
    radius = len(taps) - 1
    if radius == 0:
        return picture
    result = np.asarray(picture, np.float64)
    for axis in (0, 1):
        size, wide = result.shape[axis], [(0, 0), (0, 0), (0, 0)]
        wide[axis] = (radius, radius)
        padded = np.pad(result, wide, mode="edge")
        result = np.zeros_like(result)
        for k in range(-radius, radius + 1):
            place = np.arange(radius + k, radius + k + size, dtype=np.int64)
            result += taps[abs(k)] * padded.take(place, axis)
    return result.astype(picture.dtype)
