"""A measured distribution as a plain table: type C, equal steps, for a texture of the GPU."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.photometry.model import Distribution
from andon.lamps.goniometry import candela, candela_at, maximum_cd

__all__ = ["UniformGrid", "uniform_grid"]

Float = NDArray[np.float64]

# Steps in degrees that angles of files are multiples of, widest first; a file whose angles are
# all multiples of one of them is met at its own knots, and a type C file then *is* the table.
STEPS_DEGREES = (10.0, 5.0, 2.5, 2.0, 1.0, 0.5, 0.25)
# For what is on none of them, and for types A and B, whose cells are curved in C and γ.
FALLBACK_DEGREES = 0.5
# Where the error is looked for: several directions in each cell, none on its corners.
PROBES_PER_CELL = ((0.5, 0.5), (0.25, 0.75), (0.75, 0.25))


@dataclass(frozen=True)
class UniformGrid:
    """Candela in equal steps of type C.

    Attributes
    ----------
    candela : (g, c) cd; row i is γ = i·180/(g − 1)°, column j is C = j·360/(c − 1)°; the last
        column is the first again. Two columns: the same light all around.
    error : largest deviation of the bilinear table from the distribution between the nodes, as a
        share of the maximum. At the edge of what was measured a step becomes a ramp of one cell,
        which counts here too.
    """

    candela: Float
    error: float

    def at(self, directions: Float, /) -> Float:
        """(...) cd towards unit directions (..., 3), bilinear: what a sampler returns."""
        x, y, z = np.moveaxis(np.asarray(directions, np.float64), -1, 0)
        rows, columns = self.candela.shape
        down = np.arctan2(np.hypot(x, y), -z) / np.pi * (rows - 1)
        along = np.arctan2(y, x) % (2 * np.pi) / (2 * np.pi) * (columns - 1)
        row = np.clip(down.astype(np.intp), 0, rows - 2)
        column = np.clip(along.astype(np.intp), 0, columns - 2)
        v, h = down - row, along - column
        table = self.candela
        top = (1 - h) * table[row, column] + h * table[row, column + 1]
        low = (1 - h) * table[row + 1, column] + h * table[row + 1, column + 1]
        return (1 - v) * top + v * low


def uniform_grid(
    distribution: Distribution,
    /,
    *,
    c_step_degrees: float | None = None,
    gamma_step_degrees: float | None = None,
) -> UniformGrid:
    """The distribution sampled at equal steps, which must divide 360° and 180°.

    By default the widest of `STEPS_DEGREES` of which all angles of a type C file are multiples:
    the table then equals the distribution up to rounding (and up to a dark half that begins with
    a step). Otherwise 0.5°, where an error of 1 % of the maximum is usual at sharp edges only;
    `UniformGrid.error` says it. A distribution that is the same all around has two columns.
    """
    given = (c_step_degrees, gamma_step_degrees)
    for step, whole in zip(given, (360, 180), strict=True):
        if step is not None and not (step > 0 and abs(whole / step - round(whole / step)) < 1e-9):
            raise InputError(f"must divide {whole}°, got {step:g}", field="step_degrees")
    c_step = c_step_degrees or _step(distribution, distribution.horizontal_degrees)
    gamma_step = gamma_step_degrees or _step(distribution, distribution.vertical_degrees)
    columns = round(360 / c_step) + 1
    if distribution.photometry == "C" and (distribution.candela == distribution.candela[0]).all():
        columns = 2
    rows = round(180 / gamma_step) + 1
    gamma = np.linspace(0, np.pi, rows)
    around = np.linspace(0, 2 * np.pi, columns)
    if distribution.photometry == "C":  # by angles: some files differ by plane even at the nadir
        table = candela_at(distribution, np.degrees(around), np.degrees(gamma)[:, None])
    else:
        table = candela(distribution, _directions(gamma[:, None], around))
    table[:, -1] = table[:, 0]
    grid = UniformGrid(table, 0.0)
    return UniformGrid(table, _error(grid, distribution))


def _step(distribution: Distribution, angles: Float) -> float:
    if distribution.photometry != "C":
        return FALLBACK_DEGREES
    for step in STEPS_DEGREES:
        # Steps must divide half a turn, too: all of STEPS_DEGREES do.
        if np.allclose(angles / step, np.rint(angles / step), rtol=0, atol=1e-6):
            return step
    return FALLBACK_DEGREES


def _directions(gamma: Float, around: Float) -> Float:
    """Unit directions (..., 3) of type C angles in radians."""
    parts = np.broadcast_arrays(
        np.sin(gamma) * np.cos(around), np.sin(gamma) * np.sin(around), -np.cos(gamma)
    )
    return np.stack(parts, axis=-1)


def _error(grid: UniformGrid, distribution: Distribution) -> float:
    rows, columns = grid.candela.shape
    cells = max(columns - 1, 8)  # around a table of two columns, too
    worst = 0.0
    for v, h in PROBES_PER_CELL:
        gamma = np.pi * (np.arange(rows - 1, dtype=np.float64) + v) / (rows - 1)
        around = 2 * np.pi * (np.arange(cells, dtype=np.float64) + h) / cells
        directions = _directions(gamma[:, None], around)
        deviation = np.abs(grid.at(directions) - candela(distribution, directions))
        worst = max(worst, float(deviation.max()))
    return worst / maximum_cd(distribution)
