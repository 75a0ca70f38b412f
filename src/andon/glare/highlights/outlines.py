"""Lamps' outlines as n points see them (float64)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.lamps import (
    AnyAreaLamp,
    DiskLamp,
    MeshLamp,
    PolygonLamp,
    SphereLamp,
    TubeLamp,
)
from andon.lamps.edges import FacetEdges, lamp_edges
from andon.spaces import perpendicular

__all__ = ["CORNERS", "Edge", "LampBall", "ball_of", "edges_of", "round_edges"]

Float = NDArray[np.float64]

# Of a round outline; the polygon is that of the same area.
CORNERS = 16
SAME_AREA = float(np.sqrt(2 * np.pi / (CORNERS * np.sin(2 * np.pi / CORNERS))))
# Each half circle of a tube, and each of its sides, is cut into so many parts; stretched along the
# tube, half a circle keeps its area.
TUBE_PARTS = 4
HALF_SAME_AREA = float(np.pi / (TUBE_PARTS * np.sin(np.pi / TUBE_PARTS)))
# Into how many parts a straight edge is cut, since it is curved among half vectors: of polygons,
# and of meshes and pictures, whose edges are shorter.
POLYGON_PARTS, FACET_PARTS = 4, 2


@dataclass(frozen=True, eq=False)
class Edge:
    """One edge, as n points see it.

    Attributes
    ----------
    start, end : (n, 3) from the points, metres.
    luminance_cd_m2 : (n, 3) of what lies on its left minus that on its right, as seen from there.
    """

    start: Float
    end: Float
    luminance_cd_m2: Float


@dataclass(frozen=True, eq=False)
class LampBall:
    """A ball that holds a lamp: `middle` (3,) and `radius_m`."""

    middle: Float
    radius_m: float


def ball_of(lamp: AnyAreaLamp, /) -> LampBall:
    """The ball around `lamp`; of a mesh about the mean of its corners."""
    match lamp:
        case SphereLamp() | DiskLamp():
            return LampBall(lamp.position_m, lamp.radius_m)
        case TubeLamp():
            half = float(np.linalg.norm(lamp.ends_m[1] - lamp.ends_m[0])) / 2
            return LampBall(lamp.ends_m.mean(axis=0), half + lamp.radius_m)
        case PolygonLamp():
            return _around(lamp.vertices_m)
        case MeshLamp():
            return _around(lamp.positions_m)


def _around(points: Float) -> LampBall:
    middle = points.mean(axis=0)
    return LampBall(middle, float(np.linalg.norm(points - middle, axis=1).max()))


def edges_of(lamp: AnyAreaLamp, points: Float, /) -> Iterator[Edge]:
    """The edges of `lamp` as `points` (n, 3) see them."""
    match lamp:
        case SphereLamp():
            yield from round_edges(lamp, lamp.position_m, lamp.radius_m, points)
        case DiskLamp():
            yield from _disk(lamp, points)
        case TubeLamp():
            yield from _closed(_tube(lamp, points), lamp.luminance_cd_m2)
        case PolygonLamp() | MeshLamp():
            is_plain = isinstance(lamp, PolygonLamp) and lamp.texture is None
            yield from _facets(lamp_edges(lamp), points, POLYGON_PARTS if is_plain else FACET_PARTS)


def round_edges(
    lamp: SphereLamp | None,
    position_m: Float,
    radius_m: float,
    points: Float,
    luminance_cd_m2: Float | None = None,
    /,
) -> Iterator[Edge]:
    """The outline of a ball; its luminance is the lamp's, or `luminance_cd_m2` (n, 3)."""
    reach = position_m - points
    distance = np.linalg.norm(reach, axis=-1, keepdims=True)
    sine = np.minimum(radius_m / np.maximum(distance, 1e-9), 0.999)
    towards = reach / np.maximum(distance, 1e-9)
    a, b = frames(towards)
    wide = SAME_AREA * sine / np.sqrt(1 - sine**2)
    corners = [towards + wide * (np.cos(turn) * a + np.sin(turn) * b) for turn in _turns()]
    light = luminance_cd_m2 if lamp is None else lamp.luminance_cd_m2
    assert light is not None
    yield from _closed(corners, light)


def frames(axes: Float, /) -> tuple[Float, Float]:
    """Unit vectors (n, 3) that form right-handed frames (a, b, axis) with unit `axes` (n, 3).

    Source: Duff et al. 2017, without branches, so that both engines have the same.
    """
    x, y, z = axes[..., 0], axes[..., 1], axes[..., 2]
    side = np.where(z >= 0, 1.0, -1.0)
    s = -1 / (side + z)
    t = x * y * s
    a = np.stack([1 + side * x * x * s, side * t, -side * x], axis=-1)
    return a, np.stack([t, side + y * y * s, -y], axis=-1)


def _turns() -> Float:
    return np.arange(CORNERS, dtype=np.float64) * (2 * np.pi / CORNERS)


def _closed(corners: list[Float], luminance: Float) -> Iterator[Edge]:
    light = np.broadcast_to(luminance, corners[0].shape)
    for start, end in zip(corners, [*corners[1:], corners[0]], strict=True):
        yield Edge(start, end, light)


def _disk(lamp: DiskLamp, points: Float) -> Iterator[Edge]:
    reach = lamp.position_m - points
    facing = -reach @ lamp.direction
    front = np.ones(len(points)) if lamp.two_sided else (facing > 0).astype(float)
    a, b = perpendicular(lamp.direction)
    # As a point before the disk sees them, corners run the other way about the normal.
    sense = np.where(facing > 0, -1.0, 1.0)[:, None]
    radius = SAME_AREA * lamp.radius_m
    corners = [reach + radius * (np.cos(t) * a + sense * np.sin(t) * b) for t in _turns()]
    yield from _closed(corners, front[:, None] * lamp.luminance_cd_m2)


def _tube(lamp: TubeLamp, points: Float) -> list[Float]:
    """Half a circle about either end, each square to the line of sight to it, and both sides."""
    start, end = (lamp.ends_m[k] - points for k in (0, 1))
    axis = end - start
    arcs = [
        _half_circle(end, axis, lamp.radius_m, 1.0),
        _half_circle(start, axis, lamp.radius_m, -1.0),
    ]
    corners: list[Float] = []
    for arc, following in (arcs, arcs[::-1]):
        step = (following[0] - arc[-1]) / TUBE_PARTS
        corners += [*arc, *(arc[-1] + part * step for part in range(1, TUBE_PARTS))]
    return corners


def _half_circle(end: Float, axis: Float, radius_m: float, way: float) -> list[Float]:
    distance = np.maximum(np.linalg.norm(end, axis=-1, keepdims=True), 1e-9)
    sight = end / distance
    along = axis - sight * np.einsum("ni,ni->n", axis, sight)[:, None]
    along /= np.maximum(np.linalg.norm(along, axis=-1, keepdims=True), 1e-9)
    across = np.cross(sight, along)
    sine = np.minimum(radius_m / distance, 0.999)
    wide = way * radius_m / np.sqrt(1 - sine**2)
    turns = np.linspace(-np.pi / 2, np.pi / 2, TUBE_PARTS + 1).tolist()
    return [
        end + wide * (HALF_SAME_AREA * np.cos(turn) * along + np.sin(turn) * across)
        for turn in turns
    ]


def _facets(edges: FacetEdges, points: Float, parts: int) -> Iterator[Edge]:
    for k in range(len(edges.a)):
        sides = [
            (points @ plane[k, :3] + plane[k, 3] > 0)[:, None] * light[k]
            for plane, light in (
                (edges.left_plane, edges.left_luminance_cd_m2),
                (edges.right_plane, edges.right_luminance_cd_m2),
            )
        ]
        # Facets run counter-clockwise as seen from outside, which is clockwise about the sight.
        light = sides[1] - sides[0]
        start, way = edges.a[k] - points, edges.b[k] - edges.a[k]
        for part in range(parts):
            yield Edge(start + way * (part / parts), start + way * ((part + 1) / parts), light)
