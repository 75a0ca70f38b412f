"""Rays and lenses: two spherical caps and the cylinder of the rim.

A cap is κ·p² + 2·s·z = 0, with p from its vertex, s = +1 for the front and −1 for the back, and
κ = 1/R: precise for the flattest of them. Its normal is κ·p + s·ẑ, of unit length on the cap.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.glass.model import LensShape
from andon.glass.refraction import dot

__all__ = ["cap_heights", "lens_boundary", "lens_contains", "lens_crossing"]

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]
Int = NDArray[np.int64]

FRONT, BACK, RIM = 0, 1, 2
SIDES = (1.0, -1.0)
# Caps and rim overlap by this share of the radius, so that no ray slips through where they meet.
OVERLAP = 1e-12


def cap_heights(lens: LensShape, across_m: Float, /) -> tuple[Float, Float]:
    """z of the front and of the back in metres, `across_m` (n,) from the axis; NaN beyond R."""
    heights: list[Float] = []
    for side, radius in zip(SIDES, lens.curvature_m, strict=True):
        # The sag: R − √(R² − r²) with R's sign, without the difference of large numbers.
        with np.errstate(invalid="ignore"):
            root = np.sqrt(radius * radius - across_m * across_m)
        sag = across_m * across_m / (radius + np.copysign(root, radius))
        heights.append(side * (lens.thickness_m / 2 - sag))
    return heights[0], heights[1]


def lens_contains(lens: LensShape, points: Float, margin_m: float, /) -> Bool:
    """(n,) bool: `points` (n, 3) are inside by more than `margin_m`, along the axis and across."""
    across = np.hypot(points[:, 0], points[:, 1])
    front, back = cap_heights(lens, np.minimum(across, lens.radius_m))
    z = points[:, 2]
    return (across < lens.radius_m - margin_m) & (z < front - margin_m) & (z > back + margin_m)


def lens_crossing(
    lens: LensShape, origins: Float, directions: Float, inside: Bool, near_m: float, /
) -> tuple[Float, Int]:
    """Distance (n,) to the next boundary that is entered, or left where `inside`; and which."""
    best, part = np.full(len(origins), np.inf), np.full(len(origins), RIM, np.int64)
    for place in (FRONT, BACK, RIM):
        roots = (
            _rim_roots(lens, origins, directions)
            if place == RIM
            else _cap_roots(lens, place, origins, directions)
        )
        for t in roots:
            points = origins + np.where(np.isfinite(t), t, 0)[:, None] * directions
            leaves = dot(directions, _normal(lens, place, points)) > 0
            good = np.isfinite(t) & (t > -near_m) & (leaves == inside)
            good &= _on_boundary(lens, place, points) & (t < best)
            best[good], part[good] = t[good], place
    # A boundary a hair behind is where the ray stands, and what it crosses now.
    return np.maximum(best, 0), part


def lens_boundary(
    lens: LensShape, points: Float, part: Int, /
) -> tuple[Float, Float, Float, Float]:
    """Normals (n, 3), their turning, sticker coordinates and their slope; see `Boundary`."""
    normal, turning = np.zeros_like(points), np.zeros((len(points), 3, 3))
    for place in (FRONT, BACK, RIM):
        here = part == place
        normal[here] = _normal(lens, place, points[here])
        flat = np.diag([1.0, 1.0, 0.0]) / lens.radius_m
        turning[here] = flat if place == RIM else np.eye(3) / lens.curvature_m[place]
    normal /= np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), np.finfo(float).tiny)
    width = 2 * lens.radius_m
    uv = np.stack([0.5 + points[:, 0] / width, 0.5 - points[:, 1] / width], axis=-1)
    uv[part == RIM] = np.nan
    slope = np.broadcast_to([[1 / width, 0, 0], [0, -1 / width, 0]], (len(points), 2, 3))
    return normal, turning, uv, slope


def _from_vertex(lens: LensShape, place: int, points: Float) -> Float:
    return points - np.array([0, 0, SIDES[place] * lens.thickness_m / 2])


def _normal(lens: LensShape, place: int, points: Float) -> Float:
    if place == RIM:
        return points * [1, 1, 0] / lens.radius_m
    vertex = _from_vertex(lens, place, points)
    return vertex / lens.curvature_m[place] + [0, 0, SIDES[place]]


def _cap_roots(
    lens: LensShape, place: int, origins: Float, directions: Float
) -> tuple[Float, Float]:
    start, side = _from_vertex(lens, place, origins), SIDES[place]
    kappa = 1 / lens.curvature_m[place]
    # κt² + 2bt + c = 0
    b = kappa * dot(start, directions) + side * directions[:, 2]
    c = kappa * dot(start, start) + 2 * side * start[:, 2]
    return _roots(np.full_like(b, kappa), b, c)


def _rim_roots(lens: LensShape, origins: Float, directions: Float) -> tuple[Float, Float]:
    o, d = origins[:, :2], directions[:, :2]
    return _roots(dot(d, d), dot(o, d), dot(o, o) - lens.radius_m**2)


def _roots(a: Float, b: Float, c: Float) -> tuple[Float, Float]:
    """Both solutions of a·t² + 2·b·t + c = 0 without cancellation; NaN or inf where none."""
    with np.errstate(divide="ignore", invalid="ignore"):
        q = -(b + np.copysign(np.sqrt(b * b - a * c), b))
        return q / a, c / q


def _on_boundary(lens: LensShape, place: int, points: Float) -> Bool:
    slack = OVERLAP * max(lens.radius_m, lens.thickness_m)
    across = np.hypot(points[:, 0], points[:, 1])
    if place == RIM:
        front, back = cap_heights(lens, np.array([lens.radius_m]))
        return (points[:, 2] < front + slack) & (points[:, 2] > back - slack)
    # The other half of the sphere is no boundary: there the normal looks the other way.
    facing = _normal(lens, place, points)[:, 2] * SIDES[place] > -OVERLAP
    return (across < lens.radius_m + slack) & facing
