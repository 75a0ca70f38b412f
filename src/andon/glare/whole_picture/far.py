"""Far light: between all pairs of coarse cells, by the true angle between their directions.

Its kernel is what χ leaves of the mixture, ``K₀ + ∫ W·(1 − χ)·G dlnσ``, beyond some 30° what the
model differs from the mixture, and beyond a few cells what the levels lack: their ripple, and the
light that lies beyond the border of their chart. So far away the sum is the model with its fade.
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
# From how many coarse cells on the levels' own errors are made good, and fully where.
RESOLVED_CELLS = (2.0, 4.0)
# Where the model takes over from the mixture, which is fitted to 40°.
MODEL_DEGREES = (20.0, 40.0)
# Two charts pass light on to each other over a band that is wide against coarse cells: sums over
# cells then have all of it (0.3 % at ±20°).
LIGHT_BLEND_DEGREES = 20.0
# The scale of light that lies opposite to a chart's axis, where it has none.
LEAST_SCALE = 0.15
# Nodes of the table of the kernel, evenly over the chord 0…2 and over ln scale.
CHORDS, SCALES = 513, 17


@dataclass(frozen=True, eq=False)
class Far:
    """The far part.

    Attributes
    ----------
    level : F, whose cells it is between.
    light_cells, receiving_cells : (n, 3), (m, 3) chart, row and column in the arrays of level F.
    matrix : (m, n) veil of a receiving cell per D of a light cell.
    scales, shares : (n,) of a point's light it spreads `shares` over the whole sphere, where the
        chart's scale is one of `scales`.
    """

    level: int
    light_cells: Index
    receiving_cells: Index
    matrix: Float
    scales: Float
    shares: Float


@dataclass(frozen=True, eq=False)
class _Cells:
    """Cells that are read or lit: (n, 3) indices and directions, (n,) shares of light, if read."""

    indices: Index
    directions: Float
    share: Float
    read: NDArray[np.bool_]


def far_level(charts: tuple[Chart, ...], /) -> int:
    """The finest level at which all charts together have at most `MOST_CELLS` cells in use."""
    level = 1
    # Where there is more than a lattice of a hundred thousand cells it need not be counted.
    while charts[0].level_size(level)[0] * charts[0].level_size(level)[1] > 128 * MOST_CELLS:
        level += 1
    while _cells(charts, level).read.sum() > MOST_CELLS:
        level += 1
    return level


def plan_far(
    charts: tuple[Chart, ...], level: int, kernel: Kernel, mixture: Mixture, ladder: Ladder, /
) -> Far:
    """The far part between the cells of `level`."""
    cells = _cells(charts, level)
    lit, read = cells.share > 0, cells.read
    sources = cells.directions[lit]
    own = np.choose(cells.indices[:, 0], [c.scale(cells.directions) for c in charts])
    width = charts[0].cell * 2 ** (level - 1)
    table = _Table(kernel, mixture, ladder, width)
    parts: list[Float] = []
    for index, chart in enumerate(charts):
        to = cells.directions[read & (cells.indices[:, 0] == index)]
        place = chart.array_place(chart.place_from_direction(sources), 1)
        limit = np.array(chart.array_shape(1)[::-1]) - 1
        covered: NDArray[np.bool_] = np.all((place >= 0) & (place <= limit), axis=-1)
        chord = np.linalg.norm(to[:, None] - sources, axis=-1)
        levels = np.sqrt(chart.scale(to)[:, None] * np.maximum(chart.scale(sources), LEAST_SCALE))
        ends = (chart.scale(to)[:, None] ** 2 + own[lit] ** 2) / 2
        parts.append(table.matrix(chord, levels, ends, covered))
    matrix = np.concatenate(parts)
    behind = cells.directions[read] @ sources.T < 0
    matrix = _not_negative(matrix, behind, (cells.share * own**2)[read])
    scales = np.geomspace(float(own.min()), 1.0, SCALES).astype(np.float64)
    return Far(
        level,
        cells.indices[lit],
        cells.indices[read],
        matrix * cells.share[lit] * width**2,
        scales,
        table.shares(scales),
    )


def _cells(charts: tuple[Chart, ...], level: int) -> _Cells:
    found: list[_Cells] = []
    for index, chart in enumerate(charts):
        directions = chart.cell_directions(level)
        owned = chart.share(directions, LIGHT_BLEND_DEGREES, pair=len(charts) == 2)
        shown = chart.share(directions, pair=len(charts) == 2)
        # A spline reads one cell to each side of what lies within the chart's share.
        wide = np.pad(shown > 0, 1)
        rows, columns = owned.shape
        shifts = [wide[y : y + rows, x : x + columns] for y in range(3) for x in range(3)]
        read = np.any(shifts, 0)
        y, x = np.nonzero(read | (owned > 0))
        indices = np.stack([np.full(len(y), index), y, x], -1)
        found.append(_Cells(indices, directions[y, x], owned[y, x], read[y, x]))
    fields = zip(*((c.indices, c.directions, c.share, c.read) for c in found), strict=True)
    indices, directions, share, read = (np.concatenate(field) for field in fields)
    return _Cells(indices, directions, share, read)


def _not_negative(matrix: Float, behind: NDArray[np.bool_], areas: Float) -> Float:
    """`matrix` (m, n) with nothing below 0 `behind` (m, n) a source, and no more light there.

    Where the model fades, what the splines spread has been taken off, which may be too much.
    """
    lifted = np.maximum(matrix, 0)
    before, after = (areas @ np.where(behind, part, 0.0) for part in (matrix, lifted))
    factor = np.divide(before, after, where=(after > 0) & (before > 0), out=np.zeros_like(after))
    return np.where(behind, lifted * factor, matrix)


@dataclass(frozen=True)
class _Table:
    """The far kernel over the chord and the scales a and b of both ends, in sr⁻¹.

    Levels see both in one chart; cells are as wide as they are in their own.

    Both splines spread what the matrix makes, by v = `SPLINES_VARIANCE`·(a² + b²)/2 cells²; so
    every bump is narrower by v, and what is not made of bumps less by v/2 of its Laplacian.
    """

    kernel: Kernel
    mixture: Mixture
    ladder: Ladder
    width: float

    def matrix(self, chord: Float, scale: Float, ends: Float, covered: NDArray[np.bool_]) -> Float:
        """(m, n) of chords (m, n), √(ab) and (a² + b²)/2; `covered` (n,) is what levels have."""
        chords = np.linspace(0, 2, CHORDS)
        ends_of = float(scale.min()) * (1 - 1e-9), float(scale.max()) * (1 + 1e-9)
        scales = np.geomspace(*ends_of, SCALES).astype(np.float64)
        x = chord / 2 * (CHORDS - 1)
        y = np.log(scale / scales[0]) / np.log(scales[-1] / scales[0]) * (SCALES - 1)
        # All but linear in v.
        even, levels = self._tables(chords, scales, 1.0)
        uneven, _ = self._tables(chords, scales, 1.25)
        ratio = ends / scale**2
        value = _bilinear(even, y, x) + (ratio - 1) / 0.25 * _bilinear(uneven - even, y, x)
        return value + np.where(covered, 0.0, _bilinear(levels, y, x))

    def shares(self, scales: Float) -> Float:
        """(n,) energy of the far kernel on the sphere, of light where the scale is a (n,)."""
        count = 2000
        theta: Float = (np.arange(count, dtype=np.float64) + 0.5) * (np.pi / count)
        rest = self.mixture.per_sr(theta, 1 - self.ladder.near(scales))
        value = rest.T + self.mixture.floor + self._miss(theta)
        return value @ np.sin(theta) * (np.pi / count) * 2 * np.pi

    def _tables(self, chords: Float, scales: Float, ratio: float) -> tuple[Float, Float]:
        """(scales, chords) the far kernel where levels have the source, and what levels make."""
        theta = 2 * np.arcsin(chords / 2)
        spline = ratio * SPLINES_VARIANCE * (self.width * scales[:, None]) ** 2
        sigma = np.exp(self.mixture.log_sigma)
        step = self.mixture.log_sigma[1] - self.mixture.log_sigma[0]
        narrowed = np.sqrt(np.maximum(sigma**2 - spline, sigma**2 / 2))[:, None]
        bumps = step * self.mixture.share * bump(chords[:, None], narrowed)
        near = np.sum(bumps * self.ladder.near(scales)[:, None], -1)
        levels = self.ladder.per_sr(chords, scales[:, None], spline)
        grid = np.linspace(0, np.pi, 721)
        miss = self._miss(grid)
        slope = np.gradient(miss, grid)
        laplacian = np.gradient(slope, grid) + slope / np.tan(np.clip(grid, 1e-3, np.pi - 1e-3))
        model = np.interp(theta, grid, miss) - spline / 2 * np.interp(theta, grid, laplacian)
        first, last = (cells * self.width * scales[:, None] for cells in RESOLVED_CELLS)
        part = _smooth((theta - first) / (last - first))
        rest = bumps.sum(-1) - near + part * (near - levels)
        return self.mixture.floor + rest + model, part * levels

    def _miss(self, theta: Float) -> Float:
        """What the model has more than the mixture, where that ends."""
        first, last = np.radians(MODEL_DEGREES)
        part = _smooth((theta - first) / (last - first))
        mixture = self.mixture.floor + self.mixture.per_sr(theta)
        return part * (self.kernel.per_sr(theta, core=True) - mixture)


def _smooth(along: Float) -> Float:
    along = np.clip(along, 0, 1)
    return along**2 * (3 - 2 * along)


def _bilinear(table: Float, y: Float, x: Float) -> Float:
    row = np.clip(y.astype(np.int64), 0, table.shape[0] - 2)
    column = np.clip(x.astype(np.int64), 0, table.shape[1] - 2)
    down, right = y - row, x - column
    upper = (1 - right) * table[row, column] + right * table[row, column + 1]
    lower = (1 - right) * table[row + 1, column] + right * table[row + 1, column + 1]
    return (1 - down) * upper + down * lower
