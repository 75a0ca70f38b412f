"""How much light each filter of each level spreads, where the chart's scale is a.

A *rung* is a filter of a level: rung k has ``σ_k = sigma_cells·2^(level−1)·cell·a`` and takes
``W(σ_k)·χ(σ_k)·(ln σ_{k+1} − ln σ_{k−1})/2`` of a point's light. χ goes from 1 to 0 between two
angles; what is left of the mixture is the far part's.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.glare.whole_picture.mixture import Mixture, bump
from andon.glare.whole_picture.splines import filters, sigma_cells

__all__ = ["Ladder", "Rung"]

Float = NDArray[np.float64]

# Widths of the first rungs in ln σ, where σ does not grow evenly and the first stands for all that
# is finer, too: least squares over θ⁻²…θ⁻³, from 2.8 cells of level 1 on (1.9 % at most).
FIRST_WIDTHS = (0.667, 0.670, 0.464, 0.306)


@dataclass(frozen=True)
class Rung:
    """One filter of one level.

    Attributes
    ----------
    level, which : of `splines.filters(level)`.
    sigma : radians where the chart's scale is 1.
    width : in ln σ.
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
    log_sigma : (n,) evenly spaced ln σ, σ in radians.
    share : (n,) W·χ, share of a point's light per ln σ; linear in between, held beyond the ends.
    left : (n,) 1 − χ.
    """

    rungs: tuple[Rung, ...]
    log_sigma: Float
    share: Float
    left: Float

    @staticmethod
    def of(mixture: Mixture, cell: float, span: tuple[float, float], least_scale: float) -> Ladder:
        """The rungs of `mixture` for charts of cells of `cell` and scales from `least_scale` on.

        χ falls over the σ of `span`, in radians.
        """
        along = np.clip((mixture.log_sigma - math.log(span[0])) / math.log(span[1] / span[0]), 0, 1)
        left = along**2 * (3 - 2 * along)
        share = mixture.share * (1 - left)
        return Ladder(_rungs(cell, span[1] / least_scale), mixture.log_sigma, share, left)

    @property
    def levels(self) -> int:
        """The last level with a rung."""
        return self.rungs[-1].level

    def share_of(self, rung: Rung, scale: Float, /) -> Float:
        """(...) share of a point's light that a rung spreads where the chart's scale is a."""
        log_sigma = math.log(rung.sigma) + np.log(scale)
        return rung.width * np.interp(log_sigma, self.log_sigma, self.share)

    def per_sr(self, chord: Float, scale: Float, /) -> Float:
        """(...) what all rungs make at a chord between places of scales a and b, √(ab) given."""
        parts = [self.share_of(r, scale) * bump(chord, r.sigma * scale) for r in self.rungs]
        return np.sum(parts, 0)


def _rungs(cell: float, most_sigma: float) -> tuple[Rung, ...]:
    """Until the least of σ is beyond `most_sigma`, where no light is left."""
    found: list[tuple[int, int, float]] = []
    level = 1
    while not found or found[-1][2] < most_sigma:
        for which in range(len(filters(level))):
            found.append((level, which, sigma_cells(level, which) * 2 ** (level - 1) * cell))
        level += 1
    sigmas = np.log([sigma for _, _, sigma in found])
    between = [sigmas[0], *sigmas, 2 * sigmas[-1] - sigmas[-2]]
    widths = (np.array(between[2:]) - between[:-2]) / 2
    first = FIRST_WIDTHS[: len(widths)]
    widths[: len(first)] = first
    return tuple(Rung(*f, float(width)) for f, width in zip(found, widths, strict=True))
