"""From the lamps of a scene file to lamps as physics wants them, for one moment."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.cached import read_cached
from andon.files.photometry import read_photometry
from andon.lamps.areas import SOFT_SHADOW
from andon.lamps.bodies import Body
from andon.lamps.colour import factors_from_rgb
from andon.lamps.distributions import (
    POINT_SOLID_ANGLE_SR,
    intensity_cd_from_flux,
    spot_solid_angle_sr,
)
from andon.lamps.flickering import flicker_factor
from andon.lamps.goniometry import flux_lm, maximum_cd, tilt_factor
from andon.lamps.imported import imported_lamps
from andon.lamps.kinds import AnyAreaLamp, Lamp, brightened
from andon.lamps.model import (
    LIGHT_FIELDS,
    DirectionalLamp,
    GoniometricLamp,
    HemisphereLamp,
    PointLamp,
    Shadow,
    SkyLamp,
    SpotLamp,
)
from andon.lamps.resolve_areas import AREA_KINDS, area_body, area_lamp, in_shell
from andon.lamps.tables import colour_of, unit

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
    from andon.scene.lamp_base import Shadowing

__all__ = ["resolve_bodies", "resolve_lamps", "resolve_tables"]

Float = NDArray[np.float64]

# What can overflow: a huge flux in a narrow cone, or a colour far from white. Half of what float32
# holds in decades is left for what distances make of it.
MOST_LIGHT = 1e20


def resolve_lamps(scene: Scene, time_seconds: float) -> tuple[Lamp, ...]:
    """The lamps of a scene at one moment, in the order of the file; then those of glTF files.

    A lamp in a shell is several: see `andon.lamps.shells`. Raises `InputError` for what the
    schema has and this version does not render.
    """
    lamps = resolve_tables(scene, time_seconds)
    return (*lamps, *imported_lamps(scene, [lamp.name for lamp in lamps]))


def resolve_tables(scene: Scene, time_seconds: float, where: str = "lamp") -> tuple[Lamp, ...]:
    """The lamps of the scene's own tables; `where` these stand in the file, for messages."""
    resolved: list[Lamp] = []
    for place, table, groups in _tables(scene, time_seconds, where):
        with np.errstate(over="ignore"):  # what overflows is refused below
            if table.kind in AREA_KINDS:
                lamps: tuple[Lamp, ...] = (area_lamp(scene, place, table),)
            else:
                lamps = (_lamp(scene, place, table),)
            if isinstance(lamps[0], PointLamp) and table.shell is not None:
                lamps, _ = in_shell(scene, place, lamps[0], table.shell, groups)
            share = flicker_factor(scene, place, table, time_seconds)
            if share != 1:
                lamps = tuple(brightened(lamp, share) for lamp in lamps)
        for lamp in lamps:
            light = [getattr(lamp, key, None) for key in LIGHT_FIELDS]
            if not all(
                (np.abs(values) < MOST_LIGHT).all() for values in light if values is not None
            ):
                raise InputError("is too large to compute with", file=scene.file, field=place)
        resolved += [_owned(lamp, table.name) for lamp in lamps]
    _check_names(scene, resolved)
    return tuple(resolved)


def _owned(lamp: Lamp, name: str) -> Lamp:
    """The lamp as part of the scene's lamp `name`."""
    if not isinstance(lamp, AnyAreaLamp):
        return replace(lamp, owner=name)
    shadow = lamp.shadow and replace(lamp.shadow, near_m=SOFT_SHADOW.near_m)
    # A bulb lights the shell that it stands in from inside; all else is that shell's own light.
    body = "" if lamp.name == f"{name}: bulb" else name
    return replace(lamp, owner=name, body=body, shadow=shadow)


def resolve_bodies(scene: Scene, time_seconds: float) -> tuple[Body, ...]:
    """What is seen of the lamps of a scene at one moment: shells and drawn areas.

    In the order of the file, without those that are not drawn. Raises `InputError` as
    `resolve_lamps` does.
    """
    bodies: list[Body] = []
    for place, table, groups in _tables(scene, time_seconds, "lamp"):
        share = flicker_factor(scene, place, table, time_seconds)
        if table.kind in AREA_KINDS and table.drawn:
            lamp = area_lamp(scene, place, table)
            bodies.append(area_body(scene, place, table, lamp).brightened(share))
        elif getattr(table, "shell", None) is not None:
            lamp = cast(PointLamp, _lamp(scene, place, table))
            body = in_shell(scene, place, lamp, table.shell, groups)[1]
            bodies.append(body.brightened(share))
    return tuple(bodies)


def _lamp(scene: Scene, place: str, table: Any) -> Lamp:
    if table.kind == "ies":
        return _luminaire(scene, place, table)
    return _BUILDERS[table.kind](table)


# Caster groups that are not bodies; see `Shadow.through`.
GROUPS = ("real", "objects")


def _tables(
    scene: Scene, time_seconds: float, where: str
) -> Iterator[tuple[str, Any, frozenset[str]]]:
    """Place, table and the caster groups of all bodies, for every lamp at one moment."""
    tables = scene.at(time_seconds).lamp
    groups = frozenset(table.name for table in tables)
    for index, table in enumerate(tables):
        place = f"{where}[{index}]"
        _refuse_later(scene, place, table)
        _check_real_shell(scene, place, table)
        has_body = table.kind in AREA_KINDS or getattr(table, "shell", None) is not None
        if has_body and table.name in GROUPS:
            raise InputError(
                f"{table.name!r} already names what is not a lamp",
                file=scene.file,
                field=f"{place}.name",
                remedy="choose another name",
            )
        yield place, table, groups


def _check_names(scene: Scene, lamps: list[Lamp]) -> None:
    """Lamps of a shell are named after it, which a file may have done before."""
    counts = Counter(lamp.name for lamp in lamps)
    twice = next((name for name, count in counts.items() if count > 1), None)
    if twice is not None:
        raise InputError(
            f"the name {twice!r} is taken by a part of another lamp's shell",
            file=scene.file,
            field="lamp",
            remedy="choose another name",
        )


def _refuse_later(scene: Scene, place: str, table: AnyLamp) -> None:
    """Raise `InputError` if the lamp is of a kind, or has a key, that is not rendered yet."""
    if table.flicker is not None and place.startswith("ambient."):
        raise InputError(
            "is of light that a photograph holds still",
            file=scene.file,
            field=f"{place}.flicker",
            remedy="leave it out",
        )
    faults = {key: remedy for key, remedy in _LATER.items() if getattr(table, key, None)}
    if table.transport != "direct" and place.startswith("ambient."):
        faults["transport"] = "leave it out: the photograph has its light already"
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


def _check_real_shell(scene: Scene, place: str, table: AnyLamp) -> None:
    """Raise `InputError` for a real shell where none can be seen, or whose light is not direct."""
    shell = getattr(table, "shell", None)
    if shell is None or not shell.real:
        return
    if place.startswith("ambient."):
        fault = "is of a lamp of the photograph's own light", "leave it out"
    elif not scene.has_photograph:
        fault = "is part of a photograph, and there is none", "leave it out, or add [capture]"
    elif table.transport != "direct":
        fault = f"and transport {table.transport!r} exclude each other", "use transport = 'direct'"
    else:
        return
    raise InputError(fault[0], file=scene.file, field=f"{place}.shell.real", remedy=fault[1])


# Keys whose meaning would be lost if they were ignored.
_LATER = {
    "angular_diameter_degrees": "use 0, a point at infinity",
}


def _shadow(table: Shadowing) -> Shadow | None:
    return Shadow(table.shadow_map_size, table.shadow_filter) if table.shadow else None


def _intensity(table: PointTable | SpotTable, solid_angle_sr: float) -> Float:
    intensity_cd = table.intensity_cd
    if intensity_cd is None:
        intensity_cd = intensity_cd_from_flux(table.flux_lm or 0.0, solid_angle_sr)
    return intensity_cd * colour_of(table)


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
        unit(table.direction),
        float(inner),
        float(outer),
    )


def _luminaire(scene: Scene, place: str, table: IesTable) -> GoniometricLamp:
    distribution = read_cached(read_photometry, scene.path(table.file, f"{place}.file"))
    direction = unit(table.direction)
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
        peak * colour_of(table),
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


def _directional(table: DirectionalTable) -> DirectionalLamp:
    lux = (table.illuminance_lux or 0.0) * colour_of(table)
    return DirectionalLamp(table.name, unit(table.direction), lux, _shadow(table))


def _sky(table: SkyTable) -> SkyLamp:
    return SkyLamp(table.name, unit(table.up), (table.illuminance_lux or 0.0) * colour_of(table))


def _hemisphere(table: HemisphereTable) -> HemisphereLamp:
    sky = colour_of(table)
    ground = sky if table.ground_rgb is None else factors_from_rgb(np.array(table.ground_rgb))
    return HemisphereLamp(
        table.name,
        unit(table.up),
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
