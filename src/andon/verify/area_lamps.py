"""Area lamps of the furnished room, and as how many tiles Radiance is told of them."""

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
from andon.verify.rooms import lamps_in
from andon.verify.setting import room
from andon.verify.solids import box

__all__ = ["room_area_lamps", "tiles_at"]

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


def tiles_at(cuts: int, /) -> int:
    """How many tiles Radiance is given of each lamp: four times as many with every cut.

    It looks at the middle of each: a lamp of n tiles that are seen has n hard shadows.
    """
    return 80 * 4**cuts
