"""The scene that was typed: a scene file, if there is one, and the options over it."""

from __future__ import annotations

import os
import re
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, cast

from andon.cli.options import RelightOptions
from andon.errors import InputError

__all__ = ["ASSUMED_AMBIENT_LUX", "named_as_typed", "scene_of"]

# E0 where nobody states it: a lit living room in the evening (EN 12464-1 asks 300 lx of rooms in
# which people read). The result then is relative, and says so.
ASSUMED_AMBIENT_LUX = 300.0
_DISPLAY = re.compile(r"display\.(tone|exposure)")
_LAMP = re.compile(r"lamp\[(\d+)\]")
EYES = ("left", "right")
# Keys of a lamp and of its inner tables that name a file.
FILE_KEYS = ("file", "mesh", "texture", "path", "mask")


def scene_of(options: RelightOptions) -> Any:
    """The scene that the options describe; they win over the scene file."""
    from andon.lamps import parse_lamp_option
    from andon.scene import load_scene, scene_from_dict

    tables: dict[str, Any] = {}
    folder, file = Path(), "command line"
    if options.scene is None and options.photo is None:
        raise InputError(
            "is missing: there is no picture to relight",
            field="PHOTO",
            remedy="name one, or with --scene a scene file that names one or needs none",
        )
    if options.scene is not None:
        loaded = load_scene(options.scene)
        tables = loaded.model_dump(exclude_unset=True)
        folder, file = loaded.folder, loaded.file
    _override(tables, options)
    lamps = [
        parse_lamp_option(text, field=f"--lamp {number}")
        for number, text in enumerate(options.lamps or (), start=1)
    ]
    if options.scene is None:
        _assume(tables, options)
    given = [options.photo, options.depth, options.camera, options.mesh, *(options.objects or ())]
    named = [path for path in given if path is not None]
    named += [Path(str(table[key])) for lamp in lamps for table, key in _files(lamp)]
    for table, key in [place for lamp in lamps for place in _files(lamp)]:
        table[key] = _absolute(table[key])
    with named_as_typed(options, len(tables.get("lamp", ())), file):
        tables["lamp"] = [*tables.get("lamp", ()), *lamps]
        return scene_from_dict(tables, folder=folder, file=file).trusting(named)


@contextmanager
def named_as_typed(options: RelightOptions, before: int, file: str) -> Generator[None]:
    """Faults of what was typed name the option, not a place in a file.

    `before` is how many lamps the scene `file` has of its own.
    """
    try:
        yield
    except InputError as error:
        shown = _DISPLAY.fullmatch(error.field or "")
        if shown is not None and getattr(options, shown[1]) is not None:
            raise InputError(error.rule, field=f"--{shown[1]}", remedy=error.remedy) from error
        place = _LAMP.match(error.field or "")
        if place is None or not 0 <= int(place[1]) - before < len(options.lamps or ()):
            raise
        key = (error.field or "")[place.end() :].lstrip(".")
        raise InputError(
            _LAMP.sub(lambda found: _lamp_words(int(found[1]), before), error.rule),
            file=None if error.file == file else error.file,
            field=_lamp_words(int(place[1]), before) + (f": {key}" if key else ""),
            remedy=error.remedy and _as_option(error.remedy),
        ) from error


def _lamp_words(index: int, before: int) -> str:
    return f"lamp[{index}]" if index < before else f"--lamp {index - before + 1}"


def _as_option(remedy: str) -> str:
    """A remedy in the words of a scene file, as it is typed after --lamp."""
    remedy = re.sub(
        r"add '(\w+) = …' to lamp\[\d+\]((?:\.\w+)*)",
        lambda found: f"add {found[2][1:]}{'.' if found[2] else ''}{found[1]}=…",
        remedy,
    )
    if "[[lamp.key]]" in remedy:
        return remedy + " in a scene file"
    return re.sub(r"\b([a-z_]+) = (?=[\w\"…])", r"\1=", remedy)


def _absolute(path: Any) -> str:
    """What is typed is relative to the current folder, what a scene names to its own."""
    return os.path.abspath(str(path))


def _files(table: dict[str, Any]) -> list[tuple[dict[str, Any], str]]:
    """(table, key) of every file that a lamp and its inner tables name."""
    found = [(table, key) for key in FILE_KEYS if isinstance(table.get(key), str)]
    for inner in table.values():
        found += _files(cast(dict[str, Any], inner)) if isinstance(inner, dict) else []
    return found


def _override(tables: dict[str, Any], options: RelightOptions) -> None:
    if options.camera is not None:
        tables["rig"] = {"camera": {"file": _absolute(options.camera)}}
    _photograph(tables, options)
    if options.depth is not None and options.mesh is not None:
        raise InputError("give one of --depth and --mesh", field="--depth")
    depth = {
        "kind": options.depth_kind and options.depth_kind.value,
        "scale_to_m": options.depth_scale_to_m,
        "baseline_m": options.baseline_m,
        "doffs_px": options.doffs_px,
    }
    stated = {key: value for key, value in depth.items() if value is not None}
    if options.depth is not None:
        tables["surface"] = {"depth": {"file": _absolute(options.depth), **stated}}
    elif stated:
        raise InputError(f"{', '.join(stated)} without --depth", field="--depth")
    if options.mesh is not None:
        tables["surface"] = {"mesh": _absolute(options.mesh)}
    if options.ambient_lux is not None:
        # E0 was typed in: it replaces the scene's E0, whatever form that had.
        dimmed = {k: v for k, v in tables.get("ambient", {}).items() if k.startswith("dimming")}
        tables["ambient"] = {"illuminance_lux": options.ambient_lux, **dimmed}
    if options.dimming is not None:
        tables.setdefault("ambient", {})["dimming"] = options.dimming
    shown = {"tone": options.tone, "exposure": options.exposure}
    stated = {key: value for key, value in shown.items() if value is not None}
    tables["display"] = tables.get("display", {}) | stated
    if options.objects:
        more = [{"name": path.stem, "mesh": _absolute(path)} for path in options.objects]
        tables["object"] = [*tables.get("object", ()), *more]


def _photograph(tables: dict[str, Any], options: RelightOptions) -> None:
    """The photograph that was typed: of the only camera, or of the eye that --view names."""
    if options.photo is None:  # as the scene says
        if options.depth is not None and not tables.get("capture", {}).get("source"):
            raise InputError(
                "belongs to a photograph, and the scene names none",
                field="--depth",
                remedy="name the photograph before the options, or give --mesh",
            )
        return
    capture = tables.setdefault("capture", {})
    source, photo = capture.get("source"), _absolute(options.photo)
    if tables.get("rig", {}).get("kind") != "stereo":
        capture["source"] = photo
        return
    eye = EYES[0] if options.view is None else options.view
    if eye not in EYES:  # refused when the scene is there
        return
    (other,) = (name for name in EYES if name != eye)
    if not isinstance(source, dict):
        raise InputError(
            f"the {other} eye has no picture: {options.photo.name!r} is that of the {eye}",
            file=options.scene,
            field="capture.source",
            remedy=f"name it in the scene: source = {{ left = …, right = … }}; --view {other} "
            "gives the photograph to that eye",
        )
    capture["source"] = source | {eye: photo}


def _assume(tables: dict[str, Any], options: RelightOptions) -> None:
    """What a scene would state and the command line did not."""
    if options.camera is None:
        raise InputError(
            "is missing: nothing says where the pixels look",
            field="--camera",
            remedy="give a camera file, e.g. with width, height and hfov_degrees",
        )
    if options.depth is None and options.mesh is None:
        raise InputError(
            "is missing: light needs geometry to fall on", field="--depth", remedy="or give --mesh"
        )
    if options.ambient_lux is None:
        tables["scene"] = {"photometry": "relative"}
        tables.setdefault("ambient", {})["illuminance_lux"] = ASSUMED_AMBIENT_LUX
