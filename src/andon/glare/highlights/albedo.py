"""How much of even light from all sides GGX sends to the eye, tabulated once.

Fits such as Lazarov's are made for dielectrics; for metals theirs is 20 % too dark (0.75 for 0.95
at α = 0.2). The table is the integral itself: half vectors are drawn from GGX's slopes by their
cumulative, so that the integrand is F·G₂·(v·h)/((n·v)(n·h)) alone.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from andon.glare.highlights.model import LEAST_ALPHA

__all__ = ["TABLE_SIDE", "albedo", "albedo_table"]

Float = NDArray[np.float64]

# Rows over √cos θ, columns over √α: both ends need the finer steps.
TABLE_SIDE = 24
RADII, TURNS = 128, 48


@cache
def albedo_table() -> Float:
    """(24, 24, 2): scale and offset, so that albedo = scale·F(0) + offset.

    Row i is cos θ = (i/23)², column j α = (j/23)².
    """
    steps = np.linspace(0, 1, TABLE_SIDE) ** 2
    table = np.zeros((TABLE_SIDE, TABLE_SIDE, 2))
    for row, cosine in enumerate(np.maximum(steps, 1e-3).tolist()):
        for column, alpha in enumerate(np.maximum(steps, LEAST_ALPHA).tolist()):
            whole, grazing = _integrals(cosine, alpha)
            table[row, column] = whole - grazing, grazing
    table.flags.writeable = False
    return table


def _integrals(cosine: float, alpha: float) -> tuple[float, float]:
    """Albedo of a perfect mirror's facets, and the same weighted by Schlick's (1 − v·h)⁵."""
    share = (np.arange(RADII)[:, None] + 0.5) / RADII
    turn = (np.arange(TURNS) + 0.5) / TURNS * np.pi
    # Within r lies r²/(1 + r²) of the lobe.
    slope = alpha * np.sqrt(share / (1 - share))
    upright = 1 / np.sqrt(1 + slope**2)
    sine = np.sqrt(1 - cosine**2)
    along = upright * (cosine + slope * np.cos(turn) * sine)
    out = 2 * along * upright - cosine
    lit = (along > 0) & (out > 0)
    out = np.maximum(out, 1e-6)
    spread = alpha**2 * (1 / cosine**2 - 1), alpha**2 * (1 / out**2 - 1)
    shown = 2 / (np.sqrt(1 + spread[0]) + np.sqrt(1 + np.maximum(spread[1], 0)))
    each = np.where(lit, shown * along / (cosine * upright), 0.0)
    return float(each.mean()), float((each * (1 - np.clip(along, 0, 1)) ** 5).mean())


def albedo(cosine: Float, alpha: Float, straight: Float, /) -> Float:
    """(n, 3) of `straight` (n, 3) reflectance straight ahead, at n·v and α (n,); bilinear."""
    last = TABLE_SIDE - 1
    row, column = (np.sqrt(np.clip(x, 0, 1)) * last for x in (cosine, alpha))
    i, j = (np.minimum(x.astype(int), last - 1) for x in (row, column))
    u, v = (row - i)[:, None], (column - j)[:, None]
    table = albedo_table()
    upper = table[i, j] * (1 - v) + table[i, j + 1] * v
    lower = table[i + 1, j] * (1 - v) + table[i + 1, j + 1] * v
    value = upper * (1 - u) + lower * u
    return straight * value[:, :1] + value[:, 1:]
