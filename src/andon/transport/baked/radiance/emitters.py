"""Area lamps as the flat tiles of which Radiance is told.

Radiance looks at the middle of each: a lamp of n tiles that are seen casts n hard shadows. What
stands just before a lamp's edge is missed by few tiles: the frame of the andon in `examples/tatami`
takes 5 % of its light, of which 64 tiles see nothing, and 600 half. Its own large balls have no
horizon (-62 % at 88° from the lamp's direction, where half a ball shows): tiles have one.
"""

from __future__ import annotations

from collections.abc import Sequence
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
from andon.lamps.polygons import polygon_triangles
from andon.lamps.solids import capsule, disk, icosphere
from andon.lamps.triangles import triangle_areas, unit_normals

__all__ = ["Tiles", "tiles_of"]

Float = NDArray[np.float64]

# Half of what separates both sides of a flat lamp: in one plane it would be chance which is met.
HALF_GAP_M = 5e-5
# A rectangle's tiles are no longer than this times their width.
ALONG_TOO = 1.5
# Where a triangle's longest edge is cut: of all shares the golden one is repeated least.
UNEVEN = 2 / (1 + np.sqrt(5))
# Corners of the fan with which a disk begins.
DISK_CORNERS = 12
# Sides of a tube: odd, since seen from around the width of a polygon of 13 corners varies by 0.7 %,
# of one of 12 by 3.4 %. Its caps have two rings.
TUBE_SIDES, TUBE_RINGS = 13, 2
# A parallelogram's corner may be off by this share of its size.
PARALLEL = 1e-6


@dataclass(frozen=True, eq=False)
class Tiles:
    """Flat polygons of one luminance.

    Attributes
    ----------
    corners : (n, k, 3) metres, counter-clockwise as seen from the side that emits.
    luminance_cd_m2 : (3,).
    """

    corners: Float
    luminance_cd_m2: Float


def tiles_of(lamp: AnyAreaLamp, count: int, /) -> list[Tiles]:
    """About `count` tiles of the lamp; no fewer than a mesh has."""
    match lamp:
        case SphereLamp():
            parts = [Tiles(_ball(lamp, count), lamp.luminance_cd_m2)]
        case TubeLamp():
            parts = _tube(lamp, count)
        case DiskLamp():
            flat = disk(lamp.position_m, lamp.direction, lamp.radius_m, corners=DISK_CORNERS)
            corners = _cut(flat.positions[flat.triangles], count)
            parts = [Tiles(corners, lamp.luminance_cd_m2)]
        case PolygonLamp():
            parts = _polygon(lamp, count)
        case MeshLamp():
            return _mesh(lamp, count)
    if isinstance(lamp, DiskLamp | PolygonLamp) and lamp.two_sided:
        return _both_sides(parts)
    return parts


def _ball(lamp: SphereLamp, count: int) -> Float:
    cuts = 1
    while 20 * 4**cuts < count:
        cuts += 1
    unit_ball = icosphere(cuts)
    corners = unit_ball.positions[unit_ball.triangles]
    # Of a convex body the mean projection is a quarter of the surface (Cauchy): of the same
    # surface, it gives the same flux.
    corners = corners * np.sqrt(4 * np.pi / triangle_areas(corners).sum()) * lamp.radius_m
    return corners + lamp.position_m


def _tube(lamp: TubeLamp, count: int) -> list[Tiles]:
    """Flat sides round the line, each in pieces, and a round cap at each end."""
    along = lamp.ends_m[1] - lamp.ends_m[0]
    length = float(np.linalg.norm(along))
    pieces = max(1, round(count / TUBE_SIDES))
    whole = capsule(lamp.ends_m, lamp.radius_m, around=TUBE_SIDES, caps=TUBE_RINGS)
    caps = whole.positions[whole.triangles]
    share = (caps - lamp.ends_m[0]) @ along / length**2
    is_side = (share.min(axis=1) < 1e-9) & (share.max(axis=1) > 1 - 1e-9)
    # The capsule's own rings at both ends of the line, without the seam's second vertex.
    ring = (TUBE_SIDES + 1) * TUBE_RINGS + np.arange(TUBE_SIDES + 1)
    start, turn = whole.positions[ring], np.arange(TUBE_SIDES)
    quads = np.stack([start[turn], start[turn + 1]], axis=1)
    steps = np.arange(pieces + 1)[:, None, None, None] / pieces * along
    low, high = quads + steps[:-1], quads + steps[1:]
    sides = np.concatenate([low, high[:, :, ::-1]], axis=2).reshape(-1, 4, 3)
    found = [sides, caps[~is_side]]
    area = float(np.linalg.norm(sides[0, 1] - sides[0, 0])) * length * TUBE_SIDES
    area += float(triangle_areas(found[1]).sum())
    exact = 2 * np.pi * lamp.radius_m * (length + 2 * lamp.radius_m)
    middle, axis = lamp.ends_m.mean(axis=0), along / length

    def thicker(corners: Float) -> Float:
        """As wide as the round one on the mean (Cauchy again), and as long."""
        level = ((corners - middle) @ axis)[..., None] * axis
        return middle + level + (corners - middle - level) * exact / area

    return [Tiles(thicker(corners), lamp.luminance_cd_m2) for corners in found]


def _polygon(lamp: PolygonLamp, count: int) -> list[Tiles]:
    vertices = np.asarray(lamp.vertices_m, np.float64)
    if len(vertices) != 4 or not _is_parallelogram(vertices):
        return [Tiles(_cut(vertices[polygon_triangles(vertices)], count), lamp.luminance_cd_m2)]
    across, along = vertices[1] - vertices[0], vertices[3] - vertices[0]
    columns, rows = _grid(float(np.linalg.norm(across)), float(np.linalg.norm(along)), count)
    s, t = np.arange(columns + 1) / columns, np.arange(rows + 1) / rows
    points = vertices[0] + t[:, None, None] * along + s[None, :, None] * across
    corners = np.stack([points[:-1, :-1], points[:-1, 1:], points[1:, 1:], points[1:, :-1]], axis=2)
    if lamp.texture is None:
        return [Tiles(corners.reshape(-1, 4, 3), lamp.luminance_cd_m2)]
    # Row 0 of the picture is the top, where the grid ends.
    factor = _means(lamp.texture, rows, columns)[::-1]
    return [
        Tiles(corners[row, column][None], lamp.luminance_cd_m2 * factor[row, column])
        for row in range(rows)
        for column in range(columns)
    ]


def _is_parallelogram(vertices: Float) -> bool:
    off = np.linalg.norm(vertices[0] - vertices[1] + vertices[2] - vertices[3])
    return bool(off <= PARALLEL * np.linalg.norm(vertices[2] - vertices[0]))


def _grid(width: float, height: float, count: int) -> tuple[int, int]:
    """Columns and rows of about square tiles."""
    columns = max(1, round(float(np.sqrt(count * width / height))))
    return columns, max(1, round(count / columns))


def _means(picture: Float, rows: int, columns: int) -> Float:
    """(rows, columns, 3) means of a picture (h, w, 3) over equal tiles, exact for its pixels."""
    down, right = _shares(picture.shape[0], rows), _shares(picture.shape[1], columns)
    return np.einsum("rh,hwk,cw->rck", down, picture, right)


def _shares(pixels: int, tiles: int) -> Float:
    """(tiles, pixels) how much of each tile is of which pixel; rows sum to 1."""
    start = np.arange(tiles)[:, None] / tiles * pixels
    end = (np.arange(tiles)[:, None] + 1) / tiles * pixels
    pixel = np.arange(pixels)
    return np.clip(np.minimum(end, pixel + 1) - np.maximum(start, pixel), 0, None) * tiles / pixels


def _mesh(lamp: MeshLamp, count: int) -> list[Tiles]:
    corners = lamp.positions_m[lamp.triangles]
    if lamp.facet_luminance_cd_m2 is None:
        return [Tiles(_cut(corners, count), lamp.luminance_cd_m2)]
    target = float(triangle_areas(corners).sum()) / count
    values, group = np.unique(lamp.facet_luminance_cd_m2, axis=0, return_inverse=True)
    group = group.reshape(-1)
    return [
        Tiles(_cut_to(corners[group == number], target), value)
        for number, value in enumerate(values)
    ]


def _cut(corners: Float, count: int) -> Float:
    return _cut_to(corners, float(triangle_areas(corners).sum()) / count)


def _cut_to(corners: Float, area_m2: float) -> Float:
    """Triangles (n, 3, 3), cut until none is larger than 1.5 times the area.

    Across the longest edge and not in its middle: the middles of regular tiles lie in rows, and
    rows of bars before a lamp hide all of them or none.
    """
    while True:
        large = triangle_areas(corners) > ALONG_TOO * area_m2
        if not large.any():
            return corners
        corners = np.concatenate([corners[~large], _halves(corners[large])])


def _halves(corners: Float) -> Float:
    length = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    turned = (np.arange(3) + length.argmax(axis=1)[:, None]) % 3
    a, b, c = np.moveaxis(np.take_along_axis(corners, turned[..., None], axis=1), 1, 0)
    middle = a + UNEVEN * (b - a)
    return np.concatenate([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])


def _both_sides(parts: Sequence[Tiles]) -> list[Tiles]:
    sides: list[Tiles] = []
    for part in parts:
        lift = HALF_GAP_M * unit_normals(part.corners[:, :3])[:, None]
        sides.append(Tiles(part.corners + lift, part.luminance_cd_m2))
        sides.append(Tiles(part.corners[:, ::-1] - lift, part.luminance_cd_m2))
    return sides
