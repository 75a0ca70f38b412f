"""Where rays cross the boundary of a body, in the body's own frame.

Which boundary is asked for follows from where the ray is: one outside a body looks for the nearest
boundary that it would enter by, one inside for the nearest that it would leave by. So a ray that
starts *on* a boundary does not find that one again, however its start was rounded.

====== ========================== ================================ =========================
shape  boundaries (`Hits.part`)   crossings                        turning of normals
====== ========================== ================================ =========================
ball   0                          |P| = R                          I/R
slab   0…5: −x +x −y +y −z +z     planes, in turn                  0
lens   0 front, 1 back, 2 rim     κ·p² + 2·s·z = 0 about each      κ·I; on the rim I/R across
                                  vertex, and the rim's cylinder
mesh   the triangle               `andon.glass.mesh`               by the corners' normals
====== ========================== ================================ =========================
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from andon.glass.lens import lens_boundary, lens_contains, lens_crossing
from andon.glass.mesh import mesh_body
from andon.glass.model import Ball, Closed, LensShape, Slab
from andon.glass.refraction import dot

__all__ = ["Boundary", "Hits", "Shape", "boundary", "contains", "hit", "scale_of"]

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]
Shape = Ball | Slab | LensShape | Closed

# A boundary nearer than this share of a body's size is the one that the ray stands on.
NEAR = 1e-7


class Hits(NamedTuple):
    """The boundary that each of n rays meets next.

    Attributes
    ----------
    t : (n,) metres along the unit direction, inf where there is none.
    part : (n,) int, which boundary of the shape; −1 where there is none.
    weights : (n, 3) of a triangle's corners (mesh only), else 0.
    """

    t: Float
    part: NDArray[np.int64]
    weights: Float


@dataclass(frozen=True)
class Boundary:
    """A shape's boundary at n points.

    Attributes
    ----------
    normal : (n, 3) unit, outward: what light is refracted at.
    facet : (n, 3) unit, outward: of the geometry; `normal` but for smooth meshes.
    turning : (n, 3, 3) how `normal` turns along the boundary: dN = turning @ dP.
    uv : (n, 2) sticker coordinates, v down; NaN where nothing sticks.
    uv_slope : (n, 2, 3) how they grow along the boundary: duv = uv_slope @ dP.
    """

    normal: Float
    facet: Float
    turning: Float
    uv: Float
    uv_slope: Float


def scale_of(shape: Shape, /) -> float:
    """Size of a shape in metres, for tolerances: the radius about its frame's origin, or less."""
    match shape:
        case Ball(radius):
            return radius
        case Slab(half):
            return float(np.max(half))
        case LensShape(radius, _, thickness):
            return max(radius, thickness / 2)
        case Closed():
            return mesh_body(shape).size


def hit(shape: Shape, origins: Float, directions: Float, inside: Bool, /) -> Hits:
    """The boundaries by which rays enter a shape next, or leave it where they are `inside`.

    Parameters
    ----------
    origins, directions : (n, 3) in the shape's frame; directions of unit length.
    inside : (n,) bool, the ray is inside this shape.
    """
    match shape:
        case Ball(radius):
            t, part = _ball(radius, origins, directions, inside)
        case Slab(half):
            t, part = _slab(half, origins, directions, inside)
        case LensShape():
            t, part = lens_crossing(shape, origins, directions, inside, NEAR * scale_of(shape))
        case Closed():
            return Hits(*mesh_body(shape).crossing(origins, directions, inside))
    return Hits(t, np.where(np.isfinite(t), part, -1), np.zeros((len(t), 3)))


def boundary(shape: Shape, points: Float, part: NDArray[np.int64], weights: Float, /) -> Boundary:
    """Normals and sticker coordinates at `points` (n, 3) of the shape's frame; see `Hits`."""
    match shape:
        case Ball(radius):
            return _ball_boundary(radius, points)
        case Slab(half):
            return _slab_boundary(half, points, part)
        case LensShape():
            normal, turning, uv, uv_slope = lens_boundary(shape, points, part)
            return Boundary(normal, normal, turning, uv, uv_slope)
        case Closed():
            return Boundary(*mesh_body(shape).boundary(part, weights))


def contains(shape: Shape, points: Float, /, *, margin_m: float = 0.0) -> Bool:
    """(n,) bool: `points` (n, 3) are inside, by more than `margin_m` (below 0: or that near).

    Of a mesh with a margin below 0, points on the boundary may count as either.
    """
    match shape:
        case Ball(radius):
            return np.linalg.norm(points, axis=-1) < radius - margin_m
        case Slab(half):
            return np.all(np.abs(points) < half - margin_m, axis=-1)
        case LensShape():
            return lens_contains(shape, points, margin_m)
        case Closed():
            return mesh_body(shape).contains(points, margin_m)


def _ball(
    radius: float, origins: Float, directions: Float, inside: Bool
) -> tuple[Float, NDArray[np.int64]]:
    near = NEAR * radius
    middle = -dot(origins, directions)
    aside = origins + middle[:, None] * directions
    half = np.sqrt(np.maximum((radius - (d := np.linalg.norm(aside, axis=-1))) * (radius + d), 0))
    enters = (d < radius) & (middle - half > -near) & (middle + half > near)
    # From inside there is a way out, even for a start that rounding put a hair outside.
    t = np.where(inside, np.maximum(middle + half, 0), np.where(enters, middle - half, np.inf))
    return t, np.zeros(len(t), np.int64)


def _ball_boundary(radius: float, points: Float) -> Boundary:
    normal = points / np.linalg.norm(points, axis=-1, keepdims=True)
    u = 0.5 + np.arctan2(normal[:, 0], normal[:, 2]) / (2 * np.pi)
    v = np.arccos(np.clip(normal[:, 1], -1, 1)) / np.pi
    turning = np.broadcast_to(np.eye(3) / radius, (len(points), 3, 3))
    uv = np.stack([u, v], axis=-1)
    return Boundary(normal, normal, turning, uv, _latlong_slope(normal) / radius)


def _latlong_slope(normal: Float) -> Float:
    """(n, 2, 3) derivative of a ball's u and v by the direction (n, 3)."""
    x, y, z = normal.T
    across = np.maximum(x * x + z * z, np.finfo(float).eps)
    down = np.sqrt(across)
    u = np.stack([z / across, np.zeros_like(x), -x / across], axis=-1) / (2 * np.pi)
    v = np.stack([x * y / down, -down, z * y / down], axis=-1) / np.pi
    return np.stack([u, v], axis=1)


def _slab(
    half: Float, origins: Float, directions: Float, inside: Bool
) -> tuple[Float, NDArray[np.int64]]:
    near = NEAR * float(np.max(half))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        planes = (np.stack([-half, half])[:, None] - origins) / directions
    # Along a pair of planes a ray is between them for ever, or never.
    between = np.abs(origins) <= half
    parallel = directions == 0
    first = np.where(parallel, np.where(between, -np.inf, np.inf), planes.min(axis=0))
    last = np.where(parallel, np.where(between, np.inf, -np.inf), planes.max(axis=0))
    t0, t1 = first.max(axis=-1), last.min(axis=-1)
    enters = (t0 < t1) & (t0 > -near) & (t1 > near)
    t = np.where(inside, np.maximum(t1, 0), np.where(enters, t0, np.inf))
    axis = np.argmin(np.where(inside[:, None], last, -first), axis=-1)
    forward = directions[np.arange(len(axis)), axis] > 0
    return t, 2 * axis + (forward == inside)


def _slab_boundary(half: Float, points: Float, part: NDArray[np.int64]) -> Boundary:
    normal = np.zeros_like(points)
    rows = np.arange(len(points))
    normal[rows, part // 2] = np.where(part % 2, 1.0, -1.0)
    uv = np.stack([0.5 + points[:, 0] / (2 * half[0]), 0.5 - points[:, 1] / (2 * half[1])], axis=-1)
    uv[part < 4] = np.nan
    slope = np.broadcast_to([[0.5 / half[0], 0, 0], [0, -0.5 / half[1], 0]], (len(points), 2, 3))
    return Boundary(normal, normal, np.zeros((len(points), 3, 3)), uv, slope)
