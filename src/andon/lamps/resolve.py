"""From the lamps of a scene file to lamps as physics wants them, for one moment."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.photometry import Distribution, read_photometry
from andon.lamps.colour import factors_from_rgb, rgb_factors
from andon.lamps.distributions import (
    POINT_SOLID_ANGLE_SR,
    intensity_cd_from_flux,
    spot_solid_angle_sr,
)
from andon.lamps.goniometry import flux_lm, maximum_cd, tilt_factor
from andon.lamps.imported import imported_lamps
from andon.lamps.model import (
    DirectionalLamp,
    GoniometricLamp,
    HemisphereLamp,
    Lamp,
    PointLamp,
    Shadow,
    SkyLamp,
    SpotLamp,
)

if TYPE_CHECKING:  # scene imports pydantic; lamps built in Python do not need it
    from andon.scene import Scene
    from andon.scene.lamp import (
        AnyLamp,
        DirectionalTable,
        HemisphereTable,
        IesTable,
        PointTable,
        SkyTable,
        SpotTable,
    )
    from andon.scene.lamp_base import LampTable, Shadowing

__all__ = ["resolve_lamps"]

Float = NDArray[np.float64]


def resolve_lamps(scene: Scene, time_seconds: float) -> tuple[Lamp, ...]:
    """The lamps of a scene at one moment, in the order of the file; then those of glTF files.

    Raises `InputError` for what the schema has and this version does not render: an area lamp is
    never silently replaced by a point.
    """
    resolved: list[Lamp] = []
    for index, table in enumerate(scene.at(time_seconds).lamp):
        place = f"lamp[{index}]"
        _refuse_later(scene, place, table)
        with np.errstate(over="ignore"):  # what overflows is refused below
            lamp = (
                _luminaire(scene, place, table)
                if table.kind == "ies"
                else _BUILDERS[table.kind](table)
            )
        light = [getattr(lamp, key, 0.0) for key in _LIGHT]
        if not all(np.isfinite(values).all() for values in light):
            raise InputError("is too large to compute with", file=scene.file, field=place)
        resolved.append(lamp)
    return (*resolved, *imported_lamps(scene, [lamp.name for lamp in resolved]))


def _refuse_later(scene: Scene, place: str, table: AnyLamp) -> None:
    """Raise `InputError` if the lamp is of a kind, or has a key, that is not rendered yet."""
    faults = {"kind": _INSTEAD.get(table.kind)}
    faults |= {key: remedy for key, remedy in _LATER.items() if getattr(table, key, None)}
    if table.transport != "direct":
        faults["transport"] = "use 'direct'"
    for key, remedy in faults.items():
        if remedy:
            value = getattr(table, key)
            what = f"{key} {value!r}" if isinstance(value, str) else key
            raise InputError(
                f"{what} is in the schema but not rendered yet",
                file=scene.file,
                field=f"{place}.{key}",
                remedy=remedy,
            )


_POINT_INSTEAD = "use kind 'point' with the same flux_lm and a visible_radius_m"
_FLAT_INSTEAD = "use kind 'spot' with outer_degrees = 90"
_INSTEAD = {
    "sphere": _POINT_INSTEAD,
    "disk": _FLAT_INSTEAD,
    "rectangle": _FLAT_INSTEAD,
    "tube": _POINT_INSTEAD,
    "polygon": _FLAT_INSTEAD,
    "mesh": _POINT_INSTEAD,
}
# What can overflow: a huge flux in a narrow cone, or a colour far from white.
_LIGHT = (
    "intensity_cd",
    "illuminance_lux",
    "sky_illuminance_lux",
    "ground_illuminance_lux",
)
# Keys whose meaning would be lost if they were ignored.
_LATER = {
    "shell": "use transmittance × intensity_cd, and the shell's radius as visible_radius_m",
    "flicker": "use [[lamp.key]]",
    "angular_diameter_degrees": "use 0, a point at infinity",
}


def _unit(direction: tuple[float, float, float]) -> Float:
    vector = np.array(direction, dtype=np.float64)
    vector /= np.abs(vector).max()  # first, so that squares neither overflow nor vanish
    return vector / np.linalg.norm(vector)


def _colour(table: LampTable) -> Float:
    return rgb_factors(
        chromaticity_xy=table.chromaticity_xy,
        temperature_k=table.temperature_k,
        daylight=table.daylight,
        rgb=table.rgb,
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


def _luminaire(scene: Scene, place: str, table: IesTable) -> GoniometricLamp:
    distribution = _read(scene.path(table.file, f"{place}.file"))
    direction = _unit(table.direction)
    peak = table.intensity_cd
    if peak is None and table.flux_lm is not None:
        peak = table.flux_lm / flux_lm(distribution) * maximum_cd(distribution)
    if peak is None:
        # What is stated is stated of the lamp as it hangs; only the file's own light can droop.
        tilt = float(np.degrees(np.arccos(np.clip(-direction[1], -1, 1))))
        peak = maximum_cd(distribution) * tilt_factor(distribution, tilt)
    return GoniometricLamp(
        table.name,
        np.array(table.position),
        peak * _colour(table),
        _shadow(table),
        table.visible_radius_m,
        direction=direction,
        right=_right(direction, float(np.radians(table.roll_degrees))),
        distribution=distribution,
    )


def _right(direction: Float, roll_radians: float) -> Float:
    """Where C = 0 points: +X for a luminaire that looks down, turned with it the shortest way.

    That is how a luminaire is tilted by hand, and it is continuous but for one that looks straight
    up (+X there). The roll then turns the planes as C grows: by 90° C = 0 comes to where C = 90
    was, counter-clockwise seen against `direction`.
    """
    x, y, z = direction
    planar = x * x + z * z
    if y > 0 and planar < 1e-24:
        right = np.array([1.0, 0.0, 0.0])
    else:
        below_zenith = planar / (1 + y) if y > 0 else 1 - y  # 1 − y without losing digits
        right = np.array([1 - x * x / below_zenith, x, -x * z / below_zenith])
    side = np.cross(right, direction)
    return np.cos(roll_radians) * right + np.sin(roll_radians) * side


def _read(path: Path) -> Distribution:
    """The file's distribution; read again only when it changed, not for each frame."""
    try:
        state = path.stat()
    except OSError:
        return read_photometry(path)  # says what is wrong
    return _read_once(path, state.st_mtime_ns, state.st_size)


@lru_cache(maxsize=64)
def _read_once(path: Path, _modified: int, _bytes: int) -> Distribution:
    return read_photometry(path)


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
