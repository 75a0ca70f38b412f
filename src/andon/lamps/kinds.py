"""All lamps, as one type."""

from __future__ import annotations

from andon.lamps.areas import DiskLamp, MeshLamp, PolygonLamp, SphereLamp, TubeLamp
from andon.lamps.model import (
    DirectionalLamp,
    GoniometricLamp,
    HemisphereLamp,
    PointLamp,
    SkyLamp,
    SpotLamp,
)

__all__ = ["AnyAreaLamp", "Lamp"]

AnyAreaLamp = SphereLamp | DiskLamp | PolygonLamp | TubeLamp | MeshLamp
PointLike = PointLamp | SpotLamp | GoniometricLamp
Lamp = PointLike | DirectionalLamp | SkyLamp | HemisphereLamp | AnyAreaLamp
