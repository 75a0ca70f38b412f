"""Host structs of the composite."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.composite.model import Ambient
from andon.gpu.layout import HostStruct

__all__ = ["AMBIENT_RECORD", "DISC_RECORD", "STRUCTS", "pack_ambient"]

AMBIENT_RECORD = HostStruct(
    "AmbientRecord",
    (
        ("dimming", "vec3f"),
        ("units_per_cd_m2", "f32"),
        ("inverse_lux", "vec3f"),  # 1/E0, where E0 is constant
        ("first_cell", "i32"),  # of the table of curves
        ("object_lux", "vec3f"),  # dimmed E0 that virtual objects stand in
    ),
)

DISC_RECORD = HostStruct(
    "DiscRecord",
    (
        ("direction", "vec3f"),  # from the camera, unit, world
        ("distance_m", "f32"),  # what is nearer hides it
        ("linear", "vec3f"),  # luminance in units of the picture
        ("radius_radians", "f32"),
    ),
)

STRUCTS = {struct.name: struct for struct in (AMBIENT_RECORD, DISC_RECORD)}


def pack_ambient(
    ambient: Ambient, luminance_per_unit: float, /, first_cell: int = 0
) -> NDArray[Any]:
    """One `AMBIENT_RECORD`; light is in the picture's linear units from here on."""
    constant = ambient.illuminance_lux.ndim == 1
    return AMBIENT_RECORD.pack(
        dimming=ambient.dimming,
        units_per_cd_m2=1 / luminance_per_unit,
        inverse_lux=1 / ambient.illuminance_lux if constant else np.zeros(3),
        first_cell=first_cell,
        object_lux=ambient.standing_lux,
    )
