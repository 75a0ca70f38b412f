"""Lights of glTF files (KHR_lights_punctual) as lamps of the scene.

============ ============================== =====================================================
glTF         here                           note
============ ============================== =====================================================
point, spot  cd                             inverse square, the same cone
directional  lx                             along the node's −Z, as spots
colour       multiplies each channel        the triple is exactly colour × intensity
node         place and direction            scale moves the place, never the light
range        not used                       a cut-off for speed that loses light: lamps reach on
name         the node's, else the light's   "-2", "-3" … where it is taken
============ ============================== =====================================================

Andon's own tables state a photometric value, and their colour keeps it. glTF states an intensity
that its colour multiplies channel by channel, so the photometric value of a glTF light is
intensity × (0.2126 R + 0.7152 G + 0.0722 B): a blue light of 100 cd has 7.2 cd. What the file
says is taken as it is; the two rules meet where the colour's own photometric value is 1.

Source: KHR_lights_punctual (Khronos).
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.cached import read_cached
from andon.files.meshes import MeshLight, read_lights
from andon.lamps.distributions import spot_coefficients
from andon.lamps.model import DirectionalLamp, PointLamp, SpotLamp
from andon.spaces import rotate, transform_points

if TYPE_CHECKING:  # scene imports pydantic; lamps built in Python do not need it
    from andon.scene import Scene

__all__ = ["imported_lamps", "lamp_of_light"]

Float = NDArray[np.float64]
Imported = PointLamp | SpotLamp | DirectionalLamp

# More lights than anyone places in one file; each of them costs shadow maps.
MAX_LIGHTS = 1024


def imported_lamps(scene: Scene, taken: Iterable[str]) -> tuple[Imported, ...]:
    """The lamps of the files whose tables say ``lamps = true``: the surface's, then the objects'.

    `taken` are names that the scene's own lamps have. Raises `InputError` for a file that is no
    glTF, has no lights, or has one that cannot be computed with.
    """
    sources: list[tuple[str, str, Float]] = []
    surface = scene.surface
    if surface is not None and surface.lamps and surface.mesh is not None:
        placed = np.eye(4) if surface.world_from_mesh is None else np.array(surface.world_from_mesh)
        sources.append((surface.mesh, "surface", placed))
    for index, entry in enumerate(scene.object):
        if entry.lamps:
            sources.append((entry.mesh, f"object[{index}]", entry.world_from_object()))
    names = set(taken)
    lamps: list[Imported] = []
    for reference, field, world_from_file in sources:
        path = scene.path(reference, f"{field}.mesh")
        for light in _lights(path, f"{field}.lamps"):
            name = _free(light.node, names)
            names.add(name)
            lamps.append(lamp_of_light(light, world_from_file, name=name, file=path))
    return tuple(lamps)


def lamp_of_light(
    light: MeshLight, world_from_file: Float, /, *, name: str, file: str | Path
) -> Imported:
    """The lamp of one light; `world_from_file` (4, 4) places the file.

    A scaled file keeps its candela: its rooms grow and get darker by the square, as real ones.
    """
    world_from_light = world_from_file @ light.world_from_light
    position = transform_points(world_from_light, np.zeros(3))
    with np.errstate(over="ignore"):
        triple = np.array(light.colour, np.float64) * light.intensity
    if not (np.isfinite(triple).all() and np.isfinite(position).all()):
        raise InputError("is too large to compute with", file=file, field=f"light {name!r}")
    if light.kind == "point":
        return PointLamp(name, position, triple, owner=name)
    direction = _unit(rotate(world_from_light, np.array([0.0, 0.0, -1.0])), name, file)
    if light.kind == "directional":
        return DirectionalLamp(name, direction, triple, owner=name)
    try:
        spot_coefficients(light.inner_radians, light.outer_radians)
    except InputError as error:
        raise InputError(error.rule, file=file, field=f"light {name!r}") from error
    cone = (light.inner_radians, light.outer_radians)
    return SpotLamp(
        name,
        position,
        triple,
        direction=direction,
        inner_radians=cone[0],
        outer_radians=cone[1],
        owner=name,
    )


def _unit(vector: Float, name: str, file: str | Path) -> Float:
    largest = np.abs(vector).max()
    if not (np.isfinite(largest) and largest > 0):  # a node of scale 0
        raise InputError("has no direction", file=file, field=f"light {name!r}")
    vector = vector / largest
    return vector / np.linalg.norm(vector)


def _free(name: str, taken: set[str]) -> str:
    if name not in taken:
        return name
    return next(f"{name}-{n}" for n in range(2, len(taken) + 3) if f"{name}-{n}" not in taken)


def _lights(path: Path, field: str) -> tuple[MeshLight, ...]:
    """The file's lights, read again only when it changed: lamps are resolved for each frame."""
    lights = read_cached(read_lights, path)
    if not lights:
        raise InputError(
            "has no lights of KHR_lights_punctual",
            file=path,
            field=field,
            remedy="export them with punctual lights, or leave lamps = true out",
        )
    if len(lights) > MAX_LIGHTS:
        raise InputError(
            f"must have at most {MAX_LIGHTS} lights, has {len(lights)}", file=path, field=field
        )
    return lights
