"""How much light each level of the pyramid spreads, where the chart's scale is a.

Level l has ``σ_l = sigma_cells(l)·2^(l−1)·cell·a`` and takes ``ln 2·W(σ_l)·χ(σ_l)`` of a point's
light. χ goes from 1 to 0 between two angles; what is left of the mixture is the far part's.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.glare.whole_picture.mixture import Mixture, bump
from andon.glare.whole_picture.splines import sigma_cells

__all__ = ["Ladder"]

Float = NDArray[np.float64]

# Level 1 stands for everything finer, too; measured on θ⁻²…θ⁻³, six pixels away and beyond.
FIRST_SHARE = 0.85


@dataclass(frozen=True, eq=False)
class Ladder:
    """The levels of all charts.

    Attributes
    ----------
    cell : of level 1, chart units; all charts have the same.
    count : T, the last level.
    log_sigma : (n,) evenly spaced ln σ, σ in radians.
    share : (n,) of a point's light that a level of that σ spreads; linear in between, held beyond
        the ends.
    left : (n,) 1 − χ.
    """

    cell: float
    count: int
    log_sigma: Float
    share: Float
    left: Float

    @staticmethod
    def of(mixture: Mixture, cell: float, span: tuple[float, float], least_scale: float) -> Ladder:
        """The levels of `mixture` with χ falling over the σ of `span`, in radians."""
        along = (mixture.log_sigma - math.log(span[0])) / math.log(span[1] / span[0])
        left = np.clip(along, 0, 1) ** 2 * (3 - 2 * np.clip(along, 0, 1))
        last = math.log2(span[1] / (sigma_cells(64) * cell * least_scale))
        share = math.log(2) * mixture.share * (1 - left)
        return Ladder(cell, 1 + max(0, math.ceil(last)), mixture.log_sigma, share, left)

    def sigma(self, level: int, scale: Float, /) -> Float:
        """(...) σ in radians of a level where the chart's scale is a."""
        return sigma_cells(level) * 2 ** (level - 1) * self.cell * scale

    def share_of(self, level: int, scale: Float, /) -> Float:
        """(...) share of a point's light that a level spreads where the chart's scale is a."""
        share = np.interp(np.log(self.sigma(level, scale)), self.log_sigma, self.share)
        return share * FIRST_SHARE if level == 1 else share

    def per_sr(self, chord: Float, scale: Float, /) -> Float:
        """(...) what all levels make at a chord between places of scales a and b, √(ab) given."""
        levels = range(1, self.count + 1)
        return np.sum(
            [self.share_of(n, scale) * bump(chord, self.sigma(n, scale)) for n in levels], 0
        )
