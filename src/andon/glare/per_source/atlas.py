"""Tables of many sources in one texture.

::

      row 0 … CIRCLES − 1      circles, sixteen radii per octave: a moving lamp finds its rows made
      then ROWS each           other outlines, kept until others need the room

A texel holds the four corners of a cell, so that one read is a bilinear one. Between two radii a
circle's veil, at the same column, is linear in log R: errors are below 0.1 % up to 100° away, where
the field of view ends.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.glare.kernel import Kernel
from andon.glare.model import Outline
from andon.glare.per_source.model import Bloom
from andon.glare.per_source.tables import COLUMNS, EDGES, ROWS, VeilTable, table_of
from andon.gpu.device import Gpu
from andon.gpu.textures import make_texture

__all__ = ["Atlas"]

Float = NDArray[np.float64]

# Radii of circles: from this, below which a source is a point, sixteen per octave to 85°.
LEAST_DEGREES, PER_OCTAVE, CIRCLES = 0.001, 16, 264


class Atlas:
    """The tables on the GPU.

    Attributes
    ----------
    tables : rgba32float, two layers: V·q², and radians from the outline.
    edges : rgba32float: edge at a step around and the next, rows at both.
    """

    def __init__(self, gpu: Gpu, outlines: int) -> None:
        rows = CIRCLES + outlines * ROWS
        self.capacity = outlines
        self.tables = make_texture(gpu, "rgba32float", COLUMNS, rows, layers=2, label="veil tables")
        self.edges = make_texture(gpu, "rgba32float", EDGES, max(1, outlines), label="edges")
        self._kind: tuple[Any, ...] = ()
        self._slots: dict[bytes, int] = {}
        self._circles: set[int] = set()

    def begin(self, kernel: Kernel, core: bool, bloom: Bloom | None) -> None:
        """What is asked for from now on is of this kernel; rows of another are forgotten."""
        if self._kind != (kernel, core, bloom):
            self._kind = (kernel, core, bloom)
            self._slots.clear()
            self._circles.clear()

    def rows_of(self, outlines: list[Outline]) -> list[tuple[float, float]]:
        """Rows of tables and edges for each outline; makes and writes what is missing.

        Raises `InputError` for more different outlines, circles apart, than there is room for.
        """
        keys = {o.radii_radians.tobytes(): o for o in outlines if len(o.radii_radians) > 1}
        if len(keys) > self.capacity:
            raise InputError(
                f"at most {self.capacity} outlines that are no circles, got {len(keys)}",
                field="glare.sources",
            )
        for key in [key for key in self._slots if key not in keys][: len(keys)]:
            if len(keys.keys() | self._slots.keys()) > self.capacity:
                del self._slots[key]
        free = [i for i in range(self.capacity) if i not in self._slots.values()]
        for key, outline in keys.items():
            if key not in self._slots:
                self._slots[key] = free.pop()
                self._write_outline(self._slots[key], self._table(outline))
        return [self._row(outline) for outline in outlines]

    def _row(self, outline: Outline) -> tuple[float, float]:
        if len(outline.radii_radians) > 1:
            slot = self._slots[outline.radii_radians.tobytes()]
            return float(CIRCLES + slot * ROWS), float(slot)
        octaves = np.log2(np.degrees(outline.radii_radians[0]) / LEAST_DEGREES)
        row = float(np.clip(octaves * PER_OCTAVE, 0, CIRCLES - 1.001))
        self._write_circle(int(row))
        return row, 0.0

    def _table(self, outline: Outline) -> VeilTable:
        kernel, core, bloom = self._kind
        return table_of(kernel, outline, core=core, bloom=bloom)

    def _circle(self, row: int) -> VeilTable:
        return self._table(Outline(np.radians([LEAST_DEGREES * 2 ** (row / PER_OCTAVE)])))

    def _write_circle(self, row: int) -> None:
        if row in self._circles:
            return
        self._circles.add(row)
        first, second = self._circle(row), self._circle(row + 1)
        for layer, name in enumerate(("values", "beyond")):
            pair = np.concatenate([getattr(first, name), getattr(second, name)])
            self._write(layer, row, _cells(pair)[:1])

    def _write_outline(self, slot: int, table: VeilTable) -> None:
        for layer, values in enumerate((table.values, table.beyond)):
            around = np.concatenate([values, values[:1]])
            self._write(layer, CIRCLES + slot * ROWS, _cells(around))
        edge, following = table.edge, np.roll(table.edge, -1)
        steps = np.stack([edge, following, table.rows_at[:-1], table.rows_at[1:]], axis=-1)
        self.edges.write_rows(steps[None], slot)

    def _write(self, layer: int, row: int, cells: Float) -> None:
        self.tables.write_rows(cells, row, layer)


def _cells(values: Float) -> Float:
    """(rows − 1, COLUMNS, 4) corners of the cells of values (rows, COLUMNS)."""
    beside = np.concatenate([values[:, 1:], values[:, -1:]], axis=1)
    return np.stack([values[:-1], beside[:-1], values[1:], beside[1:]], axis=-1)
