"""Area lamps of the furnished room, and the triangles as which Radiance is told of them."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.lamps import (
    AnyAreaLamp,
    DiskLamp,
    MeshLamp,
    PolygonLamp,
    Shadow,
    SphereLamp,
    TubeLamp,
)
from andon.lamps.solids import capsule, disk, icosphere, quarters
from andon.verify.rooms import lamps_in
from andon.verify.setting import room
from andon.verify.solids import box
from andon.verify.truths.sources import AreaSource

__all__ = ["room_area_lamps", "sources_of"]

Float = NDArray[np.float64]

# Where they shine to: the middle of the furniture.
TARGET_M = np.array([0.3, 0.6, -0.4])


@cache
def room_area_lamps(samples: int = 64) -> tuple[AnyAreaLamp, ...]:
    """A sphere, a disk, a rectangle, a tube and a mesh of 0.2 m in free air, each in its colour."""
    shadow = Shadow(map_size=512, samples=samples)
    places = [(lamp.position, lamp.intensity_rgb_cd) for lamp in lamps_in(room(), 5)]
    frames = [_frame(TARGET_M - position) for position, _ in places]
    keys: dict[str, Any] = {"shadow": shadow, "drawn": False}
    (a, b, c, d, e), (_, fb, fc, fd, fe) = [position for position, _ in places], frames
    light = [intensity / 0.03 for _, intensity in places]  # cd/m² of a lamp of 0.03 m²
    corners = np.array([(-0.1, -0.08), (0.1, -0.08), (0.1, 0.08), (-0.1, 0.08)])
    body = box((0.16, 0.1, 0.12))
    return (
        SphereLamp("sphere", light[0], a, 0.1, **keys),
        DiskLamp("disk", light[1], b, fb[2], 0.11, **keys),
        PolygonLamp("rectangle", light[2], c + corners @ fc[:2], **keys),
        TubeLamp("tube", light[3], np.stack([d - 0.1 * fd[0], d + 0.1 * fd[0]]), 0.03, **keys),
        MeshLamp("mesh", light[4], e + body.positions @ fe, body.triangles, **keys),
    )


def _frame(facing: Float) -> Float:
    """(3, 3) rows right, up, front: right-handed, front along `facing`."""
    front = facing / np.linalg.norm(facing)
    right = np.cross([0.0, 1.0, 0.0], front)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(front, right), front])


def sources_of(lamp: AnyAreaLamp, cuts: int, /) -> list[AreaSource]:
    """`lamp` as triangles of its own area, each cut in four so many more times.

    Radiance looks at the middle of each: a lamp of n triangles that are seen has n hard shadows.
    """
    if isinstance(lamp, SphereLamp):
        ball = icosphere(cuts + 1)
        corners = ball.positions[ball.triangles]
        corners = corners * np.sqrt(4 * np.pi / _area(corners)) * lamp.radius_m
        return [_source(corners + lamp.position_m, lamp)]
    if isinstance(lamp, TubeLamp):
        return [_source(_tube(lamp, 8 * 2**cuts), lamp)]
    if isinstance(lamp, DiskLamp):
        flat = disk(lamp.position_m, lamp.direction, lamp.radius_m, corners=24)
        corners = flat.positions[flat.triangles]
    elif isinstance(lamp, PolygonLamp):
        v = lamp.vertices_m
        corners = np.stack([v[[0, 1, 2]], v[[0, 2, 3]]])
        cuts += 2
    else:
        corners = lamp.positions_m[lamp.triangles]
        cuts += 1
    for _ in range(cuts):
        corners = quarters(corners)
    return [_source(corners, lamp)]


def _tube(lamp: TubeLamp, around: int) -> Float:
    """Triangles (n, 3, 3) of a capsule of the same area, `around` its girth, about as long."""
    pieces = max(
        1, round(around / 6 * float(np.linalg.norm(np.diff(lamp.ends_m, axis=0))) / lamp.radius_m)
    )
    whole = capsule(lamp.ends_m, lamp.radius_m, around=around, caps=max(2, around // 6))
    corners = whole.positions[whole.triangles]
    start, along = lamp.ends_m[0], lamp.ends_m[1] - lamp.ends_m[0]
    share = (corners - start) @ along / (along @ along)
    side = (share.min(axis=1) < 1e-9) & (share.max(axis=1) > 1 - 1e-9)
    # A triangle of the side runs from end to end: as many short ones instead.
    parts = [corners[~side]]
    for piece in range(pieces):
        at = start + (piece + share[side])[..., None] / pieces * along
        beside = corners[side] - (start + share[side][..., None] * along)
        parts.append(at + beside)
    found = np.concatenate(parts)
    length = float(np.linalg.norm(along))
    exact = 2 * np.pi * lamp.radius_m * (length + 2 * lamp.radius_m)
    axis = along / length
    middle = lamp.ends_m.mean(axis=0)
    level = ((found - middle) @ axis)[..., None] * axis
    # Thicker, not longer: as wide as the round one on the mean.
    return middle + level + (found - middle - level) * exact / _area(found)


def _area(corners: Float) -> float:
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return float(np.linalg.norm(across, axis=1).sum() / 2)


def _source(corners: Float, lamp: AnyAreaLamp) -> AreaSource:
    triangles = np.arange(3 * len(corners), dtype=np.int32).reshape(-1, 3)
    return AreaSource(corners.reshape(-1, 3), triangles, lamp.luminance_cd_m2)
