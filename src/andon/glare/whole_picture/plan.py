"""What both engines draw the veil of one view with one kernel by.

::

    pixels ──reduce──▶ blocks ──spline──▶ D₁ ─▶ D₂ ─▶ … ─▶ D_T        light, [1 3 3 1]/8 a step
                                          │     │          │ far level F: M·D_F, true angles
    pixels ◀─expand── blocks ◀──spline── A₁ ◀─ A₂ ◀─ … ◀─ A_T         veil, [3 1]/4 a step
                                        A_l = Σ √w·P(√w·D_l) + expand(A_{l+1})

Conventions, for the light and the veil of each channel:

- blocks are 2×2 pixels with one beyond the border on each side (`charts.block_shape`); pixel p of
  an axis gives ¾ of its light L·ω to block ⌊p/2⌋ and ¼ to the nearer neighbour, and reads alike;
- D is light per area of the chart, cd·sr/unit²: a block adds (light/cell²)·B(u)·B(v) to the cells
  of level 1 around it, B the quadratic B-spline; `charts.Chart.array_place` says where it lies;
- levels hold D on the same scale: reduce averages, expand interpolates. Cells 2p and 2p + 1 of one
  level lie in cell p of the next; both have `MARGIN` cells more on each side, and zeros beyond;
- the sum is over the level's rungs, one filter P each (two from level 3 on, none at the top where
  only the far part is): √w of a cell is `WholePlan.root`, a function of the chart's scale a there,
  and P is separable, `splines.filters(level)[rung.which]` along each axis, of sum 1: the middle
  tap and those to one side;
- far: A_F += M·D_F from `light_cells` to `receiving_cells`, before A_F is expanded;
- veil of a block = Σ charts share(direction)·Σ B(u)·B(v)·A₁;
- what stays in a pixel is `1 − resolved(a)`, a of the chart that it is read from (of the larger
  share, where there are two), and out = (1 − resolved)·L + veil.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from andon.glare.kernel import Kernel
from andon.glare.whole_picture.charts import (
    Chart,
    block_directions,
    block_solid_angles,
    charts_of,
)
from andon.glare.whole_picture.far import Far, far_level, plan_far
from andon.glare.whole_picture.ladder import Ladder, Rung
from andon.glare.whole_picture.mixture import Mixture
from andon.glare.whole_picture.neighbours import Neighbours, neighbours_of
from andon.spaces import View

__all__ = ["WholePlan", "plan_whole"]

Float = NDArray[np.float64]

# χ begins to fall at a σ of so many coarse cells, and ends at so many.
FAR_CELLS = (0.8, 3.2)
# Where it is asked whether a rung spreads anything.
SCALES = 65


@dataclass(frozen=True, eq=False)
class WholePlan:
    """Everything that is settled before a picture is seen.

    Attributes
    ----------
    view, kernel : what it is for.
    charts : one, or two that share the sphere.
    ladder : the filters of the levels and their shares of light.
    far : the rest, between all pairs of coarse cells.
    neighbours : what pixels exchange with the eight around them, where that is coarse.
    """

    view: View
    kernel: Kernel
    charts: tuple[Chart, ...]
    ladder: Ladder
    far: Far
    neighbours: Neighbours | None

    @property
    def pair(self) -> bool:
        """Whether two charts share the sphere."""
        return len(self.charts) == 2

    @property
    def wraps(self) -> bool:
        """Whether the first blocks and the last are the same places, as in even panoramas."""
        return self.view.projection == "latlong" and self.view.width % 2 == 0

    @property
    def levels(self) -> int:
        """T, the last level that is needed: at least the far part's."""
        return max(self.ladder.levels, self.far.level)

    def rungs_of(self, level: int, /) -> list[Rung]:
        """Those of a level that spread any light: of fine pixels the finest do not."""
        coarse = (chart.scale(chart.cell_directions(self.levels)) for chart in self.charts)
        scales = np.linspace(min(float(scale.min()) for scale in coarse), 1, SCALES)
        own = (rung for rung in self.ladder.rungs if rung.level == level)
        return [rung for rung in own if self.ladder.share_of(rung, scales).any()]

    def root(self, rung: Rung, scale: Float, /) -> Float:
        """(...) √w of a rung where the chart's scale is a, units per radian."""
        return np.sqrt(self.ladder.share_of(rung, scale)) / scale

    def of_blocks(self) -> Float:
        """(rows, columns) veil of a block by its own rung, per cd·sr/m² of its light."""
        directions = block_directions(self.view)
        shares = (
            chart.share(directions, pair=self.pair)
            * self.ladder.share_of_blocks(chart.scale(directions))
            for chart in self.charts
        )
        solid = block_solid_angles(self.view)
        return np.divide(sum(shares), solid, where=solid > 0, out=np.zeros_like(solid))

    def resolved(self, scale: Float, /) -> Float:
        """(...) share of light that leaves its place at scale a, but for that to neighbours."""
        near = (self.ladder.share_of(rung, scale) for rung in self.ladder.rungs)
        far = np.interp(scale, self.far.scales, self.far.shares)
        return sum(near, far + self.ladder.share_of_blocks(scale))


def plan_whole(view: View, kernel: Kernel, /) -> WholePlan:
    """The plan of the veil that `kernel` makes in pictures of `view`."""
    charts = charts_of(view)
    mixture = Mixture.of(kernel)
    level = far_level(charts)
    cell = charts[0].cell
    start, end = (cell * 2 ** (level - 1) * cells for cells in FAR_CELLS)
    ladder = Ladder.of(view, kernel, mixture, cell, (start, end))
    far = plan_far(charts, level, kernel, mixture, ladder)
    plan = WholePlan(view, kernel, charts, ladder, far, neighbours_of(view, charts, ladder))
    most = kernel.share + kernel.core_share
    return replace(plan, ladder=ladder.less(plan.resolved(ladder.scales) - most))
