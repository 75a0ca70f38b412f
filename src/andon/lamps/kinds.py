"""All lamps, as one type."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.lamps.areas import DiskLamp, MeshLamp, PolygonLamp, SphereLamp, TubeLamp
from andon.lamps.model import (
    DirectionalLamp,
    GoniometricLamp,
    HemisphereLamp,
    PointLamp,
    SkyLamp,
    SpotLamp,
)

__all__ = ["AnyAreaLamp", "Lamp", "middle_of_area"]

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
