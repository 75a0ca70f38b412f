"""Refuses lamps that cannot light what there is."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.lamps import AreaLamp, Lamp, PointLamp
from andon.quantities import Geometry
from andon.scene import Scene
from andon.surface.inside import is_buried
from andon.surface.model import SurfaceModel

__all__ = ["check_lamps"]


def check_lamps(
    scene: Scene, lamps: tuple[Lamp, ...], surface: SurfaceModel, eye: NDArray[np.float64]
) -> None:
    """Refuses lamps that cannot light this surface."""
    is_mesh = scene.surface is not None and scene.surface.mesh is not None
    walls = surface.real if scene.has_photograph else _first_object(surface)
    # A lamp stands inside its shade, which is one of these walls.
    shaded = {table.name for table in scene.lamp if _has_real_shell(table)}
    for lamp in lamps:
        if not isinstance(lamp, PointLamp | AreaLamp):
            continue
        if surface.is_distant_only:
            raise InputError(
                f"the lamp {lamp.name!r} has a place, but a normals-only surface has none",
                file=scene.file,
                field=f"{_place(scene, lamp)}.kind",
                remedy="use directional, sky or hemisphere, or give a depth or a mesh",
            )
        # Areas may be let into a wall; points may not.
        may_be_buried = is_mesh and lamp.owner not in shaded
        if may_be_buried and isinstance(lamp, PointLamp) and is_buried(lamp.position_m, eye, walls):
            x, y, z = lamp.position_m
            raise InputError(
                f"the lamp {lamp.name!r} at ({x:g}, {y:g}, {z:g}) is inside a wall",
                file=scene.file,
                field=f"{_place(scene, lamp)}.position",
                remedy="move it into the space that the camera sees",
            )


def _has_real_shell(table: Any) -> bool:
    shell = getattr(table, "shell", None)
    return shell is not None and shell.real


def _first_object(surface: SurfaceModel) -> Geometry:
    """Without a photograph, the mesh is the first of the objects."""
    objects = surface.objects
    count = surface.objects_table[0].triangles if surface.objects_table else 0
    return Geometry(objects.positions, objects.triangles[:count])


def _place(scene: Scene, lamp: Lamp) -> str:
    """Where the scene file states the lamp that `lamp` is, or is a part of."""
    sources = scene.ambient.source if scene.ambient else ()
    for where, tables in (("lamp", scene.lamp), ("ambient.source", sources)):
        for index, table in enumerate(tables):
            if table.name == lamp.owner:
                return f"{where}[{index}]"
    return "surface.lamps"  # imported from a mesh, the surface's or an object's
