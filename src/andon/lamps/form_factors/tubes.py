"""The capsule, horizon included.

Seen from the receiver P, a capsule's outline is two arcs of the contact circles of the tangent
cones to its end balls, and two straight lines in the planes through P that touch both balls. In
right-handed (d, g, m): d along the axis, g from P to the axis line at distance ρ, m = d × g; ends
at α d + ρ g. The planes' outward normals are q± = −(r/ρ) g ± √(1 − r²/ρ²) m, and they touch the
ball around A in A + r q±: the same points close arcs and lines, so nothing small is a difference
of directions. On a contact circle |x|² = |A|² − r² is constant.

                   q₊
           ____________________
        ⟋  T₊                  ⟍          where ρ ≤ r, P looks along the axis and sees the nearer
       (   A · · · · · · · · B   )         ball alone: the half-widths of the arcs become π and 0,
        ⟍ _T₋__________________⟋          and q± one vector, by themselves
                   q₋
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from andon.lamps.form_factors.vectors import Float, dot, frame, quotient

__all__ = ["tube_factor"]

Flags = NDArray[np.bool_]
Triple = tuple[Float, Float, Float]


class _Piece(NamedTuple):
    """½ ∫ along a piece of the outline above the horizon, and the closure that it asks for.

    `turn` is complex: its argument is the azimuth from where the piece leaves the horizon to
    where it enters it; what only leaves or only enters counts from the frame's first axis.
    """

    value: Float
    turn: NDArray[np.complex128]


class _Seen(NamedTuple):
    """The receiver's normal and its horizon's frame along d, g, m; (...) each."""

    n: Triple
    first: Triple
    second: Triple

    def height(self, x: Triple) -> Float:
        """n·x."""
        return _product(self.n, x)

    def azimuth(self, x: Triple, there: Flags) -> NDArray[np.complex128]:
        """x on the horizon as a complex number, and 1 where it is not `there`."""
        return np.where(there, _product(self.first, x) + 1j * _product(self.second, x), 1.0)


def _product(a: Triple, b: Triple) -> Float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _components(vector: Float, axes: Triple) -> Triple:
    return dot(vector, axes[0]), dot(vector, axes[1]), dot(vector, axes[2])


def tube_factor(position: ArrayLike, normal: ArrayLike, ends: ArrayLike, radius: float, /) -> Float:
    """Projected solid angle (...) in sr of the capsule of all points within `radius` of a line.

    `ends` (2, 3) of the line, metres; they may coincide: a sphere. Source: the module's docstring.
    """
    line = np.asarray(ends, np.float64)
    length = float(np.linalg.norm(line[1] - line[0]))
    d = (line[1] - line[0]) / length if length else np.array([1.0, 0.0, 0.0])
    start, up = np.broadcast_arrays(
        line[0] - np.asarray(position, np.float64), np.asarray(normal, np.float64)
    )
    along = start @ d
    across = start - along[..., None] * d
    rho = np.sqrt(dot(across, across))
    g = np.where((rho > 0)[..., None], quotient(across, rho[..., None]), frame(d)[0])
    axes = (np.broadcast_to(d, g.shape), g, np.cross(d, g))
    seen = _Seen(*(_components(vector, axes) for vector in (up, *frame(up))))
    nearest = np.clip(0.0, along, along + length)
    square = nearest**2 + rho**2
    touch = 0.5 * np.pi * (1 + quotient(seen.height((nearest, rho, 0 * rho)), np.sqrt(square)))
    outside = square > radius**2
    safe = np.where(outside, rho, 2 * radius)
    factor = _outside(along, length, safe, seen, radius)
    return np.where(outside, np.clip(factor, 0, np.pi), touch)


def _outside(along: Float, length: float, rho: Float, seen: _Seen, r: float) -> Float:
    lean = r / np.maximum(rho, r)
    spread = np.sqrt((1 - lean) * (1 + lean))
    pieces = [
        piece
        for side in (1.0, -1.0)
        for piece in (
            _line(along, length, rho, (lean, side * spread), seen, r, side),
            _arc(along + length * (side > 0), rho, (lean, spread), seen, r, side),
        )
    ]
    turn = np.prod([piece.turn for piece in pieces], axis=0)
    return np.sum([piece.value for piece in pieces], axis=0) + 0.5 * np.angle(turn)


def _line(
    along: Float,
    length: float,
    rho: Float,
    q: tuple[Float, Float],
    seen: _Seen,
    r: float,
    side: float,
) -> _Piece:
    """The straight line in the tangent plane with normal −q₀ g + q₁ m."""
    low, aside = rho - r * q[0], r * q[1]
    height = seen.height((along, low, aside)), seen.height((along + length, low, aside))
    above = height[0] > 0, height[1] > 0
    at = np.clip(quotient(height[0], height[0] - height[1]), 0, 1)
    ends = [
        along + length * np.where(above[0], 0.0, at),
        along + length * np.where(above[1], 1.0, at),
    ]
    square = np.maximum(rho**2 - r**2, 0)
    reach = np.where(above[0] | above[1], ends[1] - ends[0], 0)
    angle = np.arctan2(np.sqrt(square) * reach, square + ends[0] * ends[1])
    value = -0.5 * angle * (q[1] * seen.n[2] - q[0] * seen.n[1])
    crossing = seen.azimuth((along + length * at, low, aside), above[0] != above[1])
    enters = above[1] if side > 0 else above[0]
    return _Piece(value, np.where(enters, crossing, crossing.conj()))


def _arc(
    along: Float, rho: Float, q: tuple[Float, Float], seen: _Seen, r: float, side: float
) -> _Piece:
    """The arc of the contact circle around the end at `along`; `side` −1 at the first end.

    It runs from −w to w about o, the direction in the circle's plane away from the other end;
    the circle's highest point is at `top`, and it is above the horizon within `rise` of it.
    """
    nd, ng, nm = seen.n
    square = along**2 + rho**2
    distance, beyond = np.sqrt(square), np.maximum(square - r**2, 0)
    root = np.sqrt(beyond)
    w = np.arctan2(distance * q[1], side * r * along / np.maximum(rho, r))
    n_o, n_m = side * (rho * nd - along * ng) / distance, -side * nm
    flat, centre = np.hypot(n_o, n_m), (along * nd + rho * ng) / distance
    level = centre * root
    crossed = np.abs(level) < r * flat
    cut = np.where(crossed, -quotient(level, r * flat), np.where(level > 0, -1.0, 1.0))
    rise, top = np.arccos(cut), np.arctan2(n_m, n_o)
    t1, t2 = np.abs(top) - w, np.abs(top) + w
    low, high = np.maximum(t1, -rise), np.maximum(np.minimum(t2, rise), np.maximum(t1, -rise))
    again = np.maximum(t2 - (2 * np.pi - rise), 0)
    sines = np.sin(high) - np.sin(low) + np.sin(again - rise) + np.sin(rise)
    value = 0.5 * (r**2 * centre * (high - low + again) - r * root * flat * sines) / square
    # Who crosses is decided by the heights that the lines see, so that nobody leaves twice.
    ends = [seen.height((along, rho - r * q[0], -side * s * r * q[1])) > 0 for s in (-1, 1)]
    towards = np.where(ends[0], -n_o, n_o) > np.cos(w) * flat
    twice = (ends[0] == ends[1]) & towards & crossed
    turn = np.ones_like(value, np.complex128)
    for sign, there in ((1, ends[0] & ~ends[1]), (-1, ends[1] & ~ends[0])):
        angle = top + sign * rise
        out, aside = side * r * np.cos(angle) / distance, -side * r * np.sin(angle)
        # over root/distance: a direction is enough
        point = (root * along / distance + out * rho, root * rho / distance - out * along, aside)
        crossing = seen.azimuth(point, there | twice)
        turn = turn * (crossing.conj() if sign > 0 else crossing)
    return _Piece(value, turn)
