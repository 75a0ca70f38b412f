"""Curves of surfaces as a shader reads them: exactly, by one look at a table.

A curve is linear between its knots. Light falls into cells of equal *ratio*, the upper bits of its
float (sign, exponent, the first `MANTISSA_BITS` of the mantissa), so that darks are told as finely
as brights; each cell holds the one knot that may lie in it and the slopes on both sides of it::

    cell = bits(light) >> CELL_SHIFT         texel = (knot, f(knot), slope below, slope above)

A curve with more knots in a cell keeps the first of them. For smooth curves that errs by at most
p·|p − 1|/8·2⁻¹⁰ of the value (f ~ Eᵖ; 2·10⁻⁴ for p = ½ … 2), and f⁻¹ is taken of the same curve,
so what is not lit anew stays as it is.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from andon.responses import SurfaceCurve

__all__ = ["CELL_SHIFT", "curve_table", "thinned"]

Float = NDArray[np.float64]

# 64 cells to an octave: all 127 octaves of floats above 2⁻⁶³ fit a row of the smallest texture that
# every adapter has, 8192 texels (WebGPU, table of limits).
MANTISSA_BITS = 6
CELL_SHIFT = 23 - MANTISSA_BITS
# Least knot inside a curve, in lux.
LEAST_LUX = 2.0**-63


def thinned(curve: SurfaceCurve, /) -> SurfaceCurve:
    """The curve with float32 knots of which at most one, not counting both ends, is in a cell."""
    lux = curve.illuminance_lux.astype(np.float32)
    inside = np.flatnonzero((lux[1:-1] >= LEAST_LUX) & (lux[1:-1] > lux[0])) + 1
    inside = inside[lux[inside] < lux[-1]]
    _, first = np.unique(_cells(lux[inside]), return_index=True)
    kept = np.concatenate([[0], inside[first], [len(lux) - 1]])
    return SurfaceCurve(lux[kept].astype(np.float64), curve.linear[kept])


def curve_table(curves: Sequence[SurfaceCurve], /) -> tuple[NDArray[np.float32], int]:
    """(3·curves, cells, 4) texels of `thinned` curves, row 3·curve + channel; and the first cell.

    Light below the first cell or above the last one is looked up in these.
    """
    knots = np.concatenate([curve.illuminance_lux[1:-1] for curve in curves])
    if not len(knots):  # straight lines
        knots = np.ones(1)
    cells = _cells(knots.astype(np.float32))
    first = int(cells.min())
    edges = np.arange(first, int(cells.max()) + 1, dtype=np.uint32) << CELL_SHIFT
    rows = [
        _row(curve, channel, edges.view(np.float32).astype(np.float64), first)
        for curve in curves
        for channel in range(3)
    ]
    return np.stack(rows).astype(np.float32), first


def _row(curve: SurfaceCurve, channel: int, edges: Float, first: int) -> Float:
    """(cells, 4) of one channel; `edges` (cells,) are the lower ends of the cells."""
    lux, linear = curve.illuminance_lux, curve.linear[:, channel]
    slopes = np.diff(linear) / np.diff(lux)
    part = np.clip(np.searchsorted(lux, edges, side="right") - 1, 0, len(slopes) - 1)
    # Told from the knot below, so that float32 loses no digits in a difference.
    row = np.stack([lux[part], linear[part], slopes[part], slopes[part]], axis=-1)
    knots = np.arange(1, len(lux) - 1)
    row[_cells(lux[knots].astype(np.float32)) - first] = np.stack(
        [lux[knots], linear[knots], slopes[knots - 1], slopes[knots]], axis=-1
    )
    return row


def _cells(lux: NDArray[np.float32]) -> NDArray[np.int64]:
    return (lux.view(np.uint32) >> CELL_SHIFT).astype(np.int64)
