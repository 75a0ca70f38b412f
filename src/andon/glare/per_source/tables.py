"""Tables of the veil of 1 lx around one outline, and how they are looked up.

Columns are distances from the edge, so that the edge, where the veil is steepest, is a column of
its own; rows go around it (one for a circle). Both are those of `coordinates.py`:

::

      column  0 ─────────── EDGE ───────────────────────── last
      where   middle        m = m0(ν)                      antipode
      spacing logarithmic from the edge, both ways: log₂ q, q = 1 + |m − m0|/s;
              far away also by (m − m0)², since all veils end between 90° and 110°
      value   V             V·q²   (what falls as θ⁻² is then constant, as θ⁻³ falls slowly)

Between columns and rows values are linear. Rows are dense where the edge bends; `rows_at` says
which row an azimuth is on.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.glare.kernel import Kernel
from andon.glare.model import Outline
from andon.glare.per_source.convolution import disc_veil, edge_points, outline_veil
from andon.glare.per_source.coordinates import Confocal, chord, confocal_of
from andon.glare.per_source.model import Bloom

__all__ = [
    "COLUMNS",
    "EDGE",
    "EDGES",
    "FAR_COLUMNS",
    "ROWS",
    "VeilTable",
    "columns_of",
    "convolved_table",
    "outline_table",
    "table_of",
]

Float = NDArray[np.float64]


COLUMNS, EDGE = 224, 32
# Columns that (m − m0)² adds up to the antipode of a point.
FAR_COLUMNS = 40
# Rows around an outline that is no circle, and steps around of the edge itself, which is finer
# than the light beside it.
ROWS, EDGES = 128, 1024
# Rows go in equal parts to azimuth and to the bends of the edge; a corner's are spread over this
# many times θ_min along the edge.
CORNER = 5.0
# Evaluations per column, where means are taken (see `_blurred`).
FINE = 4


@dataclass(frozen=True, eq=False)
class VeilTable:
    """The veil of one outline.

    Attributes
    ----------
    values : (rows, COLUMNS) cd/m² per lux, as above.
    beyond : (rows, COLUMNS) radians from the outline, 0 inside: where the halo's ring is.
    edge : (EDGES,) m0 at ν = 2π·i/EDGES; (1,) of a circle.
    rows_at : (EDGES + 1,) row, 0…rows, at the same ν and at 2π; of a circle (0, 0).
    frame : coordinates of the outline.
    step : s, a chord.
    per_octave : columns per doubling of q outside.
    """

    values: Float
    beyond: Float
    edge: Float
    rows_at: Float
    frame: Confocal
    step: float
    per_octave: float

    def at(self, x: Float, y: Float, /) -> Float:
        """(...) cd/m² per lux at places (...) of Lambert's chart, x along the long axis."""
        where = self._where(x, y)
        return where[2] * _between(self.values, *where[:2])

    def beyond_at(self, x: Float, y: Float, /) -> Float:
        """(...) radians from the outline at the same places, 0 inside."""
        return _between(self.beyond, *self._where(x, y)[:2])

    def _where(self, x: Float, y: Float) -> tuple[Float, Float, Float]:
        """Rows and columns (...), and the factors on values."""
        m, nu = self.frame.of(x, y)
        before, after, share = _neighbours(nu / (2 * np.pi) * len(self.edge), len(self.edge))
        edge = (1 - share) * self.edge[before] + share * self.edge[after]
        row = (1 - share) * self.rows_at[before] + share * self.rows_at[before + 1]
        return row, *self.columns(m, edge)

    def columns(self, m: Float, edge: Float, /) -> tuple[Float, Float]:
        """Columns (...) of m (...) where the edge is at `edge`, and the factors on values."""
        beyond = (m - edge) / self.step
        octaves = np.log2(1 + np.abs(beyond))
        inside = EDGE * (1 - octaves / self._inside(edge))
        outside = EDGE + self._outside(beyond)
        factor = np.where(beyond < 0, 1.0, (1 + np.maximum(beyond, 0)) ** -2)
        return np.clip(np.where(beyond < 0, inside, outside), 0, COLUMNS - 1), factor

    def distances(self, edge: Float, columns: Float, /) -> Float:
        """m of `columns` where the edge is at `edge`, broadcast."""
        inside = self._inside(edge) * (1 - columns / EDGE)
        logs = np.linspace(0, float(np.log1p(2 / self.step)), 4 * COLUMNS)
        steps = np.asarray(np.expm1(logs), np.float64)
        outside = np.asarray(np.interp(columns - EDGE, self._outside(steps), steps), np.float64)
        beyond = np.where(columns < EDGE, 1 - 2 ** np.maximum(inside, 0), outside)
        return np.maximum(edge + self.step * beyond, self.frame.focus)

    def _outside(self, beyond: Float) -> Float:
        """Columns from the edge of (m − m0)/s ≥ 0."""
        far = FAR_COLUMNS / 4 * (self.step * beyond) ** 2
        return self.per_octave * np.log2(1 + np.abs(beyond)) + far

    def _inside(self, edge: Float) -> Float:
        """Octaves from the edge to the middle."""
        return np.log2(1 + (edge - self.frame.focus) / self.step)


@lru_cache(maxsize=256)
def _table(kernel: Kernel, radii: bytes, core: bool, bloom: Bloom | None) -> VeilTable:
    outline = Outline(np.frombuffer(radii, np.float64))
    if bloom is None:
        return convolved_table(kernel, outline, core=core)
    return outline_table(kernel, outline, bloom)


def table_of(
    kernel: Kernel, outline: Outline, /, *, core: bool, bloom: Bloom | None = None
) -> VeilTable:
    """The table of an outline, kept: `convolved_table`, or `outline_table` where there is `bloom`.

    2 ms for a circle, 50 to 250 ms for others.
    """
    return _table(kernel, outline.radii_radians.tobytes(), core, bloom)


def convolved_table(kernel: Kernel, outline: Outline, /, *, core: bool) -> VeilTable:
    """The table of K ⊗ a uniform `outline`; with `core` the plateau within θ_min, too."""

    def veil(points: Float) -> Float:
        if len(outline.radii_radians) > 1:
            return outline_veil(kernel, outline, points, core=core)
        theta = 2 * np.arcsin(np.minimum(np.linalg.norm(points - [0, 0, 1.0], axis=-1) / 2, 1))
        return disc_veil(kernel, float(outline.radii_radians[0]), theta, core=core)

    return _filled(kernel, outline, veil, fine=1 if core else FINE)


def outline_table(kernel: Kernel, outline: Outline, bloom: Bloom, /) -> VeilTable:
    """The table of the paper's form: `bloom` of θ − θ0(φ), which is no convolution."""

    def veil(points: Float) -> Float:
        theta = np.arctan2(np.hypot(points[:, 0], points[:, 1]), points[:, 2])
        phi = np.arctan2(points[:, 1], points[:, 0])
        return bloom(np.degrees(theta - outline.radius(phi)))

    return _filled(kernel, outline, veil, fine=1)


def _filled(
    kernel: Kernel, outline: Outline, veil: Callable[[Float], Float], *, fine: int
) -> VeilTable:
    """The table of `veil` at unit vectors (n, 3), looked at `fine` times for each column."""
    table, nu = _empty(kernel, outline)
    columns = np.arange((COLUMNS - 1) * fine + 1) / fine
    kept, index = _mirrored(table.edge, len(nu))
    edge = np.interp(nu[kept], 2 * np.pi * np.arange(len(table.edge)) / len(table.edge), table.edge)
    m = table.distances(edge[:, None], columns)
    points = table.frame.directions(m, np.broadcast_to(nu[kept][:, None], m.shape))
    values = veil(points.reshape(-1, 3)).reshape(m.shape) / table.columns(m, edge[:, None])[1]
    table.values[:] = (values if fine == 1 else _blurred(values))[index]
    table.beyond[:] = _beyond(outline, points[:, ::fine])[index]
    return table


def _beyond(outline: Outline, points: Float) -> Float:
    """Radians (rows, COLUMNS) from the outline to `points` outside, 0 inside."""
    if len(outline.radii_radians) == 1:
        theta = np.arctan2(np.hypot(points[..., 0], points[..., 1]), points[..., 2])
        return np.maximum(theta - outline.radii_radians[0], 0)
    nearest = np.max(points[:, EDGE:] @ edge_points(outline).T, axis=-1)
    beyond = np.zeros(points.shape[:2])
    beyond[:, EDGE:] = np.arccos(np.clip(nearest, -1, 1))
    return beyond


def _empty(kernel: Kernel, outline: Outline) -> tuple[VeilTable, Float]:
    """A table without values, and ν of its rows."""
    if len(outline.radii_radians) == 1:
        edge, rows_at, nu = chord(outline.radii_radians), np.zeros(2), np.zeros(1)
        frame = Confocal(0.0, 0.0)
    else:
        frame = confocal_of(outline)
        edge = frame.edge(outline, EDGES)
        rows_at = _rows(frame, edge, chord(np.radians(kernel.minimum_degrees)))
        nu = np.interp(np.arange(ROWS), rows_at, np.linspace(0, 2 * np.pi, EDGES + 1))
    step, per_octave = columns_of(kernel, outline)
    values, beyond = np.empty((2, len(nu), COLUMNS))
    return VeilTable(values, beyond, edge, rows_at, frame, step, per_octave), nu


def columns_of(kernel: Kernel, outline: Outline, /) -> tuple[float, float]:
    """s and the columns per octave, which are those of all outlines.

    The end of the core, which is a bend at θ_min from a point, lies on a column: two octaves out.
    """
    least = float(chord(np.radians(kernel.minimum_degrees)))
    radius = np.sqrt(outline.solid_angle_sr / np.pi)
    step = (least - radius) / 3 if 2 * radius < least else least / 6
    octaves = np.log2(1 + 12 / least)
    return float(step), float(np.floor(2 * (COLUMNS - 1 - EDGE - FAR_COLUMNS) / octaves) / 2)


def _rows(frame: Confocal, edge: Float, least: Float) -> Float:
    """(EDGES + 1,) rows at equal steps of ν, 0 at ν = 0."""
    nu = 2 * np.pi * np.arange(EDGES) / EDGES
    place = np.stack(frame.places(edge, nu), axis=-1)
    side = np.roll(place, -1, axis=0) - place
    length = np.linalg.norm(side, axis=1)
    heading = np.unwrap(np.arctan2(side[:, 1], side[:, 0]))
    bend = np.abs(np.diff(heading, prepend=heading[-1] - 2 * np.pi))
    # Bends spread along the edge: the difference of their sums at ± half a width.
    along = length.cumsum() - length
    width, whole = min(CORNER * float(least), length.sum() / 8), length.sum()
    three = np.concatenate([along - whole, along, along + whole])
    turned = np.concatenate([bend.cumsum() + k * bend.sum() for k in (-1, 0, 1)])
    behind = np.asarray(np.interp(along + length / 2 - width / 2, three, turned), np.float64)
    ahead = np.asarray(np.interp(along + length / 2 + width / 2, three, turned), np.float64)
    density = 1 / EDGES + (ahead - behind) / width * length / bend.sum()
    # Mirrored in both axes, so that mirrored outlines have mirrored rows.
    density = density + density[::-1]
    density = density + np.roll(density, EDGES // 2)
    rows = np.concatenate([[0], density.cumsum()])
    return rows * ROWS / rows[-1]


def _neighbours(place: Float, count: int) -> tuple[Any, Any, Float]:
    """Indices that places (...) lie between, of `count` around, and how far along."""
    place = place % count
    first = np.minimum(place.astype(np.int32), count - 1)
    return first, (first + 1) % count, place - first


def _between(values: Float, row: Float, column: Float) -> Float:
    """Values (...) at rows and columns (...), linear in both."""
    before, following, part = _neighbours(row, len(values))
    first = np.minimum(column.astype(np.int32), COLUMNS - 2)
    beside = column - first
    near, far = (
        (1 - part) * values[before, at] + part * values[following, at] for at in (first, first + 1)
    )
    return (1 - beside) * near + beside * far


def _mirrored(edge: Float, rows: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Rows that are to be made, and for each row which of those it equals.

    Ellipses and cylinders are mirrored in both axes, domes and pears in one.
    """
    row, count = np.arange(rows), len(edge)
    same = row
    for half_turns in (0, 1):  # ν → −ν, and ν → π − ν
        flipped = edge[(half_turns * count // 2 - np.arange(count)) % count]
        if np.allclose(flipped, edge, rtol=1e-5):
            same = np.minimum(same, same[(half_turns * rows // 2 - row) % rows])
    kept, index = np.unique(same, return_inverse=True)
    return kept, index


def _blurred(fine: Float) -> Float:
    """(rows, COLUMNS) means over tents of one column each side, which keep the integral.

    Without the core the veil of a point jumps at θ_min; its table must not lose or gain light.
    """
    weights = 1 - np.abs(np.arange(-FINE + 1, FINE)) / FINE
    padded = np.pad(fine, ((0, 0), (FINE - 1, FINE - 1)), mode="edge")
    tents = np.lib.stride_tricks.sliding_window_view(padded, 2 * FINE - 1, axis=1)
    return tents[:, ::FINE] @ (weights / weights.sum())
