"""``maps.json``: the manifest as text, pretty, keys always in the same order.

A reader trusts none of it: every index, name, sum and size is checked, files are confined to the
folder when they are read, and the pictures themselves are compared with what is said here.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from andon.errors import InputError
from andon.files.atomic import write_bytes
from andon.files.cameras import CAMERA_KEYS, camera_from_table
from andon.files.illuminance_maps.model import MOST_BOUNCES, BakedLamp, Manifest, MapFile
from andon.files.limits import DEFAULT_LIMITS, Limits, check_at_most
from andon.files.paths import open_bounded
from andon.files.tree import Tree, check_complexity
from andon.spaces import View

__all__ = ["FORMAT", "MANIFEST", "VERSION", "read_manifest", "read_manifest_file", "write_manifest"]

MANIFEST = "maps.json"
FORMAT = "andon illuminance maps"
VERSION = 1
KEYS = (
    "format", "version", "generator", "unit", "photometry", "quality", "bounces",
    "moments_seconds", "lamps", "cameras", "facts", "geometry", "light",
)  # fmt: skip
GEOMETRY_KEYS = ("camera", "moment", "file", "sha256", "bytes")
LIGHT_KEYS = ("lamp", *GEOMETRY_KEYS)


def write_manifest(folder: str | Path, manifest: Manifest) -> Path:
    """Write ``maps.json`` into an existing folder, atomically; the same manifest, the same bytes.

    Write it after the pictures: who reads the folder meanwhile then finds no map that is not there.
    """
    return write_bytes(Path(folder) / MANIFEST, manifest_text(manifest).encode())


def manifest_text(manifest: Manifest) -> str:
    """The contents of ``maps.json``: one line for each lamp, camera, fact and file."""
    lamps = [{"name": lamp.name, "part": lamp.part} for lamp in manifest.lamps]
    geometry = [
        {"camera": camera, "moment": moment, **_file_table(file)}
        for (camera, moment), file in sorted(manifest.geometry.items())
    ]
    order = {lamp.name: number for number, lamp in enumerate(manifest.lamps)}
    light = [
        {"lamp": lamp, "camera": camera, "moment": moment, **_file_table(file)}
        for (lamp, camera, moment), file in sorted(
            manifest.light.items(), key=lambda item: (order[item[0][0]], *item[0][1:])
        )
    ]
    facts = {name: manifest.facts[name] for name in sorted(manifest.facts)}
    entries = [
        f'"format": {_json(FORMAT)}',
        f'"version": {VERSION}',
        f'"generator": {_json(manifest.generator)}',
        '"unit": "lx"',
        f'"photometry": {_json(manifest.photometry)}',
        f'"quality": {_json(manifest.quality)}',
        f'"bounces": {manifest.bounces}',
        f'"moments_seconds": {_json([float(seconds) for seconds in manifest.moments])}',
        f'"lamps": {_lines("[]", map(_json, lamps))}',
        f'"cameras": {_lines("[]", map(_json, map(_camera_table, manifest.cameras)))}',
        f'"facts": {_lines("{}", (f"{_json(k)}: {_json(v)}" for k, v in facts.items()))}',
        f'"geometry": {_lines("[]", map(_json, geometry))}',
        f'"light": {_lines("[]", map(_json, light))}',
    ]
    return "{\n " + ",\n ".join(entries) + "\n}\n"


def _json(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False, allow_nan=False)


def _lines(brackets: str, items: Iterable[str]) -> str:
    listed = list(items)
    if not listed:
        return brackets
    return f"{brackets[0]}\n  " + ",\n  ".join(listed) + f"\n {brackets[1]}"


def _file_table(file: MapFile) -> dict[str, Any]:
    return {"file": file.name, "sha256": file.sha256, "bytes": file.size}


def _camera_table(view: View) -> dict[str, Any]:
    table: dict[str, Any] = {
        "name": view.name,
        "projection": view.projection,
        "width": view.width,
        "height": view.height,
    }
    if view.projection != "latlong":
        table |= {key: float(getattr(view, key)) for key in ("fx", "fy", "cx", "cy")}
    table["world_from_camera"] = [[float(v) for v in row] for row in view.world_from_camera]
    return table


def read_manifest(folder: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> Manifest:
    """The manifest of a folder of baked maps.

    Raises
    ------
    InputError
        if there are no maps yet, if the manifest is damaged or newer than this program, or if
        anything in it breaks a rule of the format.
    """
    folder = Path(folder)
    remedy = "bake first: andon bake SCENE"
    if folder.exists() and not folder.is_dir():
        raise InputError("must be a folder of baked maps, is a file", file=folder, remedy=remedy)
    path = folder / MANIFEST
    if not path.exists():
        what = f"has no {MANIFEST}: nothing is baked" if folder.exists() else "is not there"
        raise InputError(f"the folder of baked maps {what}", file=folder, remedy=remedy)
    return read_manifest_file(path, limits=limits)


def read_manifest_file(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> Manifest:
    """The manifest in a file, checked; see `read_manifest`."""
    data = open_bounded(path, limits, max_bytes=limits.max_text_bytes)
    try:
        value: Any = json.loads(data.decode("utf-8"))
    except (ValueError, RecursionError) as error:
        raise InputError(
            f"must be sound JSON: {str(error)[:120]}", file=path, remedy="bake again"
        ) from error
    check_complexity(value, str(path), limits)
    root = Tree(value, "", str(path))
    _check_version(root)
    try:
        return _manifest(root, limits)
    except InputError as error:
        if error.file is None:  # the model's own checks do not know the file
            raise InputError(
                error.rule, file=path, field=error.field, remedy=error.remedy
            ) from error
        raise


def _check_version(root: Tree) -> None:
    if "format" not in root or root.at("format").text() != FORMAT:
        raise root.error(f"must be a manifest with the format {FORMAT!r}")
    version = root.at("version").integer(1, 10**9)
    if version > VERSION:
        raise root.at("version").error(
            f"must be at most {VERSION}, got {version}: a newer Andon wrote it",
            "update Andon, or bake again",
        )
    if root.at("unit").text() != "lx":
        raise root.at("unit").error(f"must be 'lx', got {root.at('unit').text()[:40]!r}")


def _manifest(root: Tree, limits: Limits) -> Manifest:
    cameras = [_camera(camera) for camera in root.at("cameras").elements()]
    geometry: dict[tuple[int, int], MapFile] = {}
    for entry in root.at("geometry").elements():
        place = entry.at("camera").integer(0, 10**6), entry.at("moment").integer(0, 10**6)
        if place in geometry:
            raise entry.error("must not be listed twice")
        geometry[place] = _file(entry, limits)
    light: dict[tuple[str, int, int], MapFile] = {}
    for entry in root.at("light").elements():
        camera, moment = (entry.at(key).integer(0, 10**6) for key in ("camera", "moment"))
        where = entry.at("lamp").text(), camera, moment
        if where in light:
            raise entry.error("must not be listed twice")
        light[where] = _file(entry, limits)
    pixels = sum(view.width * view.height for view in cameras)
    check_at_most(pixels, limits.max_total_pixels, "pixels of all cameras", root.file)
    return Manifest(
        cameras=tuple(cameras),
        moments=root.at("moments_seconds").numbers(),
        lamps=tuple(_lamp(lamp) for lamp in root.at("lamps").elements()),
        geometry=geometry,
        light=light,
        quality=root.at("quality").text(),
        bounces=root.at("bounces").integer(0, MOST_BOUNCES),
        photometry=_word(root.at("photometry"), ("absolute", "relative")),
        facts={name: root.at("facts").at(name).text() for name in root.at("facts").table()},
        generator=root.at("generator").text(),
    )


def _camera(table: Tree) -> View:
    # Unknown keys are ignored, as everywhere in this format; scenes are stricter.
    known = {key: value for key, value in table.table().items() if key in CAMERA_KEYS}
    for key in ("name", "projection", "world_from_camera"):
        table.at(key)
    return camera_from_table(Tree(known, table.place, table.file))


def _lamp(table: Tree) -> BakedLamp:
    return BakedLamp(table.at("name").text(), _word(table.at("part"), ("all", "bounce")))


def _word(value: Tree, known: tuple[str, ...]) -> Any:
    if value.text() not in known:
        raise value.error(f"must be {' or '.join(known)}, got {value.text()[:40]!r}")
    return value.text()


def _file(entry: Tree, limits: Limits) -> MapFile:
    size = entry.at("bytes").integer(1, limits.max_file_bytes)
    return MapFile(entry.at("file").text(), entry.at("sha256").text(), size)
