"""Host structs of direct light: lamps as the shaders see them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.gpu.layout import HostStruct
from andon.lamps import (
    DirectionalLamp,
    GoniometricLamp,
    HemisphereLamp,
    Lamp,
    PointLamp,
    SkyLamp,
    SpotLamp,
)
from andon.lamps.areas import AreaLamp, DiskLamp, MeshLamp, PolygonLamp, SphereLamp, TubeLamp
from andon.lamps.distributions import spot_coefficients
from andon.lamps.edges import polygon_edges
from andon.lamps.intensity import luminaire_from_world
from andon.transport.direct.balls.records import BALL_RECORD

__all__ = [
    "DIRECT_RECORD",
    "EDGE_RECORD",
    "FACE_RECORD",
    "LAMP_RECORD",
    "MAX_LAMPS",
    "SAMPLE_RECORD",
    "STRUCTS",
    "WIDE_SPOT_RADIANS",
    "PlanarFrame",
    "form_of",
    "is_exact",
    "pack_lamps",
]

# 64 records of 112 bytes fit WebGPU's smallest uniform buffer (65536 bytes) many times over; the
# limit is what shadow maps cost in memory: 8 MB for each shadowed point lamp at 1024².
MAX_LAMPS = 64

LAMP_RECORD = HostStruct(
    "LampRecord",
    (
        # place in metres; directional: centre of the shadow map; tube: one end
        ("position", "vec3f"),
        ("radius_m", "f32"),  # of area lamps; polygon: of a ball that holds it
        # cd, lux of directional and hemisphere (sky) lamps, cd/m² of area lamps
        ("light", "vec3f"),
        ("cone_scale", "f32"),
        # spot, directional: where the light travels; hemisphere: up; disk, polygon: normal
        ("axis", "vec3f"),
        ("cone_offset", "f32"),
        # planar shadow maps: axes of the map; luminaire: C = 0 and C = 90; hemisphere: `right` is
        # the ground's lux; tube: the other end
        ("right", "vec3f"),
        ("half_width", "f32"),  # tangent of the half-angle, or metres
        ("down", "vec3f"),
        ("depth_range_m", "f32"),  # directional
    ),
)

DIRECT_RECORD = HostStruct(
    "DirectRecord",
    (
        # lift along the normal before a shadow is looked up
        ("bias_real_m", "f32"),
        ("bias_object_m", "f32"),
        ("near_m", "f32"),
    ),
)

FACE_RECORD = HostStruct("FaceRecord", (("position", "vec3f"), ("near_m", "f32")))

# A point of an area lamp from which its shadow is looked at.
SAMPLE_RECORD = HostStruct(
    "SampleRecord",
    (
        ("point", "vec3f"),
        ("sides", "f32"),  # 0 no face, 1 one side, 2 both
        ("normal", "vec3f"),
        ("light", "vec3f"),
    ),
)

# An edge of a polygon or mesh lamp: what lies on either side of it emits if the receiver is in
# front of that side's plane.
EDGE_RECORD = HostStruct(
    "EdgeRecord",
    (
        ("start", "vec3f"),
        ("end", "vec3f"),
        ("left_plane", "vec4f"),
        ("right_plane", "vec4f"),
        ("left_light", "vec3f"),
        ("right_light", "vec3f"),
    ),
)

STRUCTS = {
    struct.name: struct
    for struct in (LAMP_RECORD, DIRECT_RECORD, FACE_RECORD, SAMPLE_RECORD, EDGE_RECORD, BALL_RECORD)
}

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


def form_of(lamp: Lamp, /) -> str:
    """Which function of the shaders has this lamp's light: ``<form>_illuminance``."""
    match lamp:
        case SpotLamp():
            wide = lamp.outer_radians > WIDE_SPOT_RADIANS or is_exact(lamp)
            return "wide_spot" if wide else "spot"
        case GoniometricLamp():
            return "goniometric"
        case PointLamp():
            return "point"
        case DirectionalLamp():
            return "directional"
        case SkyLamp() | HemisphereLamp():
            return "hemisphere"
        case SphereLamp():
            return "sphere"
        case DiskLamp():
            return "disk_both_sides" if lamp.two_sided else "disk"
        case TubeLamp():
            return "tube"
        case PolygonLamp() if lamp.texture is None:
            return "polygon_both_sides" if lamp.two_sided else "polygon"
        case PolygonLamp() | MeshLamp():
            return "edges"


def pack_lamps(lamps: Sequence[Lamp], frames: Mapping[str, PlanarFrame], /) -> NDArray[Any]:
    """`LAMP_RECORD`s in the order of `lamps`; `frames` are keyed by lamp name.

    Raises `InputError` for more than `MAX_LAMPS`.
    """
    if len(lamps) > MAX_LAMPS:
        raise InputError(
            f"{len(lamps)} lamps, at most {MAX_LAMPS} are rendered",
            field="lamp",
            remedy="leave lamps out, or bake some",
        )
    # Not np.concatenate: it drops the padding between fields.
    table = np.zeros(len(lamps), LAMP_RECORD.dtype)
    for row, lamp in enumerate(lamps):
        table[row] = _pack(lamp, frames.get(lamp.name))[0]
    return table


def _pack(lamp: Lamp, frame: PlanarFrame | None) -> NDArray[Any]:
    values = _light(lamp)
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


def _light(lamp: Lamp) -> dict[str, Any]:
    match lamp:
        case SpotLamp():
            scale, offset = spot_coefficients(lamp.inner_radians, lamp.outer_radians)
            cone = {"axis": lamp.direction, "cone_scale": scale, "cone_offset": offset}
            return {"position": lamp.position_m, "light": lamp.intensity_cd, **cone}
        case GoniometricLamp():
            right, _, up = luminaire_from_world(lamp)
            axes = {"axis": -up, "right": right, "down": np.cross(right, -up)}
            return {"position": lamp.position_m, "light": lamp.intensity_cd, **axes}
        case PointLamp():
            return {"position": lamp.position_m, "light": lamp.intensity_cd}
        case DirectionalLamp():
            return {"light": lamp.illuminance_lux, "axis": lamp.direction}
        case SkyLamp():
            return {"light": lamp.illuminance_lux, "axis": lamp.up}
        case HemisphereLamp():
            ground = lamp.ground_illuminance_lux
            return {"light": lamp.sky_illuminance_lux, "axis": lamp.up, "right": ground}
        case _:
            return _area(lamp)


def _area(lamp: AreaLamp) -> dict[str, Any]:
    light = {"light": lamp.luminance_cd_m2}
    match lamp:
        case SphereLamp():
            return light | {"position": lamp.position_m, "radius_m": lamp.radius_m}
        case DiskLamp():
            place = {"position": lamp.position_m, "radius_m": lamp.radius_m}
            return light | place | {"axis": lamp.direction}
        case TubeLamp():
            start, end = lamp.ends_m
            return light | {"position": start, "right": end, "radius_m": lamp.radius_m}
        case PolygonLamp():
            centre = lamp.vertices_m.mean(axis=0)
            radius = np.linalg.norm(lamp.vertices_m - centre, axis=1).max()
            normal = polygon_edges(lamp).left_plane[0, :3]
            return light | {"position": centre, "radius_m": radius, "axis": normal}
        case MeshLamp():
            return light | {"position": lamp.positions_m.mean(axis=0)}
        case _:
            raise TypeError(f"{type(lamp).__name__} has no area")
