"""All lamps, as one type."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.lamps.areas import DiskLamp, MeshLamp, PolygonLamp, SphereLamp, TubeLamp
from andon.lamps.model import (
    LIGHT_FIELDS,
    DirectionalLamp,
    GoniometricLamp,
    HemisphereLamp,
    PointLamp,
    SkyLamp,
    SpotLamp,
)

__all__ = ["AnyAreaLamp", "Lamp", "brightened", "middle_of_area"]

AnyAreaLamp = SphereLamp | DiskLamp | PolygonLamp | TubeLamp | MeshLamp
PointLike = PointLamp | SpotLamp | GoniometricLamp
Lamp = PointLike | DirectionalLamp | SkyLamp | HemisphereLamp | AnyAreaLamp


def middle_of_area(lamp: AnyAreaLamp, /) -> NDArray[np.float64]:
    """(3,) metres, the middle of what emits; of a mesh the mean of its corners."""
    match lamp:
        case SphereLamp() | DiskLamp():
            return lamp.position_m
        case TubeLamp():
            return lamp.ends_m.mean(axis=0)
        case PolygonLamp():
            return lamp.vertices_m.mean(axis=0)
        case MeshLamp():
            return lamp.positions_m.mean(axis=0)


def brightened(lamp: Lamp, factor: NDArray[np.float64] | float, /, **changes: Any) -> Lamp:
    """`lamp` with `factor` (3,) or a number times its light, and with other `changes`."""
    for key in LIGHT_FIELDS:
        light = getattr(lamp, key, None)
        if light is not None:
            changes[key] = light * factor
    return replace(lamp, **changes)
