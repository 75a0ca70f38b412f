"""How much light each filter of each level spreads, where the chart's scale is a.

A *rung* is a filter of a level: rung k has σ_k = a·s_k, ``s_k = sigma_cells·2^(level−1)·cell``
(and what blocks of pixels add, which tells only in the first two), and takes
``W(σ_k)·χ(s_k)·(ln s_{k+1} − ln s_{k−1})/2`` of a point's light. χ goes from 1 to 0 over a few
coarse cells, whose angle goes with a as well; the rest of the mixture is the far part's.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.glare.whole_picture.charts import pixel_angles
from andon.glare.whole_picture.mixture import Mixture, bump
from andon.glare.whole_picture.splines import BLOCKS_VARIANCE, filters, sigma_cells
from andon.spaces import View

__all__ = ["Ladder", "Rung"]

Float = NDArray[np.float64]

# Widths of the first rungs in ln σ, where σ does not grow evenly and the first stands for all that
# is finer, too: least squares over θ⁻²…θ⁻³, from 2.8 cells of level 1 on (1.9 % at most).
FIRST_WIDTHS = (0.667, 0.670, 0.464, 0.306)
# Nodes of what blocks add.
SCALES = 129


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
    mixture : W, linear between its nodes, held beyond the ends.
    span : chart units, the s at which χ begins to fall and those at which it ends.
    """

    rungs: tuple[Rung, ...]
    scales: Float
    blocks: Float
    mixture: Mixture
    span: tuple[float, float]

    @staticmethod
    def of(view: View, mixture: Mixture, cell: float, span: tuple[float, float], /) -> Ladder:
        """The rungs of `mixture` for charts of cells of `cell`."""
        scales = np.linspace(0, 1, SCALES)
        blocks = BLOCKS_VARIANCE * pixel_angles(view, scales) ** 2
        return Ladder(_rungs(cell, span), scales, blocks, mixture, span)

    @property
    def levels(self) -> int:
        """The last level with a rung."""
        return self.rungs[-1].level

    def share_of(self, rung: Rung, scale: Float, /) -> Float:
        """(...) share of a point's light that a rung spreads where the chart's scale is a."""
        log_sigma = np.log(self._square(rung, scale)) / 2
        return rung.width * np.interp(log_sigma, self.mixture.log_sigma, self.mixture.share)

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
