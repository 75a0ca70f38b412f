"""WGSL modules: files beside the Python that uses them, joined by imports.

An import can be exchanged for another module of the same functions, or for generated text
(`variants`): one projection, one shadow filter, just the lamps there are, instead of branches and
loops, which a software rasteriser pays for whether they are taken or not.

A line ``//!import andon/gpu/octahedral.wgsl`` is replaced by that file, once, before the text that
needs it; ``//!struct Lamp`` by the declaration of a host struct (`andon.gpu.layout`), so that a
layout is written in one place. Paths are relative to the package's parent and stay inside it.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from importlib import resources
from pathlib import PurePosixPath

from andon.gpu.layout import HostStruct

__all__ = ["MODULE_SUFFIX", "all_modules", "resolve"]

MODULE_SUFFIX = ".wgsl"
_IMPORT = re.compile(r"^//!import (\S+)\s*$", re.MULTILINE)
_STRUCT = re.compile(r"^//!struct (\w+)\s*$", re.MULTILINE)


def _read(path: str) -> str:
    parts = PurePosixPath(path).parts
    if parts[:1] != ("andon",) or ".." in parts or not path.endswith(MODULE_SUFFIX):
        raise ValueError(f"{path}: a WGSL import names a module inside andon/")
    return resources.files("andon").joinpath(*parts[1:]).read_text(encoding="utf-8")


def resolve(
    path: str,
    structs: Mapping[str, HostStruct] | None = None,
    variants: Mapping[str, str] | None = None,
) -> str:
    """The module at `path` ("andon/…/name.wgsl") with all that it imports, each once, in order.

    `variants` maps imported paths to the path, or the text, that stands in for them.
    """
    seen: list[str] = []
    texts: list[str] = []
    _visit(path, seen, texts, (), variants or {})
    text = "\n".join(texts)
    known = dict(structs or {})

    def declare(match: re.Match[str]) -> str:
        return known[match[1]].wgsl()

    return _STRUCT.sub(declare, text)


def _visit(
    path: str,
    seen: list[str],
    texts: list[str],
    above: tuple[str, ...],
    variants: Mapping[str, str],
) -> None:
    text = variants.get(path, "")
    if text.endswith(MODULE_SUFFIX):
        path, text = text, ""
    if path in above:
        raise ValueError(f"WGSL import cycle: {' → '.join((*above, path))}")
    if path in seen:
        return
    seen.append(path)
    text = text or _read(path)
    for match in _IMPORT.finditer(text):
        _visit(match[1], seen, texts, (*above, path), variants)
    texts.append(f"// ── {path}\n" + _IMPORT.sub("", text).strip() + "\n")


def all_modules() -> list[str]:
    """Every WGSL module in the package, as import paths."""
    root = resources.files("andon")
    found: list[str] = []
    folders = [(root, "andon")]
    while folders:
        folder, prefix = folders.pop()
        for entry in folder.iterdir():
            if entry.is_dir():
                folders.append((entry, f"{prefix}/{entry.name}"))
            elif entry.name.endswith(MODULE_SUFFIX):
                found.append(f"{prefix}/{entry.name}")
    return sorted(found)
