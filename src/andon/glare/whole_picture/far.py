"""Far light: between all pairs of coarse cells, by the true angle between their directions.

Near a cell its kernel is what χ leaves of the mixture, ``K₀ + ∫ W·(1 − χ)·G dlnσ``; from a few
cells on it is the model less what the levels make of that very pair of cells. So far away the sum
of both is the model, with its fade beyond 90°, and with light beyond the border of a chart.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.glare.kernel import Kernel
from andon.glare.whole_picture.charts import Chart
from andon.glare.whole_picture.ladder import Ladder
from andon.glare.whole_picture.mixture import Mixture, bump
from andon.glare.whole_picture.splines import SPLINES_VARIANCE

__all__ = ["Far", "far_level", "plan_far"]

Float = NDArray[np.float64]
Index = NDArray[np.int64]

# All charts have at most this many coarse cells: pairs are their square.
MOST_CELLS = 800
# From how many coarse cells (of the axis) on the model itself is summed, and fully from where.
EXACT_CELLS = (2.0, 4.0)


@dataclass(frozen=True, eq=False)
class Far:
    """The far part.

    Attributes
    ----------
    level : F, whose cells it is between.
    light_cells, receiving_cells : (n, 3), (m, 3) chart, row and column in the arrays of level F.
    matrix : (m, n) veil of a receiving cell per D of a light cell.
    share : of a point's light that it spreads over the whole sphere.
    """

    level: int
    light_cells: Index
    receiving_cells: Index
    matrix: Float
    share: float


@dataclass(frozen=True, eq=False)
class _Cells:
    """Cells that are read or lit: (n, 3) indices, (n, 3) directions, (n,) share of their light."""

    indices: Index
    directions: Float
    share: Float


def far_level(charts: tuple[Chart, ...], /) -> int:
    """The finest level at which all charts together have at most `MOST_CELLS` cells in use."""
    level = 1
    # Where there is more than a lattice of a hundred thousand cells it need not be counted.
    while charts[0].level_size(level)[0] * charts[0].level_size(level)[1] > 128 * MOST_CELLS:
        level += 1
    while len(_cells(charts, level).share) > MOST_CELLS:
        level += 1
    return level


def plan_far(
    charts: tuple[Chart, ...], level: int, kernel: Kernel, mixture: Mixture, ladder: Ladder, /
) -> Far:
    """The far part between the cells of `level`."""
    cells = _cells(charts, level)
    lit = cells.share > 0
    sources = cells.directions[lit]
    width = charts[0].cell * 2 ** (level - 1)
    blend = _Blend(kernel, mixture, ladder, width)
    parts: list[Float] = []
    for index, chart in enumerate(charts):
        to = cells.directions[cells.indices[:, 0] == index]
        scale = np.sqrt(chart.scale(to)[:, None] * chart.scale(sources))
        place = chart.array_place(chart.place_from_direction(sources), 1)
        limit = np.array(chart.array_shape(1)[::-1]) - 1
        covered = ((place >= 0) & (place <= limit)).all(-1)
        parts.append(blend.matrix(to, sources, scale, covered))
    return Far(
        level,
        cells.indices[lit],
        cells.indices,
        np.concatenate(parts) * cells.share[lit] * width**2,
        blend.share(),
    )


def _cells(charts: tuple[Chart, ...], level: int) -> _Cells:
    found: list[_Cells] = []
    for index, chart in enumerate(charts):
        directions = chart.cell_directions(level)
        owned = chart.share(directions, pair=len(charts) == 2)
        # A spline reads one cell to each side of what lies within the chart's share.
        wide = np.pad(owned > 0, 1)
        rows, columns = owned.shape
        shifts = [wide[y : y + rows, x : x + columns] for y in range(3) for x in range(3)]
        y, x = np.nonzero(np.any(shifts, 0))
        indices = np.stack([np.full(len(y), index), y, x], -1)
        found.append(_Cells(indices, directions[y, x], owned[y, x]))
    fields = zip(*((c.indices, c.directions, c.share) for c in found), strict=True)
    indices, directions, share = (np.concatenate(field) for field in fields)
    return _Cells(indices, directions, share)


@dataclass(frozen=True)
class _Blend:
    """The far kernel: the mixture's rest near by, the model less the levels farther away."""

    kernel: Kernel
    mixture: Mixture
    ladder: Ladder
    width: float

    def matrix(self, to: Float, sources: Float, scale: Float, covered: NDArray[np.bool_]) -> Float:
        """(m, n) in sr⁻¹; `scale` (m, n) is √(ab), `covered` (n,) whether the levels have it."""
        chord = np.linalg.norm(to[:, None] - sources, axis=-1)
        theta = 2 * np.arcsin(np.minimum(chord / 2, 1))
        part = self._part(theta)
        # The splines at both ends add their own variance; what is narrower is left to them alone.
        spline = SPLINES_VARIANCE * (self.width * scale) ** 2
        near = np.full_like(chord, self.mixture.floor)
        step = self.mixture.log_sigma[1] - self.mixture.log_sigma[0]
        shares = step * self.mixture.share * self.ladder.left
        for log_sigma, share in zip(self.mixture.log_sigma, shares, strict=True):
            if share > 0:
                sigma = np.sqrt(np.maximum(np.exp(2 * log_sigma) - spline, spline))
                near += share * bump(chord, sigma)
        levels = np.where(covered, self.ladder.per_sr(chord, scale), 0.0)
        return (1 - part) * near + part * (self.kernel.per_sr(theta, core=True) - levels)

    def share(self) -> float:
        """Energy of the far kernel on the sphere."""
        count = 4000
        theta = (np.arange(count) + 0.5) * (np.pi / count)
        part = self._part(theta)
        rest = self.mixture.floor + self.mixture.per_sr(theta, self.ladder.left)
        near = self.mixture.per_sr(theta, 1 - self.ladder.left)
        value = (1 - part) * rest + part * (self.kernel.per_sr(theta, core=True) - near)
        return float(np.sum(value * np.sin(theta)) * (np.pi / count) * 2 * np.pi)

    def _part(self, theta: Float) -> Float:
        first, last = (cells * self.width for cells in EXACT_CELLS)
        along = np.clip((theta - first) / (last - first), 0, 1)
        return along**2 * (3 - 2 * along)
