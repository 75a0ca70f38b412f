"""All lamps, as one type."""

from __future__ import annotations

from andon.lamps.areas import DiskLamp, MeshLamp, PolygonLamp, SphereLamp, TubeLamp
from andon.lamps.model import DirectionalLamp, HemisphereLamp, PointLamp, SkyLamp, SpotLamp

__all__ = ["AnyAreaLamp", "Lamp"]

AnyAreaLamp = SphereLamp | DiskLamp | PolygonLamp | TubeLamp | MeshLamp
Lamp = PointLamp | SpotLamp | DirectionalLamp | SkyLamp | HemisphereLamp | AnyAreaLamp
