"""Lamps as physics wants them: triples in photometric units, unit directions, radians."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.lamps.colour import factors_from_rgb, rgb_factors
from andon.lamps.distributions import (
    POINT_SOLID_ANGLE_SR,
    intensity_cd_from_flux,
    spot_solid_angle_sr,
)

if TYPE_CHECKING:  # scene imports pydantic; lamps built in Python do not need it
    from andon.scene import Scene
    from andon.scene.lamp import DirectionalTable, HemisphereTable, PointTable, SkyTable, SpotTable
    from andon.scene.lamp_base import LampTable, Shadowing

__all__ = [
    "DirectionalLamp",
    "HemisphereLamp",
    "Lamp",
    "PointLamp",
    "Shadow",
    "SkyLamp",
    "SpotLamp",
    "resolve_lamps",
]

Float = NDArray[np.float64]


@dataclass(frozen=True)
class Shadow:
    """How a lamp's shadow is computed.

    Attributes
    ----------
    map_size : texels along a side of the shadow map, 16…8192.
    filter : ``none`` hard, ``linear`` 2×2, ``pcf`` wider average.
    """

    map_size: int = 1024
    filter: Literal["none", "linear", "pcf"] = "pcf"


@dataclass(frozen=True)
class PointLamp:
    """Shines equally to all sides: E = I·max(0, cos φ)/d².

    Attributes
    ----------
    name : unique in the scene.
    position_m : (3,) metres, world.
    intensity_cd : (3,) cd per channel.
    shadow : None for a lamp that casts none.
    visible_radius_m : radius of the ball that is drawn, metres; 0: not drawn.
    """

    name: str
    position_m: Float
    intensity_cd: Float
    shadow: Shadow | None = field(default_factory=Shadow)
    visible_radius_m: float = 0.0


@dataclass(frozen=True)
class SpotLamp(PointLamp):
    """A cone with glTF's soft edge.

    Attributes
    ----------
    intensity_cd : (3,) cd per channel *on the axis*.
    direction : (3,) unit, where the axis points.
    inner_radians, outer_radians : half-angles, 0 ≤ inner < outer ≤ π/2.
    """

    direction: Float = field(default_factory=lambda: np.array([0.0, -1.0, 0.0]))
    inner_radians: float = 0.0
    outer_radians: float = np.pi / 4


@dataclass(frozen=True)
class DirectionalLamp:
    """Parallel light.

    Attributes
    ----------
    name : unique in the scene.
    direction : (3,) unit, where the light *travels*.
    illuminance_lux : (3,) lx per channel on a surface that faces the light.
    shadow : None for a lamp that casts none.
    """

    name: str
    direction: Float
    illuminance_lux: Float
    shadow: Shadow | None = field(default_factory=Shadow)


@dataclass(frozen=True)
class SkyLamp:
    """A sky of equal luminance above the horizon: E(n) = E_up·(1 + n·up)/2. No shadow.

    Attributes
    ----------
    name : unique in the scene.
    up : (3,) unit, the zenith.
    illuminance_lux : (3,) lx per channel on a surface that faces the zenith.
    """

    name: str
    up: Float
    illuminance_lux: Float


@dataclass(frozen=True)
class HemisphereLamp:
    """A sky and a ground of equal luminances:
    E(n) = E_sky·(1 + n·up)/2 + E_ground·(1 − n·up)/2. No shadow.

    Attributes
    ----------
    name : unique in the scene.
    up : (3,) unit, the zenith.
    sky_illuminance_lux : (3,) lx per channel from the sky on a surface that faces up.
    ground_illuminance_lux : (3,) lx per channel from the ground on a surface that faces down.
    """

    name: str
    up: Float
    sky_illuminance_lux: Float
    ground_illuminance_lux: Float


Lamp = PointLamp | SpotLamp | DirectionalLamp | SkyLamp | HemisphereLamp


def resolve_lamps(scene: Scene, time_seconds: float) -> tuple[Lamp, ...]:
    """The lamps of a scene at one moment, in the order of the file.

    Raises `InputError` for what the schema has and this version does not render: an area lamp is
    never silently replaced by a point. Lamps with transport ``baked`` are left out: their light
    is in the maps.
    """
    lamps: list[Lamp] = []
    for index, table in enumerate(scene.at(time_seconds).lamp):
        place = f"lamp[{index}]"
        build = _BUILDERS.get(table.kind)
        if build is None:
            raise _not_rendered(
                scene, f"{place}.kind", f"kind {table.kind!r}", _INSTEAD[table.kind]
            )
        for key, remedy in _LATER.items():
            if getattr(table, key, None):
                raise _not_rendered(scene, f"{place}.{key}", key, remedy)
        if table.transport == "baked":
            continue
        lamps.append(build(table))
    return tuple(lamps)


_POINT_INSTEAD = "use kind 'point' with the same flux_lm and a visible_radius_m"
_FLAT_INSTEAD = "use kind 'spot' with outer_degrees = 90"
_INSTEAD = {
    "ies": "use kind 'spot'",
    "sphere": _POINT_INSTEAD,
    "disk": _FLAT_INSTEAD,
    "rectangle": _FLAT_INSTEAD,
    "tube": _POINT_INSTEAD,
    "polygon": _FLAT_INSTEAD,
    "mesh": _POINT_INSTEAD,
}
# Keys whose meaning would be lost if they were ignored.
_LATER = {
    "shell": "use transmittance × intensity_cd, and the shell's radius as visible_radius_m",
    "flicker": "use [[lamp.key]]",
    "angular_diameter_degrees": "use 0, a point at infinity",
}


def _not_rendered(scene: Scene, field: str, what: str, remedy: str) -> InputError:
    rule = f"{what} is in the schema but not rendered yet"
    return InputError(rule, file=scene.file, field=field, remedy=remedy)


def _unit(direction: tuple[float, float, float]) -> Float:
    vector = np.array(direction, dtype=np.float64)
    vector /= np.abs(vector).max()  # first, so that squares neither overflow nor vanish
    return vector / np.linalg.norm(vector)


def _colour(table: LampTable) -> Float:
    return rgb_factors(
        chromaticity_xy=table.chromaticity_xy, temperature_k=table.temperature_k, rgb=table.rgb
    )


def _shadow(table: Shadowing) -> Shadow | None:
    return Shadow(table.shadow_map_size, table.shadow_filter) if table.shadow else None


def _intensity(table: PointTable | SpotTable, solid_angle_sr: float) -> Float:
    intensity_cd = table.intensity_cd
    if intensity_cd is None:
        intensity_cd = intensity_cd_from_flux(table.flux_lm or 0.0, solid_angle_sr)
    return intensity_cd * _colour(table)


def _point(table: PointTable) -> PointLamp:
    return PointLamp(
        table.name,
        np.array(table.position),
        _intensity(table, POINT_SOLID_ANGLE_SR),
        _shadow(table),
        table.visible_radius_m,
    )


def _spot(table: SpotTable) -> SpotLamp:
    inner, outer = np.radians(table.inner_degrees), np.radians(table.outer_degrees)
    return SpotLamp(
        table.name,
        np.array(table.position),
        _intensity(table, spot_solid_angle_sr(inner, outer)),
        _shadow(table),
        table.visible_radius_m,
        _unit(table.direction),
        float(inner),
        float(outer),
    )


def _directional(table: DirectionalTable) -> DirectionalLamp:
    lux = (table.illuminance_lux or 0.0) * _colour(table)
    return DirectionalLamp(table.name, _unit(table.direction), lux, _shadow(table))


def _sky(table: SkyTable) -> SkyLamp:
    return SkyLamp(table.name, _unit(table.up), (table.illuminance_lux or 0.0) * _colour(table))


def _hemisphere(table: HemisphereTable) -> HemisphereLamp:
    sky = _colour(table)
    ground = sky if table.ground_rgb is None else factors_from_rgb(np.array(table.ground_rgb))
    return HemisphereLamp(
        table.name,
        _unit(table.up),
        (table.illuminance_lux or 0.0) * sky,
        table.ground_illuminance_lux * ground,
    )


_BUILDERS: dict[str, Callable[[Any], Lamp]] = {
    "point": _point,
    "spot": _spot,
    "directional": _directional,
    "sky": _sky,
    "hemisphere": _hemisphere,
}
