"""Far light: between all pairs of coarse cells, by the true angle between their directions.

The kernel of the far part is what the levels leave: ``∫ W·(1 − χ)·G dlnσ``, and beyond 90° the
difference to the model too, which fades there as no sum of Gaussians does.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.glare.kernel import Kernel
from andon.glare.whole_picture.charts import Chart
from andon.glare.whole_picture.mixture import Mixture, chord_gaussian
from andon.glare.whole_picture.splines import SPLINE_VARIANCE

__all__ = ["Far", "far_level", "plan_far"]

Float = NDArray[np.float64]

# No chart has more coarse cells than this: pairs are their square.
MOST_CELLS = 600
# Where the true kernel takes over from the mixture, degrees.
EXACT_DEGREES = (25.0, 45.0)


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
    light_cells: NDArray[np.int64]
    receiving_cells: NDArray[np.int64]
    matrix: Float
    share: float


def far_level(charts: tuple[Chart, ...], /) -> int:
    """The finest level of which no chart has more than `MOST_CELLS` cells."""
    level = 1
    while max(c.level_size(level)[0] * c.level_size(level)[1] for c in charts) > MOST_CELLS:
        level += 1
    return level


def plan_far(
    charts: tuple[Chart, ...], level: int, kernel: Kernel, mixture: Mixture, near: Float, /
) -> Far:
    """The far part between the cells of `level`; `near` (n,) is χ over the mixture's σ."""
    ends = [_cells(charts, index, level) for index in range(len(charts))]
    cells = np.concatenate([e[0] for e in ends])
    directions = np.concatenate([e[1] for e in ends])
    owned = np.concatenate([e[2] for e in ends])
    scale = np.concatenate([e[3] for e in ends])
    lit = owned > 0
    width = charts[0].cell * 2 ** (level - 1)
    matrix = _matrix(
        kernel,
        mixture,
        near,
        directions,
        directions[lit],
        width**2 * np.sqrt(scale[:, None] * scale[lit]) ** 2 * 2 * SPLINE_VARIANCE,
    )
    return Far(
        level,
        cells[lit],
        cells,
        matrix * owned[lit] * width**2,
        _share(kernel, mixture, near),
    )


def _cells(
    charts: tuple[Chart, ...], index: int, level: int
) -> tuple[NDArray[np.int64], Float, Float, Float]:
    """Cells of a chart that are read or lit: their indices, directions, shares of light, scales."""
    chart = charts[index]
    directions = chart.cell_directions(level)
    owned = chart.share(directions, pair=len(charts) == 2)
    used = np.zeros(owned.shape, bool)
    # A spline reads one cell to each side of what lies within the chart's share.
    wide = np.pad(owned > 0, 1)
    for row in range(3):
        for column in range(3):
            used |= wide[row : row + used.shape[0], column : column + used.shape[1]]
    rows, columns = np.nonzero(used)
    cells = np.stack([np.full(len(rows), index), rows, columns], -1)
    seen = directions[used]
    return cells, seen, owned[used], chart.scale(seen)


def _matrix(
    kernel: Kernel, mixture: Mixture, near: Float, to: Float, of: Float, spline: Float
) -> Float:
    """(m, n) the far kernel in sr⁻¹; of each σ² is taken what the splines at both ends add."""
    chord = np.linalg.norm(to[:, None] - of, axis=-1)
    theta = 2 * np.arcsin(np.minimum(chord / 2, 1))
    step = mixture.log_sigma[1] - mixture.log_sigma[0]
    value = _beyond(kernel, mixture, theta)
    for log_sigma, share in zip(mixture.log_sigma, mixture.share * (1 - near), strict=True):
        if share > 0:
            sigma = np.sqrt(np.maximum(np.exp(2 * log_sigma) - spline, 0.3 * spline))
            value += step * share * chord_gaussian(chord, sigma)
    return value


def _beyond(kernel: Kernel, mixture: Mixture, theta: Float) -> Float:
    """What the model is more than the mixture, where the mixture ends."""
    first, last = np.radians(EXACT_DEGREES)
    along = np.clip((theta - first) / (last - first), 0, 1)
    grid = np.linspace(0, np.pi, 721)
    miss = kernel.per_sr(grid, core=True) - mixture.per_sr(grid)
    return along**2 * (3 - 2 * along) * np.interp(theta, grid, miss)


def _share(kernel: Kernel, mixture: Mixture, near: Float) -> float:
    grid = (np.arange(2000) + 0.5) * (np.pi / 2000)
    step = mixture.log_sigma[1] - mixture.log_sigma[0]
    beyond = np.sum(_beyond(kernel, mixture, grid) * np.sin(grid)) * (np.pi / 2000) * 2 * np.pi
    return float(step * np.sum(mixture.share * (1 - near)) + beyond)
