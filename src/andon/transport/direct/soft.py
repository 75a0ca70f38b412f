"""Soft shadows: an area lamp is looked at from a few points on it.

The share of the lamp that a receiver sees is the mean over sample points, each weighted by what it
would contribute, and multiplies the closed form of the whole lamp::

    E = E_unshadowed · Σ wᵢ Vᵢ / Σ wᵢ,      wᵢ = Lᵢ · max(0, cos φᵢ) · cos θᵢ / dᵢ²

so that unshadowed light is exact whatever the number of samples, and the penumbra converges to
the truth with it.

=====================  =================  ==========================  ========================
soft shadow            maps a lamp        reads a pixel               wrong
=====================  =================  ==========================  ========================
**mean over n points** n, small           n (4n blended)              steps of 1/n, blended
percentage-closer      1                  some 30                     several occluders; size
ray traced             –                  –                           noise, without a GPU
=====================  =================  ==========================  ========================

Balls and tubes have no face: their samples lie *inside*, so densely that their projection on any
plane is even (the Abel inverse of a constant: density ∝ 1/√(R² − r²)), and count from all sides.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.lamps.areas import AreaLamp, DiskLamp, MeshLamp, PolygonLamp, SphereLamp, TubeLamp
from andon.lamps.polygons import vector_area
from andon.quantities import photometric
from andon.spaces import perpendicular

__all__ = [
    "NO_FACE",
    "ONE_SIDE",
    "TWO_SIDES",
    "Samples",
    "probes",
    "sample_points",
    "sample_weights",
]

Float = NDArray[np.float64]

# How a sample's light depends on the direction in which it leaves.
NO_FACE, ONE_SIDE, TWO_SIDES = 0, 1, 2
# Samples below the receiver's horizon count this much, so that a sum is never empty.
LEAST_COSINE = 1e-4


@dataclass(frozen=True)
class Samples:
    """Points on (or in) a lamp.

    Attributes
    ----------
    points : (n, 3) metres, world.
    normals : (n, 3) unit, of the emitting side; zero where there is none.
    light : (n, 3) luminance × area of each sample, in any unit common to all, ≥ 0.
    sides : `NO_FACE`, `ONE_SIDE` or `TWO_SIDES`.
    """

    points: Float
    normals: Float
    light: Float
    sides: int


def sample_points(lamp: AreaLamp, count: int, /) -> Samples:
    """`count` ≥ 1 points, evenly spread; the same for every frame, so that nothing flickers.

    The first of them are the farthest apart: where these agree, so do all (`probes`).
    """
    samples = _samples(lamp, count)
    order = _farthest_first(samples.points)
    return Samples(
        samples.points[order], samples.normals[order], samples.light[order], samples.sides
    )


def probes(count: int, /) -> int:
    """How many of `count` samples are asked before the rest is believed to agree with them."""
    return count if count <= 8 else 6 if count <= 16 else 8


def _farthest_first(points: Float) -> NDArray[np.intp]:
    """(n,) an order in which each point is the farthest from those before it.

    Rounded from the middle, so that a lamp that moves keeps its order.
    """
    points = points - points.mean(axis=0)
    step = 1e-6 * max(float(np.abs(points).max()), 1e-300)
    points = np.rint(points / step)
    order = [int(np.argmax(np.linalg.norm(points - points.mean(axis=0), axis=1)))]
    distance = np.linalg.norm(points - points[order[0]], axis=1)
    while len(order) < len(points):
        distance[order] = -1
        order.append(int(np.argmax(distance)))
        distance = np.minimum(distance, np.linalg.norm(points - points[order[-1]], axis=1))
    return np.array(order)


def _samples(lamp: AreaLamp, count: int) -> Samples:
    match lamp:
        case SphereLamp():
            inside = _centred(_in_a_ball(count))
            inside /= np.maximum(np.linalg.norm(inside, axis=1, keepdims=True), 1)
            return _faceless(lamp.position_m + inside * lamp.radius_m)
        case TubeLamp():
            return _faceless(lamp.ends_m.mean(axis=0) + _centred(_in_a_tube(lamp, count)))
        case DiskLamp():
            right, up = perpendicular(lamp.direction)
            disk = _centred(_on_a_disk(count)) * lamp.radius_m
            points = lamp.position_m + disk[:, :1] * right + disk[:, 1:] * up
            return _flat(points, lamp.direction, np.ones((count, 3)), lamp.two_sided)
        case PolygonLamp():
            return _on_a_polygon(lamp, count)
        case MeshLamp():
            return _on_a_mesh(lamp, count)
        case _:
            raise TypeError(f"{type(lamp).__name__} has no area")


def sample_weights(samples: Samples, position: Float, normal: Float, /) -> Float:
    """(n, m, 3) what each sample gives to receivers at `position` (m, 3), up to a factor."""
    reach = samples.points[:, None, :] - position
    square = np.maximum(np.einsum("nmi,nmi->nm", reach, reach), 1e-12)
    cosine = np.einsum("nmi,mi->nm", reach, normal) / np.sqrt(square)
    weight = np.maximum(cosine, LEAST_COSINE) / square
    if samples.sides != NO_FACE:
        leaving = -np.einsum("nmi,ni->nm", reach, samples.normals) / np.sqrt(square)
        leaving = np.abs(leaving) if samples.sides == TWO_SIDES else leaving
        weight = weight * np.maximum(leaving, LEAST_COSINE)
    return weight[..., None] * samples.light[:, None, :]


def _centred(points: Float) -> Float:
    """The points around their mean, so that a shadow lies where the lamp's middle puts it."""
    return points - points.mean(axis=0)


def _faceless(points: Float) -> Samples:
    return Samples(points, np.zeros_like(points), np.ones_like(points), NO_FACE)


def _flat(points: Float, normal: Float, light: Float, two_sided: bool) -> Samples:
    normals = np.broadcast_to(normal, points.shape).copy()
    return Samples(points, normals, light, TWO_SIDES if two_sided else ONE_SIDE)


def _sequence(count: int, dimensions: int) -> Float:
    """(count, dimensions) in (0, 1): Roberts's R sequence, additive recurrence of the root of
    x^(d+1) = x + 1."""
    steps = _steps(dimensions)
    return (0.5 + np.arange(1, count + 1)[:, None] * steps) % 1


def _steps(dimensions: int) -> Float:
    root = 1.5
    for _ in range(64):
        root = (1 + root) ** (1 / (dimensions + 1))
    return root ** -np.arange(1, dimensions + 1, dtype=np.float64)


def _lattice(count: int, dimensions: int) -> Float:
    """(count, dimensions) in (0, 1): a rank-1 lattice; on every axis one point in each of `count`
    equal parts, so that the mean is the middle and a shadow's edge moves in even steps."""
    index = np.arange(count)
    columns = [index]
    for step in _steps(dimensions)[: dimensions - 1]:
        factor = max(1, round(count * step))
        while np.gcd(factor, count) != 1:
            factor += 1
        columns.append(index * factor % count)
    return (np.stack(columns, axis=1) + 0.5) / count


def _radius_of_even_projection(share: Float) -> Float:
    """Radii in [0, 1] below which `share` of a ball of density 1/√(1 − r²) lies.

    With r = sin u that share is (2u − sin 2u)/π; solved by bisection.
    """
    low, high = np.zeros_like(share), np.full_like(share, np.pi / 2)
    for _ in range(50):
        middle = (low + high) / 2
        below = (2 * middle - np.sin(2 * middle)) / np.pi < share
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return np.sin((low + high) / 2)


def _in_a_ball(count: int) -> Float:
    a, b, c = _lattice(count, 3).T
    height, turn = 2 * a - 1, 2 * np.pi * b
    across = np.sqrt(1 - height**2)
    direction = np.stack([across * np.cos(turn), height, across * np.sin(turn)], axis=1)
    return direction * _radius_of_even_projection(c)[:, None]


def _in_a_tube(lamp: TubeLamp, count: int) -> Float:
    axis = lamp.ends_m[1] - lamp.ends_m[0]
    length = float(np.linalg.norm(axis))
    right, up = perpendicular(axis / length)
    a, b, c = _lattice(count, 3).T
    # In a disc of density 1/√(1 − r²) the share below r is 1 − √(1 − r²).
    radius = lamp.radius_m * np.sqrt(1 - (1 - c) ** 2)
    # The round ends count as 2/3 of a radius each.
    reach = length + 4 / 3 * lamp.radius_m
    along = ((a - 0.5) * reach + 0.5 * length) / length
    turn = 2 * np.pi * b
    around = np.cos(turn)[:, None] * right + np.sin(turn)[:, None] * up
    return lamp.ends_m[0] + along[:, None] * axis + radius[:, None] * around


def _on_a_disk(count: int) -> Float:
    """(count, 2) in the unit disk: Fermat's spiral by golden angles (Vogel 1979)."""
    index = np.arange(count)
    radius = np.sqrt((index + 0.5) / count)
    turn = index * np.pi * (3 - np.sqrt(5))
    return np.stack([radius * np.cos(turn), radius * np.sin(turn)], axis=1)


def _on_a_polygon(lamp: PolygonLamp, count: int) -> Samples:
    vertices = lamp.vertices_m
    spanned = vector_area(vertices)
    area = float(np.linalg.norm(spanned))
    normal = spanned / area
    right = vertices[1] - vertices[0]
    right /= np.linalg.norm(right)
    up = np.cross(normal, right)
    flat = np.stack([(vertices - vertices[0]) @ right, (vertices - vertices[0]) @ up], axis=1)
    low, high = flat.min(axis=0), flat.max(axis=0)
    width, height = (high - low).tolist()
    light = np.ones((count, 3))
    if lamp.texture is not None:
        place, light = _on_a_picture(lamp.texture, count)
        inside = low + place * (high - low)
    elif np.isclose(area, width * height):
        inside = low + _lattice(count, 2) * (high - low)
    else:
        inside = _in_a_polygon(flat, area, count)
    points = vertices[0] + inside[:, :1] * right + inside[:, 1:] * up
    return _flat(points, normal, light, lamp.two_sided)


def _in_a_polygon(flat: Float, area: float, count: int) -> Float:
    """(count, 2) in the polygon (k, 2): of a box around it, the points that fall into it."""
    low, high = flat.min(axis=0), flat.max(axis=0)
    width, height = (high - low).tolist()
    wanted = int(np.ceil(count * width * height / area))
    # A few more than the areas say, since a sequence need not fill the polygon in proportion.
    candidates = low + _sequence(4 * wanted + 64, 2) * (high - low)
    return candidates[_is_inside(candidates, flat)][:count]


def _is_inside(points: Float, flat: Float) -> NDArray[np.bool_]:
    """(n,) points (n, 2) in the polygon (k, 2): an odd number of edges to their right."""
    a, b = flat, np.roll(flat, -1, axis=0)
    between = (a[:, 1] > points[:, None, 1]) != (b[:, 1] > points[:, None, 1])
    rise = np.where(a[:, 1] == b[:, 1], 1.0, b[:, 1] - a[:, 1])
    at = a[:, 0] + (points[:, None, 1] - a[:, 1]) / rise * (b[:, 0] - a[:, 0])
    return np.count_nonzero(between & (points[:, None, 0] < at), axis=1) % 2 == 1


def _on_a_picture(texture: Float, count: int) -> tuple[Float, Float]:
    """Places (count, 2) across and up in [0, 1], as dense as the picture is bright, and the light
    (count, 3) of each, of photometric value 1; row 0 is the top."""
    bright = np.maximum(photometric(np.asarray(texture, np.float64)), 0)[::-1]
    light = np.maximum(np.asarray(texture, np.float64), 0)[::-1]
    if not bright.any():
        bright, light = np.ones_like(bright), np.ones_like(light)
    u, v = _lattice(count, 2).T
    row, up = _inverse(bright.sum(axis=1)[None], v[:, None])
    column, across = _inverse(bright[row[:, 0]], u[:, None])
    place = np.stack([across[:, 0], up[:, 0]], axis=1)
    row, column = row[:, 0], column[:, 0]
    return place, light[row, column] / bright[row, column, None]


def _inverse(density: Float, share: Float) -> tuple[NDArray[np.intp], Float]:
    """Cell and place in [0, 1] below which `share` (n, 1) of `density` (1 or n, cells) lies."""
    bounds = np.cumsum(density, axis=1) / density.sum(axis=1, keepdims=True)
    cell = (bounds < share).sum(axis=1, keepdims=True).clip(max=density.shape[1] - 1)
    bounds = np.broadcast_to(bounds, (len(share), density.shape[1]))
    high = np.take_along_axis(bounds, cell, axis=1)
    low = np.where(cell > 0, np.take_along_axis(bounds, np.maximum(cell - 1, 0), axis=1), 0.0)
    within = (share - low) / np.maximum(high - low, 1e-300)
    return cell, (cell + within.clip(0, 1)) / density.shape[1]


def _on_a_mesh(lamp: MeshLamp, count: int) -> Samples:
    """As densely as the facets are bright, so that none is wasted on dark ones."""
    a, b, c = np.moveaxis(lamp.positions_m[lamp.triangles], 1, 0)
    cross = np.cross(b - a, c - a)
    area = np.linalg.norm(cross, axis=1) / 2
    # Light taken away is sampled as light that is given.
    light = np.ones((len(area), 3))
    if lamp.facet_luminance_cd_m2 is not None:
        light = np.abs(lamp.facet_luminance_cd_m2)
    bright = photometric(light)
    if not bright.any():
        light, bright = np.ones_like(light), np.ones_like(bright)
    bounds = np.cumsum(area * bright)
    bounds /= bounds[-1]
    facet = np.searchsorted(bounds, (np.arange(count) + 0.5) / count).clip(max=len(area) - 1)
    u, v = _lattice(count, 2).T
    folded = u + v > 1
    u = np.asarray(np.where(folded, 1 - u, u), np.float64)
    v = np.asarray(np.where(folded, 1 - v, v), np.float64)
    points = a[facet] + u[:, None] * (b - a)[facet] + v[:, None] * (c - a)[facet]
    normals = cross[facet] / (2 * area[facet, None])
    return Samples(points, normals, light[facet] / bright[facet, None], ONE_SIDE)
