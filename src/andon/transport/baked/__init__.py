"""Baked light: illuminance maps of Radiance on the surfaces of a frame."""

from __future__ import annotations

from andon.transport.baked.model import BakedLight, BakedMoment, IlluminanceMap
from andon.transport.baked.reference import baked_illuminance, illuminance_at

__all__ = ["BakedLight", "BakedMoment", "IlluminanceMap", "baked_illuminance", "illuminance_at"]
