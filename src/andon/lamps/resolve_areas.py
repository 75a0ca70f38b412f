"""From the area lamps and shells of a scene file to lamps and bodies."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.lamps.areas import DiskLamp, MeshLamp, PolygonLamp, SphereLamp, TubeLamp
from andon.lamps.bodies import Body
from andon.lamps.drawn import body_of
from andon.lamps.kinds import AnyAreaLamp, Lamp
from andon.lamps.model import PointLamp, Shadow
from andon.lamps.polygons import check_flat
from andon.lamps.resources import lamp_emitters, lamp_texture, shell_of
from andon.lamps.shells import expand
from andon.lamps.tables import colour_of, unit
from andon.lamps.triangles import triangle_areas

if TYPE_CHECKING:
    from andon.scene import Scene
    from andon.scene.lamp import (
        DiskTable,
        MeshTable,
        PolygonTable,
        RectangleTable,
        SphereTable,
        TubeTable,
    )
    from andon.scene.lamp_parts import Shell as ShellTable

    FlatTable = DiskTable | RectangleTable | PolygonTable
    AreaTable = FlatTable | SphereTable | TubeTable | MeshTable

__all__ = ["AREA_KINDS", "area_body", "area_lamp", "in_shell"]

Float = NDArray[np.float64]


def area_lamp(scene: Scene, place: str, table: Any, /) -> AnyAreaLamp:
    """The lamp of a table of an area kind; `place` is the table's name in messages."""
    try:
        return AREA_KINDS[table.kind](scene, place, table)
    except InputError as error:
        raise _placed(error, scene, place) from error


def area_body(scene: Scene, place: str, table: Any, lamp: AnyAreaLamp, /) -> Body:
    """What is seen of `lamp`, which `area_lamp` made of `table`."""
    try:
        body = body_of(lamp)
    except InputError as error:
        raise _placed(error, scene, place) from error
    if table.kind != "mesh":
        return body
    whole = lamp_emitters(scene, table.mesh, f"{place}.mesh").geometry
    positions = whole.positions + np.array(table.position)
    # Lit by few triangles, seen with all: the luminance is the one that belongs to all.
    seen = np.broadcast_to(_mesh_luminance(scene, place, table), positions.shape).copy()
    geometry = replace(whole, positions=positions)
    return Body(body.name, geometry, seen, np.zeros_like(seen))


def in_shell(
    scene: Scene, place: str, lamp: PointLamp, table: ShellTable, groups: frozenset[str], /
) -> tuple[tuple[Lamp, ...], Body]:
    """The lamps and the body of `lamp` in the shell of `table`."""
    try:
        return expand(lamp, shell_of(scene, table, f"{place}.shell"), groups=groups)
    except InputError as error:
        raise _placed(error, scene, place) from error


def _placed(error: InputError, scene: Scene, place: str) -> InputError:
    """The same error, with the scene's file and the lamp; what names a file already stays."""
    if error.file is not None:
        return error
    field = f"{place}.{error.field}" if error.field else place
    return InputError(error.rule, file=scene.file, field=field, remedy=error.remedy)


def _shadow(table: AreaTable) -> Shadow | None:
    if not table.shadow:
        return None
    kind = "linear" if table.shadow_filter == "exact" else table.shadow_filter
    return Shadow(table.shadow_map_size, kind, table.shadow_samples, frozenset({table.name}))


def _luminance(table: AreaTable, *, projected_m2: float, emitting_m2: float) -> Float:
    """(3,) cd/m²: I = L·A projected along the stated direction, Φ = π·L·A of all that emits."""
    if table.luminance_cd_m2 is not None:
        value = table.luminance_cd_m2
    elif table.intensity_cd is not None:
        value = table.intensity_cd / projected_m2
    else:
        value = (table.flux_lm or 0.0) / (np.pi * emitting_m2)
    return value * colour_of(table)


def _flat(table: FlatTable, area: float) -> Float:
    sides = 2 if table.two_sided else 1
    return _luminance(table, projected_m2=area, emitting_m2=sides * area)


def _sphere(scene: Scene, place: str, table: SphereTable) -> SphereLamp:
    disk = np.pi * table.radius_m**2
    return SphereLamp(
        table.name,
        _luminance(table, projected_m2=disk, emitting_m2=4 * disk),
        np.array(table.position),
        table.radius_m,
        shadow=_shadow(table),
        drawn=table.drawn,
    )


def _disk(scene: Scene, place: str, table: DiskTable) -> DiskLamp:
    return DiskLamp(
        table.name,
        _flat(table, np.pi * table.radius_m**2),
        np.array(table.position),
        unit(table.direction),
        table.radius_m,
        table.two_sided,
        shadow=_shadow(table),
        drawn=table.drawn,
    )


# Sine of the angle between a rectangle's normal and its up, below which up says nothing.
LEAST_SINE = 1e-6


def _rectangle(scene: Scene, place: str, table: RectangleTable) -> PolygonLamp:
    normal = unit(table.direction)
    right = np.cross(unit(table.up), normal)
    sine = np.linalg.norm(right)
    if sine < LEAST_SINE:
        raise InputError(
            "is parallel to direction: nothing says which way the height runs",
            field="up",
            remedy="state up across direction",
        )
    right /= sine
    across, along = table.width_m / 2 * right, table.height_m / 2 * np.cross(normal, right)
    corners = [-across - along, across - along, across + along, along - across]
    texture = None
    if table.texture is not None:
        texture = lamp_texture(scene, table.texture, f"{place}.texture")
    return PolygonLamp(
        table.name,
        _flat(table, table.width_m * table.height_m),
        np.array(table.position) + np.stack(corners),
        table.two_sided,
        texture,
        shadow=_shadow(table),
        drawn=table.drawn,
    )


def _polygon(scene: Scene, place: str, table: PolygonTable) -> PolygonLamp:
    vertices = np.array(table.vertices)
    area = check_flat(vertices)
    return PolygonLamp(
        table.name,
        _flat(table, area),
        vertices + np.array(table.position),
        table.two_sided,
        shadow=_shadow(table),
        drawn=table.drawn,
    )


def _tube(scene: Scene, place: str, table: TubeTable) -> TubeLamp:
    ends = np.array(table.ends)
    length, radius = float(np.linalg.norm(ends[1] - ends[0])), table.radius_m
    luminance = _luminance(
        table,
        projected_m2=2 * radius * length + np.pi * radius**2,
        emitting_m2=2 * np.pi * radius * length + 4 * np.pi * radius**2,
    )
    return TubeLamp(
        table.name,
        luminance,
        ends + np.array(table.position),
        radius,
        shadow=_shadow(table),
        drawn=table.drawn,
    )


def _mesh_luminance(scene: Scene, place: str, table: MeshTable) -> Float:
    area = lamp_emitters(scene, table.mesh, f"{place}.mesh").area_m2
    # The mean of I over all directions is Φ/4π, and Φ = π·L·A.
    return _luminance(table, projected_m2=area / 4, emitting_m2=area)


def _mesh(scene: Scene, place: str, table: MeshTable) -> MeshLamp:
    emitters = lamp_emitters(scene, table.mesh, f"{place}.mesh")
    # Few triangles stand for many: the flux stays, so their luminance makes up for their area.
    shining_m2 = triangle_areas(emitters.corners).sum()
    luminance = _mesh_luminance(scene, place, table) * emitters.area_m2 / shining_m2
    return MeshLamp(
        table.name,
        luminance,
        emitters.corners.reshape(-1, 3) + np.array(table.position),
        np.arange(3 * len(emitters.corners), dtype=np.int32).reshape(-1, 3),
        shadow=_shadow(table),
        drawn=table.drawn,
    )


AREA_KINDS: dict[str, Callable[[Scene, str, Any], AnyAreaLamp]] = {
    "sphere": _sphere,
    "disk": _disk,
    "rectangle": _rectangle,
    "tube": _tube,
    "polygon": _polygon,
    "mesh": _mesh,
}
