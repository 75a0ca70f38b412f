"""Which level of the pyramid draws which discs, and the constants that its shaders are given."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.glass.defocus.kernels import MAX_BLUR_PX, REACH_SIGMAS, kernel
from andon.glass.model import Blur

__all__ = ["LEVELS", "DiscPlan", "Rect", "Three", "grown", "size_table"]

# x, y, width, height.
Rect = tuple[int, int, int, int]

# Of what is refracted, sticks to the surface, is mirrored.
Three = tuple[bool, bool, bool]
ALL: Three = (True, True, True)

# Levels with discs: half, a quarter and an eighth of the size.
LEVELS = (1, 2, 3)
# Diameter in pixels from which a level has all of the picture; the step before it is shared. Discs
# of 3 to 8 texels cost 13 to 61 taps. Against the reference a photograph in [0, 1] errs in the mean
# by 0.6/255 where a level begins, by 0.25/255 where it ends.
FIRST_PX = (6.0, 15.0, 48.0)
# The table of sizes: entries a texel of diameter, and the largest diameter in it.
STEPS, LONGEST = 64, 16


@dataclass(frozen=True)
class DiscPlan:
    """The discs of one mode."""

    kind: Blur

    @property
    def shape(self) -> Blur:
        """What is drawn: the paper's Gaussian is one of another width."""
        return "optical" if self.kind == "optical" else "gaussian"

    @property
    def whole_level(self) -> int:
        """The level whose mean coverage is 1 only where all that full-size discs reach is glass.

        A texel of level 2 is a mean of the 3 px around its own 4², of level 3 of 7 px. Full-size
        discs reach 3.5 px, Gaussians 5 px.
        """
        return 2 if self.shape == "optical" else 3

    def diameter(self, blur_px: float, /) -> float:
        """Diameter of the disc of equal second moment, px."""
        return min(blur_px, MAX_BLUR_PX) if self.kind != "paper" else (8 * blur_px) ** 0.5

    def levels_of(self, disc_px: float, /) -> tuple[int, ...]:
        """The levels that take part where no disc is larger, coarsest last."""
        first = FIRST_PX
        return tuple(n for n in LEVELS if disc_px > 0.85 * first[n - 1])

    def has_discs(self, level: int, least_px: float, /) -> bool:
        """Whether a layer with no disc smaller than this has any of the level; 0 is full size."""
        first = FIRST_PX
        return level >= len(first) or least_px < first[level]

    def wgsl(self, level: int, blurs: Three = ALL, nears: Three = ALL, /) -> str:
        """The constants that stand in for kernel.wgsl; level 0 is full size."""
        edges = (*FIRST_PX, 4 * MAX_BLUR_PX)
        # Reducing by 1 3 3 1 and enlarging by 3 1 add 3/4 px² each, and 4 times that a level on.
        added = 1.5 * (4**level - 1) / 3 / 4**level
        return "\n".join(
            [
                f"const TEXEL: f32 = {2.0**level};",
                f"const FIRST: f32 = {edges[max(level - 1, 0)]};",
                f"const LAST: f32 = {edges[level]};",
                f"const HALF_SHARPENING: f32 = {added / 2};",
                f"const REACH: f32 = {1.0 if self.shape == 'optical' else REACH_SIGMAS};",
                f"const IS_GAUSSIAN = {str(self.shape == 'gaussian').lower()};",
                f"const IS_PAPER = {str(self.kind == 'paper').lower()};",
                f"const LARGEST_PX: f32 = {MAX_BLUR_PX};",
                f"const STEPS: f32 = {float(STEPS)};",
                f"const BLURS = {_booleans(blurs)};",
                f"const NEARS = {_booleans(nears)};",
                f"const WHOLE: u32 = {self.whole_level}u;",
            ]
        )


def _booleans(three: Three) -> str:
    return f"vec3<bool>({', '.join(str(each).lower() for each in three)})"


def size_table(plan: DiscPlan, /) -> NDArray[np.float32]:
    """(1, n) sizes in texels of discs of 0, 1/64, 2/64 … texels."""
    diameters = np.arange(LONGEST * STEPS + 1) / STEPS
    return kernel(plan.shape).fitted(diameters).astype(np.float32)[None]


def grown(rect: Rect, by: float, scale: int, size: tuple[int, int], margin: int = 0, /) -> Rect:
    """`rect` grown by `by` px, in texels of `scale` px, `margin` texels more, within `size`."""
    spans: list[tuple[int, int]] = []
    for start, length, end in zip(rect[:2], rect[2:], size, strict=True):
        low = int((start - by) // scale) - margin
        high = -int(-(start + length + by) // scale) + margin
        spans.append((min(max(low, 0), end), min(max(high, 0), end)))
    (left, right), (top, bottom) = spans
    return left, top, max(right - left, 0), max(bottom - top, 0)
