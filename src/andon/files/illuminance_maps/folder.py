"""The maps of a folder, each compared with what the manifest says of it."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.illuminance_maps.model import IlluminanceMap, Manifest, MapFile
from andon.files.illuminance_maps.pixels import read_geometry_picture, read_light_picture
from andon.files.limits import DEFAULT_LIMITS, Limits
from andon.files.paths import confined, open_bounded

__all__ = ["map_file", "read_geometry", "read_lux", "read_moment"]

Float32 = NDArray[np.float32]

REMEDY = "bake again: andon bake SCENE makes what is missing"


def map_file(name: str, contents: bytes) -> MapFile:
    """What a manifest says of a file with these contents."""
    return MapFile(name, hashlib.sha256(contents).hexdigest(), len(contents))


def read_geometry(
    folder: str | Path,
    manifest: Manifest,
    camera: int,
    moment: int,
    *,
    limits: Limits = DEFAULT_LIMITS,
) -> tuple[Float32, Float32]:
    """Depth (h, w) in metres and unit normals (h, w, 3), world; NaN where there is no surface.

    Raises
    ------
    InputError
        if the map is not in the manifest, or its file is missing, damaged, of another size than
        the camera's, outside the folder, or holds what no surface has.
    """
    where = f"{manifest.cameras[camera].name}, {manifest.moments[moment]:g} s"
    file = manifest.geometry.get((camera, moment))
    if file is None:
        raise InputError(
            f"the geometry of {where} is not baked", file=folder, field="geometry", remedy=REMEDY
        )
    path = _sound(folder, file, limits)
    return read_geometry_picture(path, limits=limits, shape=manifest.cameras[camera].shape)


def read_lux(
    folder: str | Path,
    manifest: Manifest,
    lamp: str,
    camera: int,
    moment: int,
    *,
    limits: Limits = DEFAULT_LIMITS,
) -> Float32:
    """(h, w, 3) illuminance in lx, finite and ≥ 0, of one lamp; errors as `read_geometry`."""
    where = f"{lamp}, {manifest.cameras[camera].name}, {manifest.moments[moment]:g} s"
    file = manifest.light.get((lamp, camera, moment))
    if file is None:
        raise InputError(
            f"the light of {where} is not baked", file=folder, field="light", remedy=REMEDY
        )
    path = _sound(folder, file, limits)
    lux, word = read_light_picture(path, limits=limits, shape=manifest.cameras[camera].shape)
    if word != manifest.photometry:
        raise InputError(
            f"must be {manifest.photometry}, as its manifest says, is {word}",
            file=path,
            field="andon:photometry",
            remedy=REMEDY,
        )
    return lux


def read_moment(
    folder: str | Path,
    manifest: Manifest,
    moment: int,
    *,
    lamps: Iterable[str] | None = None,
    limits: Limits = DEFAULT_LIMITS,
) -> tuple[IlluminanceMap, ...]:
    """All maps of a moment, in the order of the cameras, with the light of `lamps`; default: all.

    Errors as `read_geometry`.
    """
    names = [lamp.name for lamp in manifest.lamps] if lamps is None else list(lamps)
    found: list[IlluminanceMap] = []
    for camera, view in enumerate(manifest.cameras):
        depth, normal = read_geometry(folder, manifest, camera, moment, limits=limits)
        lux = {
            name: read_lux(folder, manifest, name, camera, moment, limits=limits) for name in names
        }
        found.append(IlluminanceMap(view, depth, normal, lux))
    return tuple(found)


def _sound(folder: str | Path, file: MapFile, limits: Limits) -> Path:
    """The path of a file that lies in the folder and has the bytes that it was written with."""
    from andon.files.illuminance_maps.manifest import MANIFEST

    path = confined(file.name, Path(folder), file=Path(folder) / MANIFEST)
    if not path.exists():
        raise InputError("the map is missing", file=path, remedy=REMEDY)
    contents = open_bounded(path, limits)
    if len(contents) != file.size:
        rule = f"must have {file.size} bytes, as its manifest says, has {len(contents)}"
        raise InputError(rule, file=path, field="bytes", remedy=REMEDY)
    if hashlib.sha256(contents).hexdigest() != file.sha256:
        rule = "must have the sum that its manifest says: it is damaged, or of another bake"
        raise InputError(rule, file=path, field="sha256", remedy=REMEDY)
    return path
