"""Lobes of reflection, and how much of them an outline holds (float64).

GGX is a distribution of *slopes*: x, y = tan of the facet's tilt along the tangents, over α. In
these units it is ``1/(π(1 + r²)²)`` whatever the two α are. The half vectors of all directions
towards a lamp fill an area of the plane of slopes; what the lobe gives is the integral over it,
times F·G₂·(v·h)/((n·v)(n·h)), which varies slowly and is taken at one direction. By Green's theorem
the integral is a sum over the outline's edges,

    ∮ (x dy − y dx) / (2π(1 + r²)),

and along a straight edge from p to q that is ``c/(2πΔ)·atan2(Δ, 1 + p·q)`` with c = p × q and
Δ² = |q − p|² + c². (The plane is the stereographic picture of a sphere on which the lobe is even.)

Far from the lobe's middle the sum of the edges is a small difference of large angles; there each
edge gives the lobe at three points of the triangle that it spans with the outline's middle.

Phong's lobe is round about the mirrored direction; with W(α) = 1 − cosⁿ⁺¹α, its share within α, an
outline holds ∮ W dφ/2π, by Gauss's rule on each edge.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "edge_share",
    "fan_share",
    "ggx_slopes",
    "masking",
    "phong_edge_share",
    "phong_lobe",
]

Float = NDArray[np.float64]

# Gauss and Legendre's rule of four points.
NODES = (-0.8611363115940526, -0.3399810435848563, 0.3399810435848563, 0.8611363115940526)
GAUSS = (0.3478548451374538, 0.6521451548625461, 0.6521451548625461, 0.3478548451374538)
# Sine of the least height of a direction above the plane square to Phong's axis.
BEHIND = 0.05


def cross(p: Float, q: Float, /) -> Float:
    """(...) of plane vectors (..., 2)."""
    return p[..., 0] * q[..., 1] - p[..., 1] * q[..., 0]


def dot(p: Float, q: Float, /) -> Float:
    """(...) of vectors (..., k)."""
    return np.einsum("...i,...i->...", p, q)


def ggx_slopes(slopes: Float, /) -> Float:
    """(...) density of slopes (..., 2) in units of α; its integral over the plane is 1."""
    return 1 / (np.pi * (1 + dot(slopes, slopes)) ** 2)


def edge_share(p: Float, q: Float, /) -> Float:
    """(...) what the edge from p to q (..., 2) adds to the lobe's share of an outline.

    Outlines that run counter-clockwise have a positive sum.
    """
    c, way = cross(p, q), q - p
    delta = np.sqrt(np.maximum(dot(way, way) + c**2, 1e-60))
    return c / (2 * np.pi * delta) * np.arctan2(delta, 1 + dot(p, q))


def fan_share(p: Float, q: Float, middle: Float, /) -> Float:
    """(...) the lobe over the triangle p, q, middle: exact to the second degree."""
    area = 0.5 * cross(p - middle, q - middle)
    points = (p + q) / 2, (q + middle) / 2, (middle + p) / 2
    return area * sum(ggx_slopes(point) for point in points) / 3


def masking(squares_view: Float, squares_light: Float, /) -> Float:
    """(...) Smith's height-correlated G₂ of GGX.

    Each argument is (α_x²·d_x² + α_y²·d_y²)/d_z² of a direction d in the frame of the surface.
    Source: Heitz 2014, equations 86 and 99.
    """
    return 2 / (np.sqrt(1 + squares_view) + np.sqrt(1 + squares_light))


def phong_lobe(cosine: Float, exponent: float, /) -> Float:
    """(...) 1/sr: (n + 1)/2π·cosⁿα, 0 behind; its integral over directions is 1."""
    return (exponent + 1) / (2 * np.pi) * np.maximum(cosine, 0) ** exponent


def phong_edge_share(p: Float, q: Float, exponent: float, /) -> Float:
    """(...) what the edge from direction p to q adds to the share of Phong's lobe.

    `p`, `q` (..., 3) are of any length, in a frame whose third axis is the lobe's.
    """
    # On the plane at 1 of the axis; what is behind keeps its azimuth, and has no light.
    p, q = (_on_plane(d) for d in (p, q))
    length = np.maximum(np.linalg.norm(q - p, axis=-1), 1e-12)
    way = (q - p) / length[..., None]
    beside, start = cross(p, way), dot(p, way)
    # t = σ·tan u is even both for a lobe that is narrower than the edge is far, and for a wider.
    width = np.sqrt(beside**2 + 2 / (exponent + 1))
    first, last = np.arctan(start / width), np.arctan((start + length) / width)
    total = np.zeros_like(length)
    for node, gauss in zip(NODES, GAUSS, strict=True):
        along = width * np.tan((first + last) / 2 + node * (last - first) / 2)
        square = np.maximum(beside**2 + along**2, 1e-12)
        within = 1 - (1 + square) ** (-(exponent + 1) / 2)
        total += gauss * within / square * (width**2 + along**2) / width
    return total * beside * (last - first) / (4 * np.pi)


def _on_plane(direction: Float) -> Float:
    length = np.linalg.norm(direction, axis=-1)
    height = np.maximum(direction[..., 2], BEHIND * length)
    return direction[..., :2] / np.maximum(height, 1e-30)[..., None]
