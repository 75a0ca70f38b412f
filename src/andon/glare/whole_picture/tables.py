"""What the GPU looks up instead of computing: where blocks and cells lie in one another.

Made on the host in float64 by the functions that the reference calls, so that no shader knows a
projection; read as float32, whose 24 bits are a thousandth of a cell in the largest picture.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.glare.whole_picture.charts import (
    BLOCK_PIXELS,
    Chart,
    block_directions,
    block_shape,
    block_view,
)
from andon.glare.whole_picture.far import Far
from andon.glare.whole_picture.neighbours import Neighbours
from andon.glare.whole_picture.plan import WholePlan

__all__ = [
    "STRIP",
    "Windows",
    "block_factors",
    "block_places",
    "far_tables",
    "neighbour_tables",
    "windows",
]

Float = NDArray[np.float64]

# Cells of the spline to each side, and how far off, in cells, a flat window may be.
SUPPORT, FLAT = 1.5, 0.02
# Windows of more blocks than this are looked through one by one, each for as many as it needs.
LARGEST_FLAT = 8
# Columns of a picture that holds the far light of the receiving cells.
STRIP = 64


@dataclass(frozen=True, eq=False)
class Windows:
    """Which blocks each cell of level 1 looks at.

    Attributes
    ----------
    size : (columns, rows) of blocks, the same for all; None: as `first` says.
    first : (rows, columns, 4) first column and row of blocks; and the place of that block less
        that of the cell, or the numbers of columns and rows.
    steps : (…, 4) what a column and a row of blocks add to the place; or the places of the blocks.
    """

    size: tuple[int, int] | None
    first: Float
    steps: Float


def block_factors(plan: WholePlan, chart: Chart, /) -> Float:
    """(rows, columns, 4) solid angle of a pixel by the area of a cell of level 1, the blocks' own
    rung by that area, and by how much the former grows, relatively, with a column and a row.

    Of latlong the former is that at the horizon: the shader has the cosine of the row.
    """
    view = plan.view
    own = plan.of_blocks() * chart.cell**2
    if view.projection == "latlong":
        # Rows are zones: the sine of half their height takes the place of the half.
        horizon = 2 * np.sin(np.pi / view.height / 2) * 2 * np.pi / view.width
        solid = np.full(block_shape(view), horizon)
    else:
        solid = block_view(view).solid_angles() / BLOCK_PIXELS**2
    along, across = np.gradient(np.log(solid)) if min(solid.shape) > 1 else (0 * solid, 0 * solid)
    growth = (across / BLOCK_PIXELS, along / BLOCK_PIXELS)
    return np.stack([solid / chart.cell**2, own, *growth], -1)


def neighbour_tables(neighbours: Neighbours, /) -> tuple[Float, Float]:
    """(H, W, 4) what is exchanged, in units of a solid angle, and (H, W, 2) that unit by the solid
    angle of a pixel and the share of its light that leaves it."""
    unit = float(neighbours.solid_angles.mean())
    factors = np.stack([unit / neighbours.solid_angles, neighbours.share()], -1)
    return neighbours.exchanged / unit, factors


def block_places(plan: WholePlan, chart: Chart, /) -> Float:
    """(rows, columns, 4) place in level 1, the chart's share, and of it what stays in a pixel."""
    directions = block_directions(plan.view)
    places = chart.array_place(chart.place_from_direction(directions), 1)
    share = chart.share(directions, pair=plan.pair)
    stays = share * (1 - plan.resolved(chart.scale(directions)))
    # Where a chart has no share it may have no place either.
    places = np.clip(places, -1e6, 1e6)
    return np.concatenate([places, share[..., None], stays[..., None]], -1)


def windows(plan: WholePlan, chart: Chart, /) -> Windows:
    """Windows of one size with flat steps where these are exact enough, else exact ones."""
    places = chart.array_place(chart.place_from_direction(block_directions(plan.view)), 1)
    if plan.view.projection != "latlong":
        flat = _flat(plan, chart, places)
        if flat is not None:
            return flat
    return _exact(chart, places)


def _flat(plan: WholePlan, chart: Chart, places: Float) -> Windows | None:
    """Windows about each cell's own block."""
    rows, columns = places.shape[:2]
    shape = chart.array_shape(1)
    at = block_view(plan.view).project(chart.cell_directions(1))
    # Cells far outside look at the nearest blocks, in vain.
    at = np.clip(np.nan_to_num(at, nan=0.0), [-1, -1], [columns, rows])
    size = _window_size(places)
    if max(size) > LARGEST_FLAT or size[0] > columns or size[1] > rows:
        return None
    first = np.clip(
        np.ceil(at - np.array(size) / 2).astype(int), 0, [columns, rows] - np.array(size)
    )
    x, y = first[..., 0], first[..., 1]
    wide, tall = size[0] - 1, size[1] - 1
    corners = [places[y + j, x + i] for j in (0, tall) for i in (0, wide)]
    across = (corners[1] - corners[0] + corners[3] - corners[2]) / (2 * max(wide, 1))
    along = (corners[2] - corners[0] + corners[3] - corners[1]) / (2 * max(tall, 1))
    middle = places[y + tall // 2, x + wide // 2]
    start = middle - across * (wide // 2) - along * (tall // 2)
    cells = np.stack(np.meshgrid(np.arange(shape[1]), np.arange(shape[0])), -1)
    off = 0.0
    for i, j in ((0, 0), (wide, 0), (0, tall), (wide, tall), (wide // 2, tall), (wide, tall // 2)):
        there = places[y + j, x + i]
        error = np.abs(there - start - i * across - j * along).max(-1)
        # What lies beyond the spline may be anywhere beyond it.
        error[np.abs(there - cells).max(-1) > SUPPORT] = 0
        off = max(off, float(error.max()))
    if off > FLAT:
        return None
    return Windows(
        size,
        np.concatenate([first.astype(float), start - cells], -1),
        np.concatenate([across, along], -1),
    )


def _window_size(places: Float) -> tuple[int, int]:
    """(columns, rows) of blocks that may lie within the spline of a cell."""
    across, along = np.gradient(places, axis=1), np.gradient(places, axis=0)
    area = np.abs(across[..., 0] * along[..., 1] - across[..., 1] * along[..., 0])
    # Half a window is that of the box of the spline, brought back to blocks.
    columns = (np.abs(along[..., 1]) + np.abs(along[..., 0])) / area * SUPPORT
    rows = (np.abs(across[..., 0]) + np.abs(across[..., 1])) / area * SUPPORT
    # The shader takes four columns at a time.
    return 4 * int(np.ceil(columns.max() / 2)), int(np.ceil(2 * rows.max()))


def _exact(chart: Chart, places: Float) -> Windows:
    """The least window that holds all blocks within the spline; columns may go round."""
    rows, columns = chart.array_shape(1)
    first = np.zeros((rows, columns, 4))
    best = np.full((rows, columns, 4), [np.inf, np.inf, -np.inf, -np.inf])
    height, width = places.shape[:2]
    y, x = np.mgrid[:height, :width]
    near = np.floor(places + 0.5)
    for j in (-1, 0, 1):
        for i in (-1, 0, 1):
            cx, cy = near[..., 0] + i, near[..., 1] + j
            ok = (cx >= 0) & (cy >= 0) & (cx < columns) & (cy < rows)
            at = cy[ok].astype(int), cx[ok].astype(int)
            np.minimum.at(best[..., 0], at, x[ok])
            np.minimum.at(best[..., 1], at, y[ok])
            np.maximum.at(best[..., 2], at, x[ok])
            np.maximum.at(best[..., 3], at, y[ok])
    lit = np.isfinite(best[..., 0])
    first[lit, :2] = best[lit, :2]
    first[lit, 2:] = best[lit, 2:] - best[lit, :2] + 1
    return Windows(None, first, np.concatenate([places, np.zeros_like(places)], -1).clip(-1e6, 1e6))


def far_tables(
    far: Far, shapes: list[tuple[int, int]], /
) -> tuple[NDArray[np.uint32], Float, list[NDArray[np.uint32]]]:
    """Lit cells (1, n, 4), the matrix (m, n/4, 4), and of each chart's cells one more than their
    row in it, 0 where there is none. n is made a multiple of 4 with cells of no weight."""
    count = -(-len(far.light_cells) // 4) * 4
    lit = np.zeros((1, count, 4), np.uint32)
    lit[0, : len(far.light_cells), :3] = far.light_cells
    matrix = np.zeros((len(far.matrix), count))
    matrix[:, : len(far.light_cells)] = far.matrix
    places = [np.zeros(shape, np.uint32) for shape in shapes]
    for index, (chart, row, column) in enumerate(far.receiving_cells):
        places[chart][row, column] = index + 1
    return lit, matrix.reshape(len(matrix), count // 4, 4), places
