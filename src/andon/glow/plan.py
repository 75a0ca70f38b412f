"""How one axis of the picture is filtered: reduced to cells, filtered, expanded.

::

    pixels   │0 1 2│3 4 5│6 7 8│          r = 3 pixels a cell
    cells   −1│  0  │  1  │  2  │3        one more at each end: its spline reaches into the picture
    texels  m m m c c c c c m m m         m: margin, drawn as the zeros that the filter reads

The spline is the discrete quadratic B-spline, three boxes of r pixels one after the other: 3r − 2
taps, variance (r² − 1)/4 px². Reducing and expanding use it once each, hence
``σ² = r²·σ_cells² + (r² − 1)/2``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.glow.reference import gaussian_sum

__all__ = ["AxisPlan", "Span", "Spans", "plan_axis"]

# Measured on points at all phases: with σ of 2 cells or more the result is within 0.9 % of the
# peak (r = 2; 0.75 % at 3, 0.55 % for large r), with 1.5 within 2 %.
SIGMA_PER_REDUCTION = 2.0
# What lies beyond is 1e-3 of the light; it is kept, since the taps are normalised after the cut.
REACH_SIGMAS = 3.3

# First and end of an interval.
Span = tuple[int, int]


# A pixel reads the cell that it lies in and one to each side, so cells up to two beyond those that
# hold light are read, and must be drawn as the zeros that they are.
EXPANDED_BEYOND = 2


@dataclass(frozen=True)
class Spans:
    """Intervals of one axis: pixels that are read, texels of two kinds, pixels that are lit."""

    source: Span
    reduced: Span
    filtered: Span
    reached: Span


@dataclass(frozen=True)
class AxisPlan:
    """One axis.

    Attributes
    ----------
    length : pixels.
    reduction : pixels a cell, ≥ 1; at 1 cells are pixels.
    taps : (n + 1,) of the filter between cells: the middle one and those to one side.
    """

    length: int
    reduction: int
    taps: NDArray[np.float64]

    @property
    def radius(self) -> int:
        """Cells from the middle tap to the last."""
        return len(self.taps) - 1

    @property
    def cells(self) -> Span:
        """The cells whose spline touches a pixel."""
        return touching((0, self.length), self.reduction)

    @property
    def margin(self) -> int:
        """Texels before the first cell and after the last: nothing is ever read beyond them."""
        return self.radius + EXPANDED_BEYOND

    @property
    def texels(self) -> int:
        """Length of a texture of cells with its margins."""
        first, end = self.cells
        return end - first + 2 * self.margin

    @property
    def origin(self) -> int:
        """Texel of cell 0."""
        return self.margin - self.cells[0]

    def spans(self, pixels: Span, /) -> Spans:
        """What each pass has to draw for light of these pixels, not more than the next reads."""
        r, (first, end), (least, most) = (
            self.reduction,
            touching(pixels, self.reduction),
            self.cells,
        )
        lit = max(first - self.radius, least), min(end + self.radius, most)
        filtered = _wider(lit, EXPANDED_BEYOND)
        reduced = _wider(filtered, self.radius)
        return Spans(
            source=self._pixels(_support(reduced, r)),
            reduced=_shifted(reduced, self.origin),
            filtered=_shifted(filtered, self.origin),
            reached=self._pixels(_support(lit, r)),
        )

    def _pixels(self, span: Span) -> Span:
        return max(span[0], 0), min(span[1], self.length)

    def wgsl(self, along_x: bool, fraction: float, limit: float, /) -> str:
        """The constants that stand in for axis.wgsl."""
        taps = ", ".join(f"{tap:.9g}f" for tap in self.taps)
        return "\n".join(
            [
                f"const AXIS = {'vec2i(1, 0)' if along_x else 'vec2i(0, 1)'};",
                f"const LENGTH: i32 = {self.length};",
                f"const REDUCTION: i32 = {self.reduction};",
                f"const ORIGIN: i32 = {self.origin};",
                f"const RADIUS: i32 = {self.radius};",
                f"const TAPS = array<f32, {len(self.taps)}>({taps});",
                f"const FRACTION: f32 = {fraction:.9g}f;",
                f"const BODY_LIMIT: f32 = {limit:.9g}f;",
            ]
        )


def touching(pixels: Span, reduction: int, /) -> Span:
    """The cells c whose spline, pixels r·c − r + 1 … r·c + 2r − 2, touches `pixels`."""
    r = reduction
    return -((2 * r - 2 - pixels[0]) // r), (pixels[1] + r - 2) // r + 1


def _support(cells: Span, reduction: int) -> Span:
    """The pixels that the splines of `cells` touch."""
    r = reduction
    return r * cells[0] - r + 1, r * (cells[1] - 1) + 2 * r - 1


def _wider(span: Span, by: int) -> Span:
    return span[0] - by, span[1] + by


def _shifted(span: Span, by: int) -> Span:
    return span[0] + by, span[1] + by


def plan_axis(length: int, sigma_px: float, /) -> AxisPlan:
    """The largest reduction that is accurate, and the taps that bring the total to σ (px, > 0)."""
    r = min(max(1, math.floor(sigma_px / SIGMA_PER_REDUCTION)), length)
    sigma = math.sqrt(sigma_px**2 - (r * r - 1) / 2) / r
    reach = math.ceil(REACH_SIGMAS * sigma)
    # No two cells are farther apart than their number; one tap to the side is always there.
    first, end = touching((0, length), r)
    radius = max(1, min(reach, end - first - 1))
    taps = np.exp(-((np.arange(radius + 1) / sigma) ** 2) / 2)
    whole = taps[0] + 2 * taps[1:].sum() if radius >= reach else gaussian_sum(sigma)
    return AxisPlan(length, r, taps / whole)
