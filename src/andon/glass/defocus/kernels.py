"""What a point becomes: weights of the pixels around it, of a stated second moment.

A disc of diameter D has the second moment D²/16 along each axis, a Gaussian σ². Sampled at pixel
centres neither has just that: a disc of 3 px is a cross or a square. So the weights have one free
size, and the size is found, in a table, that gives D²/16 *on the grid of pixels*, for every D.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from andon.glass.model import Blur

__all__ = ["LEAST_BLUR_PX", "MAX_BLUR_PX", "Kernel", "kernel"]

Float = NDArray[np.float64]

# A disc of one pixel is what a pixel is: nothing is blurred by less. In mode `paper` its K, too.
LEAST_BLUR_PX = 1.0
# Larger discs are cut to this; four times the paper's largest, and 1.6° at 720p and 60°.
MAX_BLUR_PX = 64.0

# A Gaussian's weights end, over one pixel, at so many σ: 1.1 % of it lies beyond.
REACH_SIGMAS = 3.0
# Steps of the table in size, pixels. Interpolated between them the second moment errs by 0.4 % at
# D = 1 px and by less than 0.02 % from 2 px on.
STEP_PX = 1 / 64


@dataclass(frozen=True)
class Kernel:
    """Weights that fall with the distance from the middle.

    Attributes
    ----------
    kind : ``optical`` (uniform disc), ``gaussian``, ``paper`` (exp(−r²/K) in a window of ±K/2).
    """

    kind: Blur

    def weights(self, dy: int, dx: int, size: Float, /) -> Float:
        """Weight in [0, 1] of the pixel at (dy, dx), not normalised, for each `size` (n,)."""
        r2 = float(dy * dy + dx * dx)
        if self.kind == "paper":
            return np.exp(-r2 / np.maximum(size, 1e-9)) * (2 * max(abs(dy), abs(dx)) <= size)
        edge = np.clip(self.reach(size) - np.sqrt(r2), 0, 1)
        return edge if self.kind == "optical" else edge * np.exp(-r2 / (2 * size**2))

    def reach(self, size: Float, /) -> Float:
        """Pixels this far away, or farther, have weight 0 (in a window: on its axes)."""
        if self.kind == "paper":
            return size / 2 + 1e-9
        return size + 0.5 if self.kind == "optical" else REACH_SIGMAS * size + 0.5

    def sizes(self, diameter_px: Float, /) -> Float:
        """The free size for each diameter ≥ 0: radius of the disc, σ, or K; cut to 64 px."""
        diameter = np.minimum(diameter_px, MAX_BLUR_PX)
        if self.kind == "paper":
            return np.where(diameter < LEAST_BLUR_PX, 0.0, diameter)
        return np.where(diameter < LEAST_BLUR_PX, 0.0, self.fitted(diameter))

    def fitted(self, diameter: Float, /) -> Float:
        """Sizes whose second moment on a grid is `diameter`²/16, in cells of that grid, however
        small; not for ``paper``."""
        sizes, variances = moments(self.kind)
        return np.interp(diameter**2 / 16, variances, sizes)


def kernel(kind: Blur, /) -> Kernel:
    """The kernel of a mode other than ``off``."""
    return Kernel(kind)


@cache
def moments(kind: Blur, /) -> tuple[Float, Float]:
    """Sizes and the second moments that they have on the grid of pixels, both rising from 0."""
    shape = Kernel(kind)
    # A disc of radius ½, and a Gaussian whose reach is 1, are one pixel.
    first = 0.5 if kind == "optical" else 0.5 / REACH_SIGMAS
    last = MAX_BLUR_PX / 2 + 1 if kind == "optical" else MAX_BLUR_PX / 4 + 1
    sizes = np.arange(first, last + STEP_PX, STEP_PX)
    total, moment = np.zeros_like(sizes), np.zeros_like(sizes)
    farthest = int(np.ceil(shape.reach(sizes[-1:])[0]))
    for dy, dx, times in octant(farthest):
        weight = times * shape.weights(dy, dx, sizes)
        total += weight
        moment += weight * (dy * dy + dx * dx) / 2
    return sizes, moment / total


def octant(farthest: int, /) -> list[tuple[int, int, int]]:
    """(dy, dx, pixels that are its mirror images) for 0 ≤ dy ≤ dx within `farthest` pixels."""
    found: list[tuple[int, int, int]] = []
    for dx in range(farthest + 1):
        for dy in range(dx + 1):
            if dy * dy + dx * dx <= farthest * farthest:
                signs = (2 if dy else 1) * (2 if dx else 1)
                found.append((dy, dx, signs * (2 if dy != dx else 1)))
    return found
