"""Projected solid angles by numbers alone: what `andon.lamps.form_factors` has closed forms for.

A convex lamp, seen from a point outside it, fills a convex cone of directions. Around an axis
inside the cone, each azimuth ψ has one angle α(ψ) at which the lamp ends; it is found by halving,
asking only whether a ray hits the lamp. What remains is

    F = ∫ dψ ∫ n·w sin α dα        over α in [0, α(ψ)] and w above the horizon (and past an edge)

whose inner integral is elementary and whose outer one is summed by Gauss's rule on panels that are
halved until they agree. No outline, no Stokes, no case for the horizon: nothing of the closed
forms. Nothing converges badly: α(ψ) is continuous, the horizon bends it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from andon.lamps.areas import (
    AreaLamp,
    DiskLamp,
    MeshLamp,
    PolygonLamp,
    SphereLamp,
    TubeLamp,
)

__all__ = ["Hits", "hits_of", "illuminance", "projected_solid_angle"]

Float = NDArray[np.float64]
# (number of the receiver (k,), unit directions (k, 3)) → (k,) bool
Hits = Callable[[NDArray[np.intp], Float], NDArray[np.bool_]]

NODES, PANELS, MAX_HALVINGS = 8, 16, 20
# Radians² below which a panel's disagreement is rounding: α(ψ) is known to 2e-14.
ROUNDING_SR = 1e-13
# Halvings of π: 2e-14 rad.
BISECTIONS = 47


def illuminance(
    lamp: AreaLamp, position: Float, normal: Float, /, *, edge: Float | None = None
) -> Float:
    """(n, 3) lux of `lamp` at `position` (n, 3) with unit `normal` (n, 3), nothing in between.

    Polygons must be convex, one-sided and without a texture, meshes closed, receivers outside.

    Parameters
    ----------
    edge : (n, 3) directions; only what lies on their side (w·edge > 0) is seen.
    """
    if isinstance(lamp, MeshLamp):
        luminance = lamp.facet_luminance_cd_m2
        if luminance is None:
            luminance = np.tile(lamp.luminance_cd_m2, (len(lamp.triangles), 1))
        facets = [
            PolygonLamp("", facet_luminance, corners)
            for facet_luminance, corners in zip(
                luminance, lamp.positions_m[lamp.triangles], strict=True
            )
        ]
        return np.sum([illuminance(f, position, normal, edge=edge) for f in facets], axis=0)
    hits, axis, front = hits_of(lamp, position)
    factor = np.zeros(len(position))
    if front.any():
        kept, corners = np.flatnonzero(front), None
        if isinstance(lamp, PolygonLamp):
            corners = lamp.vertices_m[:, None] - position[kept]
        factor[kept] = projected_solid_angle(
            lambda which, w: hits(kept[which], w),
            axis[kept],
            normal[kept],
            edge=None if edge is None else edge[kept],
            corners=corners,
        )
    return factor[:, None] * lamp.luminance_cd_m2


def hits_of(lamp: AreaLamp, position: Float, /) -> tuple[Hits, Float, NDArray[np.bool_]]:
    """Whether rays from `position` (n, 3) hit, an axis (n, 3) that does, and where any can."""
    everywhere = np.ones(len(position), bool)
    match lamp:
        case SphereLamp():
            reach = lamp.position_m - position
            return _sphere_hits(reach, lamp.radius_m), _unit(reach), everywhere
        case TubeLamp():
            ends = lamp.ends_m[:, None] - position
            hits = _tube_hits(ends[0], ends[1] - ends[0], lamp.radius_m)
            return hits, _unit(ends.mean(axis=0)), everywhere
        case DiskLamp():
            reach = lamp.position_m - position
            front = reach @ lamp.direction < 0
            return _disk_hits(reach, lamp.direction, lamp.radius_m), _unit(reach), front
        case PolygonLamp():
            corners = lamp.vertices_m[:, None] - position
            facing = np.cross(corners[1] - corners[0], corners[2] - corners[0])
            front = np.einsum("ni,ni->n", facing, corners[0]) < 0
            return _polygon_hits(corners), _unit(corners.mean(axis=0)), front
        case _:
            raise TypeError(f"no cone of {type(lamp).__name__}")


def _unit(vectors: Float) -> Float:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def _dot(a: Float, b: Float) -> Float:
    return np.einsum("...i,...i->...", a, b)


def _sphere_hits(reach: Float, radius: float) -> Hits:
    def hits(which: NDArray[np.intp], w: Float) -> NDArray[np.bool_]:
        c = reach[which]
        beside = np.cross(c, w)
        return (_dot(beside, beside) < radius**2) & (_dot(c, w) > 0)

    return hits


def _tube_hits(start: Float, along: Float, radius: float) -> Hits:
    """A ray meets the capsule if it meets a ball around one of the line's points."""

    def hits(which: NDArray[np.intp], w: Float) -> NDArray[np.bool_]:
        p, q = start[which], along[which]
        beside, turning = np.cross(p, w), np.cross(q, w)
        square = np.maximum(_dot(turning, turning), 1e-300)
        nearest = np.clip(-_dot(beside, turning) / square, 0, 1)[:, None]
        closest = beside + nearest * turning
        return (_dot(closest, closest) < radius**2) & (_dot(p + nearest * q, w) > 0)

    return hits


def _disk_hits(reach: Float, direction: Float, radius: float) -> Hits:
    def hits(which: NDArray[np.intp], w: Float) -> NDArray[np.bool_]:
        c = reach[which]
        approach = w @ direction
        with np.errstate(divide="ignore", invalid="ignore"):
            away = (c @ direction) / approach
            beside = w * away[:, None] - c
        return (approach < 0) & (_dot(beside, beside) < radius**2)

    return hits


def _polygon_hits(corners: Float) -> Hits:
    sides = np.cross(np.roll(corners, -1, axis=0), corners)

    def hits(which: NDArray[np.intp], w: Float) -> NDArray[np.bool_]:
        return np.logical_and.reduce([_dot(side[which], w) > 0 for side in sides])

    return hits


def projected_solid_angle(
    hits: Hits,
    axis: Float,
    normal: Float,
    /,
    *,
    edge: Float | None = None,
    corners: Float | None = None,
    tolerance: float = 2e-9,
) -> Float:
    """(n,) sr, ∫ max(0, n·w) dω over the directions w that hit; see the module's docstring.

    Parameters
    ----------
    hits : of convex cones, each less than a half space, true on its `axis`.
    axis, normal : (n, 3) unit.
    edge : (n, 3) directions; only w·edge > 0 counts.
    corners : (k, n, 3) of a polygon, as seen by the receivers.
    tolerance : of a panel against its halves, relative to the whole.
    """
    other = np.eye(3)[np.abs(axis).argmin(axis=1)]
    right = _unit(np.cross(axis, other))
    frame = np.stack([right, np.cross(axis, right), axis], axis=1)
    planes = [np.einsum("nij,nj->ni", frame, m) for m in (normal, edge) if m is not None]
    count = len(axis)
    bounds = _bounds(frame, corners, planes)
    which = np.repeat(np.arange(count), bounds.shape[1] - 1)
    low, width = bounds[:, :-1].ravel(), np.diff(bounds, axis=1).ravel()
    whole = _panels(hits, frame, planes, which, low, width)
    scale = np.zeros(count)
    np.add.at(scale, which, whole)
    total = np.zeros(count)
    for _ in range(MAX_HALVINGS):
        width = np.tile(width / 2, 2)
        low, both = np.concatenate([low, low + width[: len(low)]]), np.tile(which, 2)
        halves = _panels(hits, frame, planes, both, low, width)
        first, second = halves.reshape(2, -1)
        open_ = np.abs(first + second - whole) > tolerance * scale[which] + ROUNDING_SR
        np.add.at(total, which[~open_], (first + second)[~open_])
        again = np.tile(open_, 2)
        which, low, width, whole = both[again], low[again], width[again], halves[again]
        if not len(which):
            return total
    np.add.at(total, which, whole)
    return total


def _bounds(frame: Float, corners: Float | None, planes: list[Float]) -> Float:
    """(n, b) rising azimuths, the last one turn after the first.

    Panels end at corners, and where a plane cuts an outline between them: a sliver there would fall
    between all nodes. That is a hint to the sum, which has the same limit without it.
    """
    if corners is None:
        return np.tile(np.linspace(0, 2 * np.pi, PANELS + 1), (len(frame), 1))
    ends = np.einsum("nij,knj->kni", frame, corners)
    ahead = np.roll(ends, -1, axis=0)
    marks = [ends]
    for plane in planes:
        height = np.einsum("kni,ni->kn", ends, plane)
        next_height = np.einsum("kni,ni->kn", ahead, plane)
        cut = (height > 0) != (next_height > 0)
        drop: Float = np.where(cut, height - next_height, 1.0)
        share: Float = np.where(cut, height / drop, 0.0)
        marks.append(ends + share[..., None] * (ahead - ends))
    x, y, _ = np.moveaxis(np.concatenate(marks), -1, 0)
    turns = np.sort(np.arctan2(y, x).T, axis=1)
    return np.concatenate([turns, turns[:, :1] + 2 * np.pi], axis=1)


def _panels(
    hits: Hits,
    frame: Float,
    planes: list[Float],
    which: NDArray[np.intp],
    low: Float,
    width: Float,
) -> Float:
    """(k,) the integral over azimuths low…low + width of the receivers `which` (k,)."""
    x, weight = np.polynomial.legendre.leggauss(NODES)
    azimuth = (low[:, None] + (x + 1) / 2 * width[:, None]).ravel()
    node = np.repeat(which, NODES)
    side = np.stack([np.cos(azimuth), np.sin(azimuth)], axis=1)
    inner = _inner(_ends(hits, frame, node, side), side, [plane[node] for plane in planes])
    return inner.reshape(-1, NODES) @ weight / 2 * width


def _ends(hits: Hits, frame: Float, node: NDArray[np.intp], side: Float) -> Float:
    """(k,) angle from the axis at which the lamp ends towards `side` (k, 2)."""
    across = np.einsum("ki,kij->kj", side, frame[node, :2])
    axis = frame[node, 2]
    low, high = np.zeros(len(node)), np.full(len(node), np.pi)
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        w = np.sin(middle)[:, None] * across + np.cos(middle)[:, None] * axis
        inside = hits(node, w)
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    return (low + high) / 2


def _inner(end: Float, side: Float, planes: list[Float]) -> Float:
    """(k,) ∫ n·w sin α dα from 0 to `end` where w is on the right side of all planes.

    The first plane is the horizon. Along α a plane's m·w is a sine wave: positive before or after
    the one zero that it has in [0, π).
    """
    start, stop = np.zeros_like(end), end.copy()
    for plane in planes:
        level, slope = plane[:, 2], _dot(side, plane[:, :2])
        zero = np.arctan2(np.abs(level), slope * np.where(level > 0, -1.0, 1.0))
        stop = np.where(level > 0, np.minimum(stop, zero), stop)
        start = np.where(level > 0, start, np.maximum(start, zero))
    stop = np.maximum(stop, start)
    level, slope = planes[0][:, 2], _dot(side, planes[0][:, :2])

    def primitive(a: Float) -> Float:
        return level * np.sin(a) ** 2 / 2 + slope * (a / 2 - np.sin(2 * a) / 4)

    return primitive(stop) - primitive(start)
