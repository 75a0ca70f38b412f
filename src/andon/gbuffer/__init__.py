"""How a view and a surface lie on the GPU: shared by every stage that reads them.

Sixteen bytes a pixel, one read: depth as float32, the normal in two 16-bit numbers, reflectance
in three bytes, flags. Positions are not stored but made again from depth and the view, which is
cheaper than reading them and exact.
"""

from __future__ import annotations

from andon.gbuffer.records import (
    BODY_LIGHT,
    BODY_SHIFT,
    MAX_BODIES,
    NEAR_M,
    OBJECT,
    STRUCTS,
    VALID,
    VERTEX,
    VIEW_RECORD,
    pack_surface,
    pack_view,
    projection_variant,
    unpack_surface,
)

__all__ = [
    "BODY_LIGHT",
    "BODY_SHIFT",
    "MAX_BODIES",
    "NEAR_M",
    "OBJECT",
    "STRUCTS",
    "VALID",
    "VERTEX",
    "VIEW_RECORD",
    "pack_surface",
    "pack_view",
    "projection_variant",
    "unpack_surface",
]
