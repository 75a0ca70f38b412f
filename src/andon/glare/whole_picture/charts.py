"""Stereographic charts: where directions lie in the plane that the pyramid is built on.

::

    place  (X, Y) = 2·(x, y)/(1 + z)      x, y, z of the direction in the chart's own axes
    scale  a = (1 + z)/2 = 1/(1 + |place|²/4)       radians of angle per unit of the chart
    chord² = |d₁ − d₂|² = |place₁ − place₂|²·a₁·a₂  exactly

Cells of level l = 1, 2, … are 2^(l−1)·`cell` wide. Cell i of an axis covers i…i + 1 in units of its
level, counted from `corner`; in arrays it lies at i + `MARGIN`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from andon.spaces import View

__all__ = [
    "BLOCK_PIXELS",
    "MARGIN",
    "Chart",
    "block_directions",
    "block_shape",
    "block_solid_angles",
    "block_view",
    "charts_of",
    "pixel_angles",
]

Float = NDArray[np.float64]

# Cells that are drawn beyond those that the picture covers, on each side, at each level: one that
# the quadratic spline of light on the border reaches, and one of zeros that the filter reads.
MARGIN = 2
# One chart serves up to here from its axis; the scale there is 0.18 of that on the axis.
SINGLE_REACH_DEGREES = 130.0
# Two charts about the vertical: each has the light up to this far from its axis …
PAIR_REACH_DEGREES = 125.0
# … and is read this far beyond the horizon, where one passes into the other.
BLEND_DEGREES = 6.0
# No scale is smaller: that of directions within 0.1° of straight behind.
LEAST_SCALE = 1e-6
# Pixels of the picture that a block is wide.
BLOCK_PIXELS = 2
# Pixels per cell of level 1, and by how much a wide field may be finer or coarser on the axis.
CELL_PIXELS = 2.0
FINEST, COARSEST = 0.6, 1.3


@dataclass(frozen=True, eq=False)
class Chart:
    """One stereographic chart and its lattice of level 1.

    Attributes
    ----------
    chart_from_camera : (3, 3) rotation; its last row is the chart's axis in the camera's frame.
    cell : width of a cell of level 1, chart units (radians on the axis).
    corner : (2,) the least X and Y that is covered.
    size : (rows, columns) cells of level 1 without margins.
    """

    chart_from_camera: Float
    cell: float
    corner: Float
    size: tuple[int, int]

    def place_from_direction(self, directions: Float, /) -> Float:
        """(..., 2) X and Y in units of level 1 from `corner`; far outside opposite to the axis."""
        own = directions @ self.chart_from_camera.T
        # Straight behind there is no place; 1e-9 puts it where no lattice reaches.
        plane = 2 * own[..., :2] / np.maximum(1 + own[..., 2:], 1e-9)
        return (plane - self.corner) / self.cell

    def direction_from_place(self, places: Float, /) -> Float:
        """(..., 3) unit directions in the camera's frame; inverse of `place_from_direction`."""
        plane = places * self.cell + self.corner
        scale = 1 / (1 + np.sum(plane**2, -1, keepdims=True) / 4)
        return np.concatenate([plane * scale, 2 * scale - 1], -1) @ self.chart_from_camera

    def scale(self, directions: Float, /) -> Float:
        """(...) a in (0, 1]: angle per unit of the chart."""
        # Straight behind it is 0, and so is a level there; where its logarithm is taken, all but.
        return np.maximum((1 + directions @ self.chart_from_camera[2]) / 2, LEAST_SCALE)

    def level_size(self, level: int, /) -> tuple[int, int]:
        """(rows, columns) of level ≥ 1 without margins."""
        step = 2 ** (level - 1)
        return -(-self.size[0] // step), -(-self.size[1] // step)

    def array_shape(self, level: int, /) -> tuple[int, int]:
        """(rows, columns) with margins."""
        rows, columns = self.level_size(level)
        return rows + 2 * MARGIN, columns + 2 * MARGIN

    def array_place(self, places: Float, level: int, /) -> Float:
        """(..., 2) fractional index (column, row) in the array of a level; centres are integers."""
        return places / 2 ** (level - 1) - 0.5 + MARGIN

    def cell_directions(self, level: int, /) -> Float:
        """(rows, columns, 3) where the cells of the array of a level look, margins too."""
        rows, columns = self.array_shape(level)
        y, x = np.mgrid[:rows, :columns] + 0.5 - MARGIN
        return self.direction_from_place(np.stack([x, y], -1) * 2.0 ** (level - 1))

    def share(self, directions: Float, degrees: float = BLEND_DEGREES, /, *, pair: bool) -> Float:
        """(...) in [0, 1] how much of what is there is this chart's; all charts sum to 1.

        One of a pair passes into the other between `degrees` above and below the horizon.
        """
        if not pair:
            return np.ones(directions.shape[:-1])
        height = directions @ self.chart_from_camera[2] / math.sin(math.radians(degrees))
        along = np.clip((height + 1) / 2, 0, 1)
        return along**2 * (3 - 2 * along)


def block_shape(view: View, /) -> tuple[int, int]:
    """(rows, columns) of blocks of 2×2 pixels, with one beyond the border on each side."""
    return -(-view.height // 2) + 2, -(-view.width // 2) + 2


def block_directions(view: View, /) -> Float:
    """(rows, columns, 3) unit, through the blocks' centres; beyond the border as well.

    Block b of an axis, b = −1 first, has its centre at pixel 2b + 0.5. Beyond the poles of a
    latlong picture the directions come down on the other side, beyond its sides they go round.
    """
    rows, columns = block_shape(view)
    y, x = np.mgrid[:rows, :columns].astype(np.float64) * 2 - 1.5
    return view.directions_at(np.stack([x, y], -1))


def block_view(view: View, /) -> View:
    """The pinhole or fisheye view whose pixels are the blocks of `view`, its border included."""
    rows, columns = block_shape(view)
    # Pixels a block; the array of a half has its index i at pixel 2i − 1.5 of the finer.
    across = BLOCK_PIXELS
    middle = (view.cx / across, view.cy / across)
    off = 1.5 * (across - 1) / across
    sizes = {"width": columns, "height": rows, "fx": view.fx / across, "fy": view.fy / across}
    return replace(view, cx=middle[0] + off, cy=middle[1] + off, distortion=(), **sizes)


def block_solid_angles(view: View, /) -> Float:
    """(rows, columns) of the pixels that read a block, by how much of it they read."""
    if view.projection != "latlong":
        return block_view(view).solid_angles()
    # Beyond a pole nothing reads it.
    rows = np.zeros(block_shape(view)[0])
    pixel = np.arange(view.height)
    own = pixel // 2 + 1
    solid = 2 * view.solid_angles()[:, 0]
    np.add.at(rows, own, 0.75 * solid)
    np.add.at(rows, own + np.where(pixel % 2 == 0, -1, 1), 0.25 * solid)
    return np.repeat(rows[:, None], block_shape(view)[1], 1)


def charts_of(view: View, /) -> tuple[Chart, ...]:
    """One chart about the optical axis, or two about the vertical for all that sees backwards."""
    pixel = _axis_pixel(view)
    if view.projection != "latlong":
        directions = block_directions(view)
        if directions[..., 2].min() > math.cos(math.radians(SINGLE_REACH_DEGREES)):
            return (_chart_of(view, directions, pixel),)
    cell = CELL_PIXELS * COARSEST * pixel
    radius = 2 * math.tan(math.radians(PAIR_REACH_DEGREES) / 2)
    half = math.ceil(radius / cell)
    axes = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])
    down = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
    return tuple(
        Chart(rotation, cell, np.full(2, -half * cell), (2 * half, 2 * half))
        for rotation in (axes, down)
    )


def pixel_angles(view: View, scales: Float, /) -> Float:
    """(n,) angle of a pixel, √(solid angle), where the scale of a chart of the view is a (n,).

    About the axis of projection; off it by as much as the principal point is off the middle. 0
    where no pixel is.
    """
    cosine = np.clip(2 * scales - 1, -1, 1)
    if view.projection == "latlong":
        # cos of the elevation, whose sine is the cosine to the vertical.
        form = np.sqrt(1 - cosine**2)
    elif view.projection == "fisheye":
        form = np.sinc(np.arccos(cosine) / np.pi)
    else:
        form = np.maximum(cosine, 0) ** 3
    return _axis_pixel(view) * np.sqrt(form)


def _axis_pixel(view: View) -> float:
    """Angle of a pixel on the axis, or of a row."""
    return math.pi / view.height if view.projection == "latlong" else (view.fx * view.fy) ** -0.5


def _chart_of(view: View, directions: Float, pixel: float) -> Chart:
    plane = 2 * directions[..., :2] / (1 + directions[..., 2:])
    corner, end = plane.min((0, 1)), plane.max((0, 1))
    # As many cells as there are blocks, but on the axis not far from CELL_PIXELS.
    extent: Float = end - corner
    pixels = view.width * view.height
    even = CELL_PIXELS * math.sqrt(float(extent[0]) * float(extent[1]) / pixels)
    cell = float(np.clip(even, FINEST * CELL_PIXELS * pixel, COARSEST * CELL_PIXELS * pixel))
    columns, rows = math.ceil(float(extent[0]) / cell), math.ceil(float(extent[1]) / cell)
    return Chart(np.eye(3), cell, corner, (rows, columns))
