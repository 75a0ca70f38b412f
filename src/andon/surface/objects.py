"""A scene's [[object]] tables as triangles: those that stand still as one, and those that move."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.meshes import AnimatedMesh, read_animated
from andon.files.meshes.gltf.clips import Clip
from andon.quantities import MAX_OBJECT_MATERIALS, Geometry, merged
from andon.rays import face_normals
from andon.scene import Scene
from andon.scene.keyframes import object_at
from andon.scene.objects import SceneObject
from andon.surface.meshes import check_textures, read_geometry, rest_note
from andon.surface.model import EMPTY_GEOMETRY, ObjectInfo, SurfaceModel
from andon.surface.movers import Mover, Play
from andon.surface.textures import with_linear_textures

__all__ = ["joined", "load_objects", "object_geometry"]


@dataclass(frozen=True)
class _Read:
    """An object as read: what it is when it stands still, or what moves it."""

    name: str
    index: int
    entry: SceneObject
    geometry: Geometry
    mover: Mover | None
    notes: tuple[str, ...]


def load_objects(scene: Scene, /) -> SurfaceModel:
    """All virtual objects with their materials, and those that cast shadows.

    Raises `InputError` for files that do not fit, animations that are not in them, and too many
    materials or textures.
    """
    read = [_read(scene, index) for index in range(len(scene.object))]
    if not read:
        return SurfaceModel()
    still = [one for one in read if one.mover is None]
    moving = [one for one in read if one.mover is not None]
    objects = joined([one.geometry for one in still]) if still else EMPTY_GEOMETRY
    for drawn in (objects, *(one.geometry for one in moving)):
        check_textures(drawn, scene, "object")
    casting = [one.geometry for one in still if one.entry.casts_shadow]
    return SurfaceModel(
        objects=objects,
        casters=merged(*casting) if casting else EMPTY_GEOMETRY,
        objects_table=_table(scene, [*still, *moving]),
        movers=tuple(one.mover for one in moving if one.mover is not None),
        # One file may stand in several places.
        notes=tuple(dict.fromkeys(note for one in read for note in one.notes)),
    )


def object_geometry(scene: Scene, index: int, time_seconds: float = 0.0, /) -> Geometry:
    """The triangles of ``scene.object[index]`` in the world at a time of the session."""
    read = _read(scene, index)
    return read.geometry if read.mover is None else read.mover.at(time_seconds)


def _read(scene: Scene, index: int) -> _Read:
    entry, field = scene.object[index], f"object[{index}]"
    name = entry.name if "name" in entry.model_fields_set else field
    path = scene.path(entry.mesh, f"{field}.mesh")
    placement = partial(object_at, entry)
    if entry.animation is not None:
        mesh = read_animated(path)
        clip = _clip(scene, f"{field}.animation", mesh, entry.animation)
        speed, start = entry.animation_speed, entry.animation_start_seconds
        play = Play(mesh, clip, start, speed, entry.loop)
        geometry = with_linear_textures(mesh.geometry)
        mover = Mover(geometry, placement, play, casts_shadow=entry.casts_shadow)
        return _Read(name, index, entry, mover.geometry, mover, ())
    placed = np.eye(4) if entry.key else entry.world_from_object()
    geometry, file = read_geometry(scene, path, placed)
    still = 'unless its animation is stated: animation = "0" plays the first'
    notes = rest_note(path, file, *([still] if "animation" in file.at_rest else []))
    if not entry.key:
        return _Read(name, index, entry, geometry, None, notes)
    mover = Mover(geometry, placement, casts_shadow=entry.casts_shadow)
    return _Read(name, index, entry, mover.geometry, mover, notes)


def _clip(scene: Scene, field: str, mesh: AnimatedMesh, name: str) -> Clip:
    """The clip that a scene names; an error names the place in the scene."""
    try:
        return mesh.clip(name)
    except InputError as error:
        rule = f"{error.rule} ({Path(mesh.file).name})"
        raise InputError(rule, file=scene.file, field=field, remedy=error.remedy) from error


def _table(scene: Scene, read: list[_Read]) -> tuple[ObjectInfo, ...]:
    """Which slots each object has; refuses more than there are."""
    counts = [len(one.geometry.materials) for one in read]
    if sum(counts) > MAX_OBJECT_MATERIALS:
        raise InputError(
            f"virtual objects have {sum(counts)} materials, at most {MAX_OBJECT_MATERIALS} can be "
            "told apart",
            file=scene.file,
            field="object",
            remedy="let parts share materials, or leave objects out",
        )
    starts: list[int] = np.cumsum([0, *counts]).tolist()
    return tuple(
        ObjectInfo(
            one.name,
            start,
            count,
            len(one.geometry.triangles),
            one.entry.lit_by_probes,
            one.entry.lit_by_lamps,
            one.index,
        )
        for one, start, count in zip(read, starts, counts, strict=False)
    )


def joined(parts: list[Geometry], /) -> Geometry:
    """One geometry from several, with normals, texture coordinates and materials."""
    parts = [part if part.normals is not None else flat_shaded(part) for part in parts]
    points = merged(*parts)
    normals = np.concatenate([part.normals for part in parts if part.normals is not None])
    uvs = np.concatenate(
        [np.zeros((len(p.positions), 2)) if p.uvs is None else p.uvs for p in parts]
    )
    ids: list[NDArray[np.int32]] = []
    first = 0
    for part in parts:
        own = part.material_ids
        own = np.zeros(len(part.triangles), np.int32) if own is None else own
        ids.append((own + first).astype(np.int32))
        first += len(part.materials)
    materials = tuple(material for part in parts for material in part.materials)
    return replace(
        points, normals=normals, uvs=uvs, material_ids=np.concatenate(ids), materials=materials
    )


def flat_shaded(part: Geometry, /) -> Geometry:
    """The same triangles with three corners of their own each, and their plane's normal there."""
    corner = part.triangles.ravel()
    return replace(
        part,
        positions=part.positions[corner],
        normals=np.repeat(face_normals(part), 3, axis=0),
        uvs=None if part.uvs is None else part.uvs[corner],
        triangles=np.arange(len(corner), dtype=np.int32).reshape(-1, 3),
    )
