"""Form factors between triangles: how the light inside a shell goes round."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.lamps.solids import quarters
from andon.lamps.triangles import triangle_areas, unit_normals

__all__ = ["enclosure_factors", "point_factors"]

Float = NDArray[np.float64]

# Each facet is asked at the middles of 4² pieces: neighbours along an edge see each other most
# unevenly there, and reciprocity (both ways are averaged) halves what is left.
CUTS = 2
BALANCING_STEPS = 60


def point_factors(points: Float, normals: Float, corners: Float, /) -> Float:
    """Share (p, t) of what reaches `points` (p, 3) if only triangles (t, 3, 3) shine.

    E = π·L·share for a triangle of luminance L that hides nothing. Negative where the triangle's
    back is seen: it emits to the side on which it runs counter-clockwise. The boundary integral of
    Lambert (1760), over what stands above the horizon of `normals` (p, 3).
    """
    total = np.zeros((len(points), len(corners)))
    relative = corners[None] - points[:, None, None]
    height = (relative * normals[:, None, None]).sum(axis=-1)
    falls = np.zeros((*total.shape, 3))
    rises = np.zeros((*total.shape, 3))
    for k in range(3):
        a, b = relative[:, :, k], relative[:, :, (k + 1) % 3]
        ha, hb = height[:, :, k], height[:, :, (k + 1) % 3]
        above_a, above_b = ha > 0, hb > 0
        crosses = above_a != above_b
        share = np.divide(ha, ha - hb, out=np.zeros_like(ha), where=crosses)
        crossing = a + share[..., None] * (b - a)
        begin = np.where(above_a[..., None], a, crossing)
        end = np.where(above_b[..., None], b, crossing)
        total += np.where(above_a | above_b, _edge(begin, end, normals), 0)
        falls = np.where((crosses & above_a)[..., None], crossing, falls)
        rises = np.where((crosses & above_b)[..., None], crossing, rises)
    return -(total + _edge(falls, rises, normals)) / (2 * np.pi)


def _edge(a: Float, b: Float, normals: Float) -> Float:
    """Angle of an edge seen from the origin, times n · its plane's normal; 0 if seen end on."""
    ax, ay, az = a[..., 0], a[..., 1], a[..., 2]
    bx, by, bz = b[..., 0], b[..., 1], b[..., 2]
    x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
    length = np.sqrt(x * x + y * y + z * z)
    angle = np.arctan2(length, ax * bx + ay * by + az * bz)
    n = normals[:, None]
    facing = x * n[..., 0] + y * n[..., 1] + z * n[..., 2]
    return np.divide(angle * facing, length, out=np.zeros_like(angle), where=length > 0)


def enclosure_factors(inside: Float, /, *, closed: bool) -> Float:
    """Shares F (n, n): of what leaves triangle i diffusely, F[i, j] goes to triangle j.

    Triangles (n, 3, 3) that run counter-clockwise as seen from inside. Nothing hides anything:
    exact for convex enclosures; of others, backs take nothing and what is counted twice is scaled
    away.

    Parameters
    ----------
    closed : the triangles leave no gap: rows sum to 1. Otherwise to at most 1, and what is
        missing leaves through the gaps.
    """
    area, normal = triangle_areas(inside), unit_normals(inside)
    pieces = inside
    for _ in range(CUTS):
        pieces = quarters(pieces)
    each = 4**CUTS
    shares = np.empty((len(inside), len(inside)))
    for i in range(len(inside)):
        middles = pieces[i * each : (i + 1) * each].mean(axis=1)
        seen = point_factors(middles, np.broadcast_to(normal[i], middles.shape), inside)
        shares[i] = np.maximum(seen, 0).mean(axis=0)
    np.fill_diagonal(shares, 0)
    exchange = area[:, None] * shares
    exchange = (exchange + exchange.T) / 2
    return _balanced(exchange, area, closed)


def _balanced(exchange: Float, area: Float, closed: bool) -> Float:
    """Rows of `exchange` (symmetric) scaled to `area`, keeping symmetry as far as possible.

    The last step makes the rows exact: energy before reciprocity.
    """
    for _ in range(BALANCING_STEPS):
        factor = _row_factors(exchange, area, closed)
        exchange = exchange * np.sqrt(factor[:, None] * factor[None, :])
    exchange = exchange * _row_factors(exchange, area, closed)[:, None]
    return exchange / area[:, None]


def _row_factors(exchange: Float, area: Float, closed: bool) -> Float:
    rows = exchange.sum(axis=1)
    factor = np.divide(area, rows, out=np.ones_like(area), where=rows > 0)
    return factor if closed else np.minimum(factor, 1)
