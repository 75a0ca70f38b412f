"""Scenes to TOML: a small writer of our own, since the standard library only reads."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, cast

from andon.scene.model import Scene

__all__ = ["dump_scene", "toml_text"]

_ESCAPES = {"\\": "\\\\", '"': '\\"', "\n": "\\n", "\t": "\\t", "\r": "\\r"}
_FIRST = ("kind", "name")


def dump_scene(scene: Scene, path: Path | None = None) -> str:
    """The scene as TOML text, defaults left out; also written to `path` where one is given."""
    text = toml_text(scene.model_dump(mode="python", exclude_defaults=True))
    if path is not None:
        path.write_text(text, encoding="utf-8")
    return text


def toml_text(tables: Mapping[str, Any]) -> str:
    """TOML 1.0 of nested tables, lists, texts, numbers and booleans; ``None`` is left out."""
    return "\n".join(_lines("", tables)).strip("\n") + "\n"


def _lines(name: str, table: Mapping[str, Any]) -> Iterator[str]:
    entries = {key: value for key, value in table.items() if value is not None}
    order = sorted(entries, key=lambda key: _FIRST.index(key) if key in _FIRST else len(_FIRST))
    later: list[tuple[str, Any]] = []
    for key in order:
        if isinstance(entries[key], Mapping) or _is_tables(entries[key]):
            later.append((f"{name}.{_key(key)}" if name else _key(key), entries[key]))
        else:
            yield f"{_key(key)} = {_value(entries[key])}"
    for path, value in later:
        single = isinstance(value, Mapping)
        for entry in cast(list[Mapping[str, Any]], [value] if single else value):
            lines = list(_lines(path, entry))
            if not single:
                yield from ("", f"[[{path}]]")
            elif not lines or lines[0]:  # a table that only holds tables needs no head
                yield from ("", f"[{path}]")
            yield from lines


def _is_tables(value: Any) -> bool:
    if not isinstance(value, list | tuple) or not value:
        return False
    return all(isinstance(entry, Mapping) for entry in cast(tuple[Any, ...], value))


def _key(key: str) -> str:
    bare = key.isascii() and key.replace("_", "").replace("-", "").isalnum()
    return key if bare else _value(key)


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return '"' + "".join(map(_character, value)) + '"'
    if isinstance(value, list | tuple):
        return "[" + ", ".join(_value(entry) for entry in cast(tuple[Any, ...], value)) + "]"
    return repr(value)  # Python's shortest form of a number is TOML's too, inf and nan included


def _character(character: str) -> str:
    if character in _ESCAPES:
        return _ESCAPES[character]
    if ord(character) < 0x20 or character == "\x7f":
        return f"\\u{ord(character):04x}"
    return character
