"""Scene files and dictionaries to scenes."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any, cast

import numpy as np
from pydantic import ValidationError

from andon.errors import InputError
from andon.scene.model import Scene
from andon.scene.presets import expand_presets
from andon.scene.refusals import input_error

__all__ = ["MAX_SCENE_BYTES", "load_scene", "parse_scene", "scene_from_dict"]

# A scene names its data, it does not hold it: a file beyond this is a mistake, or hostile.
MAX_SCENE_BYTES = 1 << 20
# Tables in tables; the schema needs five.
MAX_DEPTH = 32

# A key of more than 32 dotted parts. The standard reader's memory grows with the square of their
# number: one megabyte of "a.a.a…" would take all there is, so it must not get that far.
_PART = r"""(?:[\w\-]++|"[^"\n]*+"|'[^'\n]*+')"""
_DEEP_KEY = re.compile(rf"(?<![\w\-]){_PART}(?:[ \t]*+\.[ \t]*+{_PART}){{{MAX_DEPTH},}}")


def load_scene(path: str | PathLike[str]) -> Scene:
    """The scene of a TOML file; its paths are relative to the file's folder.

    Raises `InputError` for a file that is missing, too large, not UTF-8, not TOML, or not a
    scene.
    """
    path = Path(path)
    if path.exists() and not path.is_file():  # a pipe would block, a device never end
        raise InputError("must be a regular file", file=str(path))
    try:
        with path.open("rb") as stream:
            data = stream.read(MAX_SCENE_BYTES + 1)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(f"cannot be read: {reason}", file=str(path)) from error
    if len(data) > MAX_SCENE_BYTES:
        raise InputError(f"a scene file has at most {MAX_SCENE_BYTES} bytes", file=str(path))
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise InputError("must be UTF-8 text", file=str(path), field=f"line {line}") from error
    return parse_scene(text, folder=path.parent, file=str(path))


def parse_scene(text: str, *, folder: str | PathLike[str] = ".", file: str = "scene.toml") -> Scene:
    """The scene of a TOML text; `file` is named in messages. Raises `InputError`."""
    if len(text) > MAX_SCENE_BYTES:
        raise InputError(f"a scene has at most {MAX_SCENE_BYTES} characters", file=file)
    deep = _DEEP_KEY.search(text)
    if deep:
        line = text.count("\n", 0, deep.start()) + 1
        raise InputError(
            f"a key has at most {MAX_DEPTH} dotted parts", file=file, field=f"line {line}"
        )
    try:
        tables = tomllib.loads(text)
    except RecursionError:
        raise InputError("is nested too deeply", file=file) from None
    except ValueError as error:  # TOMLDecodeError, or a number of thousands of digits
        raise _syntax_error(error, text, file) from error
    return scene_from_dict(tables, folder=folder, file=file)


def scene_from_dict(
    tables: Mapping[str, Any], *, folder: str | PathLike[str] = ".", file: str = "scene"
) -> Scene:
    """The scene of tables as TOML would give them; lists may be tuples or NumPy arrays.

    `folder` is what paths are relative to; `file` is named in messages. Raises `InputError`.
    """
    plain = expand_presets(_plain(tables, file, 0), file)
    try:
        scene = Scene.model_validate(plain)
    except ValidationError as error:
        raise input_error(error, file) from error
    return scene.placed_at(Path(folder), file)


def _plain(value: Any, file: str, depth: int) -> Any:
    """`value` with lists and arrays as tuples and NumPy numbers as Python's, for strict models."""
    if depth > MAX_DEPTH:
        raise InputError(f"tables and lists are nested more than {MAX_DEPTH} deep", file=file)
    if isinstance(value, Mapping):
        entries = cast(Mapping[Any, Any], value).items()
        return {str(key): _plain(entry, file, depth + 1) for key, entry in entries}
    if isinstance(value, np.ndarray | np.generic):
        value = cast(Any, value.tolist())
    if isinstance(value, list | tuple):
        return tuple(_plain(entry, file, depth + 1) for entry in cast(list[Any], value))
    return str(value) if isinstance(value, Path) else value


def _syntax_error(error: ValueError, text: str, file: str) -> InputError:
    message = "a number has too many digits" if "digits" in str(error) else str(error)
    place = re.search(r"\(at (line \d+, column \d+|end of document)\)", message)
    field = place.group(1) if place else None
    if field == "end of document":
        lines = text.split("\n")
        field = f"line {len(lines)}, column {len(lines[-1]) + 1}"
    rule = re.sub(r"\s*\(at .*\)$", "", message, flags=re.DOTALL)
    rule = " ".join(rule.split())[:200]
    return InputError(f"is not TOML: {rule}", file=file, field=field)
