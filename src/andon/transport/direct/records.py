"""Host structs of direct light: lamps as the shaders see them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.gpu.layout import HostStruct
from andon.lamps import DirectionalLamp, HemisphereLamp, Lamp, PointLamp, SkyLamp, SpotLamp
from andon.lamps.distributions import spot_coefficients

__all__ = [
    "DIRECT_RECORD",
    "FACE_RECORD",
    "LAMP_RECORD",
    "MAX_LAMPS",
    "STRUCTS",
    "WIDE_SPOT_RADIANS",
    "PlanarFrame",
    "is_exact",
    "pack_lamps",
    "sorted_lamps",
]

# 64 records of 112 bytes fit WebGPU's smallest uniform buffer (65536 bytes) many times over; the
# limit is what shadow maps cost in memory: 8 MB for each shadowed point lamp at 1024².
MAX_LAMPS = 64

LAMP_RECORD = HostStruct(
    "LampRecord",
    (
        # point, spot: place in metres; directional: centre of the shadow map
        ("position", "vec3f"),
        ("shadow_layer", "i32"),  # −1: none
        # cd, or lux of directional and hemisphere (sky) lamps
        ("light", "vec3f"),
        ("cone_scale", "f32"),
        # spot, directional: where the light travels; hemisphere: up
        ("axis", "vec3f"),
        ("cone_offset", "f32"),
        # planar shadow maps: axes of the map; hemisphere: `right` is the ground's lux
        ("right", "vec3f"),
        ("half_width", "f32"),  # tangent of the half-angle, or metres
        ("down", "vec3f"),
        ("depth_range_m", "f32"),  # directional
    ),
)

DIRECT_RECORD = HostStruct(
    "DirectRecord",
    (
        # lamps in each group, in the order in which they stand
        ("points", "u32"),
        ("wide_spots", "u32"),
        ("spots", "u32"),
        ("directionals", "u32"),
        ("hemispheres", "u32"),
        # lift along the normal before a shadow is looked up
        ("bias_real_m", "f32"),
        ("bias_object_m", "f32"),
        ("near_m", "f32"),
    ),
)

FACE_RECORD = HostStruct("FaceRecord", (("position", "vec3f"), ("near_m", "f32")))

STRUCTS = {struct.name: struct for struct in (LAMP_RECORD, DIRECT_RECORD, FACE_RECORD)}

# A plane map of half-angle α is tan α wide: at 60° its middle has a quarter of the texels per
# radian that its rim has. Wider cones look into a paraboloid.
WIDE_SPOT_RADIANS = np.radians(60)


@dataclass(frozen=True)
class PlanarFrame:
    """Axes and extent of a planar shadow map.

    Attributes
    ----------
    centre : (3,) metres; the lamp, or for directional lamps the middle of what is lit.
    right, down, axis : (3,) orthonormal, `axis` where the light travels.
    half_width : tangent of the half-angle (spot) or metres (directional).
    depth_range_m : of a directional map: it covers ±depth_range/2 about the centre; 0 for spots.
    """

    centre: NDArray[np.float64]
    right: NDArray[np.float64]
    down: NDArray[np.float64]
    axis: NDArray[np.float64]
    half_width: float
    depth_range_m: float = 0.0


def is_exact(lamp: PointLamp, /) -> bool:
    """The lamp wants exact shadows, which only a paraboloid has."""
    return lamp.shadow is not None and lamp.shadow.filter == "exact"


def sorted_lamps(lamps: Sequence[Lamp], /) -> list[list[Lamp]]:
    """The lamps in five groups: point, wide spot, spot, directional, hemisphere (and sky).

    On a software rasteriser a branch costs both its sides, so the shader has one loop a group.
    Raises `InputError` for more than `MAX_LAMPS`.
    """
    if len(lamps) > MAX_LAMPS:
        raise InputError(
            f"{len(lamps)} lamps, at most {MAX_LAMPS} are rendered",
            field="lamp",
            remedy="leave lamps out, or bake some",
        )
    groups: list[list[Lamp]] = [[], [], [], [], []]
    for lamp in lamps:
        groups[_group(lamp)].append(lamp)
    return groups


def _group(lamp: Lamp) -> int:
    match lamp:
        case SpotLamp():
            return 1 if lamp.outer_radians > WIDE_SPOT_RADIANS or is_exact(lamp) else 2
        case PointLamp():
            return 0
        case DirectionalLamp():
            return 3
        case SkyLamp() | HemisphereLamp():
            return 4


def pack_lamps(
    groups: Sequence[Sequence[Lamp]],
    layers: dict[str, int],
    frames: dict[str, PlanarFrame],
    /,
) -> NDArray[Any]:
    """`LAMP_RECORD`s in the order of `groups`; `layers` and `frames` are keyed by lamp name."""
    records = [
        _pack(lamp, layers.get(lamp.name, -1), frames.get(lamp.name))
        for group in groups
        for lamp in group
    ]
    # Not np.concatenate: it drops the padding between fields.
    table = np.zeros(len(records), LAMP_RECORD.dtype)
    for row, record in enumerate(records):
        table[row] = record[0]
    return table


def _pack(lamp: Lamp, layer: int, frame: PlanarFrame | None) -> NDArray[Any]:
    values: dict[str, Any] = {"shadow_layer": layer}
    match lamp:
        case PointLamp():
            values |= {"position": lamp.position_m, "light": lamp.intensity_cd}
            if isinstance(lamp, SpotLamp):
                scale, offset = spot_coefficients(lamp.inner_radians, lamp.outer_radians)
                values |= {"axis": lamp.direction, "cone_scale": scale, "cone_offset": offset}
        case DirectionalLamp():
            values |= {"light": lamp.illuminance_lux, "axis": lamp.direction}
        case SkyLamp():
            values |= {"light": lamp.illuminance_lux, "axis": lamp.up}
        case HemisphereLamp():
            values |= {
                "light": lamp.sky_illuminance_lux,
                "axis": lamp.up,
                "right": lamp.ground_illuminance_lux,
            }
    if frame is not None:
        values |= {
            "right": frame.right,
            "down": frame.down,
            "half_width": frame.half_width,
            "depth_range_m": frame.depth_range_m,
        }
        if isinstance(lamp, DirectionalLamp):
            values["position"] = frame.centre
    return LAMP_RECORD.pack(**values)
