"""The kernel convolved with a source's shape, on the sphere: the veil of 1 lx.

A uniform source of E lx has the luminance E/ω on its solid angle ω, so its veil at a point P is
E/ω times ∫ K over the shape. Two closed forms, by whichever the integral has one dimension:

::

      circle: rings about P                     any outline: along its edge about P
          ψ ─▶ ╱‾‾╲                                    ╱‾‾╲_
      P ──────(─ ● ─)    K·2α(ψ)·sin ψ dψ       P ────(     )   F(ψ) dβ,  F = ∫₀^ψ K·sin
               ╲__╱                                dβ  ╲__‾‾

α is half of the ring's arc that lies inside the circle; dβ the angle at P of a piece of the edge
(Green's theorem in polar coordinates about P). Far from a small shape the second is the small
difference of large numbers, so there the shape is summed over its area.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.glare.kernel import FADE_DEGREES, Kernel
from andon.glare.model import Outline

__all__ = ["disc_veil", "edge_points", "outline_veil", "ring_integral"]

Float = NDArray[np.float64]

# Nodes of Gauss–Legendre along a circle's rings: errors are below 1e-5 with these.
CORE_NODES, RING_NODES = 16, 48
# F is tabulated at steps of log ψ, from θ_min/160,000 on: errors of its slope are below 0.1 %.
STEP, CORE_STEPS = 0.002, 6000
# Great circles that stand for an edge, integrated by Simpson's rule in β: so many for points near
# the edge (of the largest radius), and for others. Those that span a wide β are cut.
EDGE_PIECES, COARSE_PIECES, NEAR_EDGE = 192, 64, 0.25
WIDE_TURN, CUTS = 0.4, 16
# Where shapes are summed by their area, in units of their largest radius, and nodes of that sum
# (along the radius, around): the nearest distance to a node is then 2 radii, 11 radii.
NEAR_RADII, FAR_RADII = 3.0, 12.0
NEAR_NODES, FAR_NODES = (5, 48), (2, 16)

# tan(ψ/2) at the antipode.
FAR = np.array([1e300])


@lru_cache(maxsize=16)
def _rings(kernel: Kernel, core: bool) -> tuple[float, Float]:
    """F = ∫₀^ψ K·sin at equal steps of log tan(ψ/2): the first of those, and values."""
    least = np.log(np.tan(np.radians(kernel.minimum_degrees) / 2))
    steps = int((np.log(np.tan(np.radians(FADE_DEGREES[1]) / 2)) - least) / STEP) + 1
    # ψ by log tan(ψ/2) has the slope sin ψ.
    psi = 2 * np.arctan(np.exp(least + STEP * np.arange(steps + 1)))
    slope = kernel.per_sr(psi, core=True) * np.sin(psi) ** 2
    within = kernel.core_share / (2 * np.pi) if core else 0.0
    beyond = within + STEP * np.concatenate([[0], ((slope[1:] + slope[:-1]) / 2).cumsum()])
    below = np.arange(-CORE_STEPS, 0)
    inside = within * np.where(below == -CORE_STEPS, 0, np.exp(2 * STEP * below))
    return float(least + STEP * below[0]), np.concatenate([inside, beyond])


def ring_integral(kernel: Kernel, half_tangent: Float, /, *, core: bool) -> Float:
    """(...) ∫₀^ψ K(t)·sin t dt, by tan(ψ/2) (...)."""
    first, values = _rings(kernel, core)
    place = np.log(np.maximum(half_tangent, np.finfo(float).tiny))
    place -= first
    place /= STEP
    np.clip(place, 0, len(values) - 1.001, out=place)
    below = place.astype(np.int32)
    place -= below
    return values[below] + place * (values[1:] - values[:-1])[below]


def disc_veil(kernel: Kernel, radius: float, theta: Float, /, *, core: bool) -> Float:
    """(n,) veil in cd/m² of a disc of 1 lx, `theta` (n,) from its centre; radians."""
    least, most = np.abs(theta - radius), np.minimum(theta + radius, 2 * np.pi - theta - radius)
    # Rings that lie inside the disc as a whole: around P, and where P's antipode is inside.
    total = ring_integral(kernel, np.tan(np.maximum(radius - theta, 0) / 2), core=core)
    behind = ring_integral(kernel, FAR, core=core) - ring_integral(
        kernel, np.tan(most / 2), core=core
    )
    total += np.where(theta + radius > np.pi, behind, 0)
    total *= 2 * np.pi
    edge = np.clip(np.radians(kernel.minimum_degrees), least, most)
    if core:
        x, dx = _dense_at_both_ends(CORE_NODES)
        psi = least[:, None] + x * (edge - least)[:, None]
        arcs = 2 * _half_arc(psi, theta[:, None], radius) * np.sin(psi)
        total += kernel.per_sr(0.0, core=True) * (arcs @ dx) * (edge - least)
    x, dx = _dense_at_both_ends(RING_NODES)
    lower = np.maximum(edge, np.finfo(float).tiny)
    span = np.log(np.maximum(most, lower) / lower)
    psi = lower[:, None] * np.exp(x * span[:, None])
    arcs = 2 * _half_arc(psi, theta[:, None], radius) * np.sin(psi) * psi
    total += ((kernel.per_sr(psi, core=True) * arcs) @ dx) * span
    return total / (4 * np.pi * np.sin(radius / 2) ** 2)


@lru_cache(maxsize=8)
def _dense_at_both_ends(count: int) -> tuple[Any, Any]:
    """Nodes in (0, 1) and their weights, for functions with a square root at both ends."""
    u, weight = np.polynomial.legendre.leggauss(count)
    nodes: Any = 0.5 * (1 + np.sin(np.pi / 2 * u))
    return nodes, np.pi / 4 * np.cos(np.pi / 2 * u) * weight


def _half_arc(psi: Float, theta: Float, radius: float) -> Float:
    """Half of the ring's arc inside the circle: the angle opposite `radius` in a triangle.

    By its half angle, which keeps its precision where the triangle is small or flat.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        square = (
            np.sin((psi + radius - theta) / 2)
            * np.sin((theta + radius - psi) / 2)
            / (np.sin(theta) * np.sin(psi))
        )
    return 2 * np.arcsin(np.sqrt(np.clip(np.nan_to_num(square), 0, 1)))


def outline_veil(kernel: Kernel, outline: Outline, points: Float, /, *, core: bool) -> Float:
    """(n,) veil in cd/m² of a source of 1 lx with `outline`, seen from `points` (n, 3).

    Unit vectors in the source's frame: (right, down, direction).
    """
    largest = float(outline.radii_radians.max())
    away = 2 * np.arcsin(np.clip(np.linalg.norm(points - [0, 0, 1.0], axis=-1) / 2, 0, 1))
    veil = np.empty(len(points))
    # Where K jumps within the shape, too, few nodes are not enough.
    jump = not core and np.abs(away - np.radians(kernel.minimum_degrees)) < 2 * largest
    near = (away <= NEAR_RADII * largest) | jump
    far = ~near & (away > FAR_RADII * largest)
    radius = outline.radius(np.arctan2(points[:, 1], points[:, 0]))
    at_edge = np.abs(away - radius) < NEAR_EDGE * largest
    for which, pieces in ((near & at_edge, EDGE_PIECES), (near & ~at_edge, COARSE_PIECES)):
        veil[which] = _along_edge(kernel, edge_points(outline, pieces), points[which], core=core)
    for which, nodes in ((~near & ~far, NEAR_NODES), (far, FAR_NODES)):
        places, weights = _area_nodes(outline, *nodes)
        psi = np.arccos(np.clip(points[which] @ places.T, -1, 1))
        veil[which] = kernel.per_sr(psi, core=core) @ weights
    return veil


def _directions(theta: Float, phi: Float) -> Float:
    return np.stack(
        [np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1
    )


def edge_points(outline: Outline, pieces: int = EDGE_PIECES, /) -> Float:
    """(pieces, 3) points of the edge in the source's frame: dense where it is long, or bends."""
    phi = np.linspace(0, 2 * np.pi, 16 * pieces + 1)
    sides = np.diff(_directions(outline.radius(phi), phi), axis=0)
    heading = np.unwrap(np.arctan2(sides[:, 1], sides[:, 0]))
    bend = np.abs(np.diff(heading, prepend=heading[-1] - 2 * np.pi))
    length = np.linalg.norm(sides, axis=1)
    walked = (length / length.sum() + bend / bend.sum()).cumsum()
    wanted = walked[-1] * np.arange(pieces) / pieces
    found = np.asarray(np.interp(wanted, np.concatenate([[0], walked]), phi), np.float64)
    return _directions(outline.radius(found), found)


def _along_edge(kernel: Kernel, edge: Float, points: Float, *, core: bool) -> Float:
    """(n,) mean of K over what `edge` encloses, about `points` (n, 3)."""
    right, down = _frames(points)
    first = edge @ right.T + 1j * (edge @ down.T), edge @ points.T  # sin ψ·exp(iβ), cos ψ
    second = np.roll(first[0], -1, axis=0), np.roll(first[1], -1, axis=0)
    whole, turn = _piece(kernel, first, second, core=core)
    # Near P a piece spans angles at which F is anything: those few are cut.
    piece, point = np.nonzero(np.abs(turn) > WIDE_TURN)
    ends = [part[piece, point] for part in (*first, *second)]
    cuts = np.linspace(0, 1, CUTS + 1)[:, None]
    along = [a * (1 - cuts) + b * cuts for a, b in zip(ends[:2], ends[2:], strict=True)]
    cut, _ = _piece(kernel, [a[:-1] for a in along], [a[1:] for a in along], core=core)
    whole[piece, point] = cut.sum(axis=0)
    # Where P's antipode is inside, the edge runs round P the other way.
    behind = np.maximum(-np.sum(turn, axis=0), 0)
    total = whole.sum(axis=0) + behind * ring_integral(kernel, FAR, core=core)
    return total / _solid_angle(edge)


def _piece(kernel: Kernel, a: Sequence[Any], b: Sequence[Any], *, core: bool) -> tuple[Any, Any]:
    """∫ F dβ over pieces from `a` to `b`, each (sin ψ·exp(iβ), cos ψ), and their turns in β.

    On a great circle cot ψ is a combination of sin β and cos β.
    """
    turn: Float = np.angle(np.conj(a[0]) * b[0])
    total: Any = 0
    cot: Any = 0
    for seen, cosine in (a, b):
        sine = np.maximum(np.abs(seen), 1e-30)
        cot = cot + cosine / sine
        total = total + ring_integral(kernel, sine / np.maximum(1 + cosine, 1e-12), core=core)
    cot /= np.maximum(2 * np.cos(turn / 2), 1e-12)
    steep: Float = np.sqrt(1 + cot * cot) + np.abs(cot)
    middle: Float = np.where(cot > 0, 1 / steep, steep)
    return (total + 4 * ring_integral(kernel, middle, core=core)) / 6 * turn, turn


def _solid_angle(edge: Float) -> float:
    """Of a spherical polygon (k, 3) around +z: triangles with it. Source: van Oosterom 1983."""
    following = np.roll(edge, -1, axis=0)
    volume = edge[:, 0] * following[:, 1] - edge[:, 1] * following[:, 0]
    flat = 1 + edge[:, 2] + following[:, 2] + np.sum(edge * following, axis=1)
    return float(np.sum(2 * np.arctan2(volume, flat)))


def _frames(points: Float) -> tuple[Float, Float]:
    """Unit vectors (n, 3) perpendicular to `points` and to each other."""
    helper = np.where(np.abs(points[:, :1]) < 0.9, [1.0, 0, 0], [0, 1.0, 0])
    right = np.asarray(np.cross(helper, points), np.float64)
    right /= np.linalg.norm(right, axis=-1, keepdims=True)
    return right, np.asarray(np.cross(points, right), np.float64)


def _area_nodes(outline: Outline, along: int, around: int) -> tuple[Float, Float]:
    """Points (k, 3) inside and their shares (k,) of the solid angle."""
    u, weight = np.polynomial.legendre.leggauss(along)
    phi = np.asarray(np.arange(around) * (2 * np.pi / around), np.float64)
    edge = outline.radius(phi)
    theta = 0.5 * (1 + u)[:, None] * edge
    share = weight[:, None] * edge * np.sin(theta)
    nodes = _directions(theta, np.broadcast_to(phi, theta.shape)).reshape(-1, 3)
    return nodes, np.asarray(share / share.sum(), np.float64).ravel()
