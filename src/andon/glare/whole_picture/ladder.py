"""How much light each filter of each level spreads, where the chart's scale is a.

A *rung* is a filter of a level: rung k has σ_k = a·s_k, ``s_k = sigma_cells·2^(level−1)·cell``
(and what blocks of pixels add, which tells only in the first few), and takes
``W(σ_k)·χ(s_k)·(ln s_{k+1} − ln s_{k−1})/2`` of a point's light. χ goes from 1 to 0 over a few
coarse cells, whose angle goes with a as well; the rest of the mixture is the far part's. Finer than
all rungs are the *blocks*, that is reduced and expanded pixels; their share and those of the first
rungs are fitted to what pixels send each other (`nearest`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from andon.glare.kernel import Kernel
from andon.glare.whole_picture.charts import pixel_angles
from andon.glare.whole_picture.mixture import Mixture, bump
from andon.glare.whole_picture.nearest import (
    NEIGHBOURS,
    OFFSETS,
    fitted,
    sent,
    sent_by_blocks,
    sent_by_filter,
)
from andon.glare.whole_picture.splines import BLOCKS_VARIANCE, filters, sigma_cells
from andon.spaces import View

__all__ = ["Ladder", "Rung"]

Float = NDArray[np.float64]

# So many rungs, after the blocks, are fitted to what pixels send.
FITTED = 4
# Widths of the first rungs in ln σ, where σ does not grow evenly: least squares over θ⁻²…θ⁻³.
FIRST_WIDTHS = (0.4, 0.667, 0.670, 0.464, 0.306)
# Nodes over the angle to a chart's axis, of what is fitted and of what blocks add to σ²; they end
# beyond the light that a chart has, where pixels get too small.
NODES, MOST_DEGREES = 65, 135.0
# No pixel counts as smaller than so much of the largest.
LEAST_PIXEL = 0.6
# How much the height of a narrow pixel tells, the rest its width.
HEIGHT = 0.9
# Width in ln σ of blocks as one rung of many.
BLOCKS_WIDTH = 0.5


@dataclass(frozen=True)
class Rung:
    """One filter of one level.

    Attributes
    ----------
    level, which : of `splines.filters(level)`.
    sigma : s, chart units: radians where the chart's scale is 1.
    width : in ln σ, times χ.
    """

    level: int
    which: int
    sigma: float
    width: float


@dataclass(frozen=True, eq=False)
class Ladder:
    """The rungs of all charts.

    Attributes
    ----------
    rungs : by σ.
    scales, blocks : (m,) what blocks add to σ² in radians², where the chart's scale is `scales`.
    nearest : (m, 1 + n) shares of blocks and of the first n rungs there.
    beside : (m, 3) what is to be added to that for the pixel below or above, beside, and diagonal.
    mixture : W, linear between its nodes, held beyond the ends.
    span : chart units, the s at which χ begins to fall and those at which it ends.
    """

    rungs: tuple[Rung, ...]
    scales: Float
    blocks: Float
    nearest: Float
    beside: Float
    mixture: Mixture
    span: tuple[float, float]

    @staticmethod
    def of(
        view: View, kernel: Kernel, mixture: Mixture, cell: float, span: tuple[float, float], /
    ) -> Ladder:
        """The rungs of the kernel's `mixture` for charts of cells of `cell`."""
        scales, sides = _nodes(view)
        rungs = _rungs(cell, span)
        blocks = BLOCKS_VARIANCE * sides[:, 0] * sides[:, 1]
        plain = Ladder(
            rungs, scales, blocks, np.zeros((len(scales), 0)), np.zeros((0, 3)), mixture, span
        )
        nearest, beside = plain._fitted(kernel, sides, cell)
        return replace(plain, nearest=nearest, beside=beside)

    @property
    def levels(self) -> int:
        """The last level with a rung."""
        return self.rungs[-1].level

    def share_of(self, rung: Rung, scale: Float, /) -> Float:
        """(...) share of a point's light that a rung spreads where the chart's scale is a."""
        place = 1 + self.rungs.index(rung)
        if place < self.nearest.shape[1]:
            return np.interp(scale, self.scales, self.nearest[:, place])
        return rung.width * self._mixed(np.log(self._square(rung, scale)) / 2)

    def share_of_blocks(self, scale: Float, /) -> Float:
        """(...) share of a pixel's light that blocks alone spread."""
        return np.interp(scale, self.scales, self.nearest[:, 0])

    def beside_at(self, scale: Float, /) -> Float:
        """(..., 3) `beside` where the chart's scale is a."""
        shares: list[Float] = [np.interp(scale, self.scales, each) for each in self.beside.T]
        return np.stack(shares, -1)

    def less(self, excess: Float, /) -> Ladder:
        """Spreads so much less, (m,) at `scales`, where that is > 0: blocks first, then rungs.

        What is fitted beyond θ_min would take more within it than the kernel has.
        """
        nearest, excess = self.nearest.copy(), np.maximum(excess, 0)
        for column in range(nearest.shape[1]):
            taken = np.minimum(excess, nearest[:, column])
            nearest[:, column] -= taken
            excess = excess - taken
        return replace(self, nearest=nearest)

    def _mixed(self, log_sigma: Float) -> Float:
        return np.interp(log_sigma, self.mixture.log_sigma, self.mixture.share)

    def _fitted(self, kernel: Kernel, sides: Float, cell: float) -> tuple[Float, Float]:
        """`nearest` and `beside`, so that pixels of `sides` (m, 2) send what the kernel does."""
        # As if pixels were square: rungs are round. All but the height of a narrow pixel, which
        # counts for what lies far away; what lies near has more to do with its mean side.
        side = sides.max(1) ** HEIGHT * sides.min(1) ** (1 - HEIGHT)
        square = np.stack([side, side], -1)
        made, rest = self._made(square, cell)
        fine = side / math.radians(kernel.minimum_degrees)
        narrow = sides.max(1) / sides.min(1)
        expected = self._expected(square)
        shares = fitted(made, sent(kernel, square), rest, expected, fine, narrow)
        made, rest = self._made(sides, cell)
        missing = sent(kernel, sides) - np.einsum("mnk,mk->mn", made, shares) - rest
        # Neighbours within θ_min are on the plateau, which is right for none but all together.
        exchanged = np.clip((fine - 0.6) / 0.2, 0, 1)[:, None]
        return shares, exchanged * missing[:, NEIGHBOURS]

    def _expected(self, sides: Float) -> Float:
        """(m, 1 + n) shares of the blocks and the first rungs by W."""
        blocks = BLOCKS_WIDTH * self._mixed(np.log(BLOCKS_VARIANCE * np.prod(sides, 1)) / 2)
        return np.stack([blocks, *(self.share_of(r, self.scales) for r in self.rungs[:FITTED])], -1)

    def _made(self, sides: Float, cell: float) -> tuple[Float, Float]:
        """(m, n, 1 + k) what these send, by all of their share; (m, n) what all others do."""
        scale = self.scales
        chord = np.hypot(*np.moveaxis(sides[:, None] * OFFSETS, -1, 0))
        pairs = zip(chord, 1 - self.near(scale), strict=True)
        rest = self.mixture.floor + np.stack([self.mixture.per_sr(c, far) for c, far in pairs])
        for rung in self.rungs[FITTED:]:
            sigma = np.sqrt(self._square(rung, scale))[:, None]
            rest += self.share_of(rung, scale)[:, None] * bump(chord, sigma)
        parts: list[Float] = [np.broadcast_to(sent_by_blocks(), chord.shape)]
        for rung in self.rungs[:FITTED]:
            cells = cell * 2 ** (rung.level - 1) * scale[:, None] / sides
            parts.append(sent_by_filter(filters(rung.level)[rung.which], cells))
        return np.stack(parts, -1), rest * np.prod(sides, 1)[:, None]

    def _square(self, rung: Rung, scale: Float) -> Float:
        """(...) σ² of a rung in radians²."""
        return (rung.sigma * scale) ** 2 + np.interp(scale, self.scales, self.blocks)

    def near(self, scale: Float, /) -> Float:
        """(..., n) χ at the mixture's σ where the chart's scale is a (...)."""
        return _near(self.mixture.log_sigma - np.log(scale)[..., None], self.span)

    def per_sr(self, chord: Float, scale: Float, less: Float | float = 0.0, /) -> Float:
        """(...) what all rungs make at a chord between places of scales a and b, √(ab) given.

        σ² is `less` by so much, in radians², but not by more than half.
        """
        total = np.zeros(np.broadcast_shapes(np.shape(chord), np.shape(scale)))
        for rung in self.rungs:
            square = self._square(rung, scale)
            sigma = np.sqrt(np.maximum(square - less, square / 2))
            total += self.share_of(rung, scale) * bump(chord, sigma)
        return total


def _near(log_sigma: Float, span: tuple[float, float]) -> Float:
    along = np.clip((log_sigma - math.log(span[0])) / math.log(span[1] / span[0]), 0, 1)
    return 1 - along**2 * (3 - 2 * along)


def _rungs(cell: float, span: tuple[float, float]) -> tuple[Rung, ...]:
    found: list[tuple[int, int, float]] = []
    level = 1
    while not found or found[-1][2] < span[1]:
        for which in range(len(filters(level))):
            found.append((level, which, sigma_cells(level, which) * 2 ** (level - 1) * cell))
        level += 1
    sigmas = np.log([sigma for _, _, sigma in found])
    between = np.array([sigmas[0], *sigmas, 2 * sigmas[-1] - sigmas[-2]])
    widths = (between[2:] - between[:-2]) / 2
    first = FIRST_WIDTHS[: len(widths)]
    widths[: len(first)] = first
    near = widths * _near(sigmas, span)
    return tuple(Rung(*f, float(w)) for f, w in zip(found, near, strict=True) if w > 0)


def _nodes(view: View) -> tuple[Float, Float]:
    """(m,) scales of the nodes, increasing, and (m, 2) the width and height of a pixel there."""
    angle = np.linspace(math.radians(MOST_DEGREES), 0, NODES)
    scales = (1 + np.cos(angle)) / 2
    pixels = pixel_angles(view, scales)
    # Where there is none, as small as the least that there is in what is seen by most.
    pixels = np.maximum(pixels, LEAST_PIXEL * pixels.max())
    sides = np.stack([pixels, pixels], -1)
    if view.projection == "latlong":
        height = math.pi / view.height
        sides[:, 0] *= pixels / height
        sides[:, 1] = height
    return scales, sides
