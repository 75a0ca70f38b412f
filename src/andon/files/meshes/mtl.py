"""Wavefront material libraries (.mtl): what a diffuse, emitting renderer can use of them.

Kd and map_Kd multiply, as the format says; Kd is taken as linear reflectance, Ke as luminance in
cd/m² (the format has no unit). Other numbers are kept in ``extensions["mtl"]`` for later stages.
Format: Wavefront, "MTL material format" 4.2 (1995).
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from andon.errors import InputError
from andon.files.limits import Limits
from andon.files.meshes.textures import TextureStore
from andon.files.paths import open_bounded
from andon.quantities import Material

__all__ = ["read_materials"]

KEPT = ("d", "Tr", "Ni", "Ns", "illum", "Ks", "Tf")
# Options of a texture line: how many numbers follow at least and at most.
OPTIONS = {
    "-blendu": (1, 1), "-blendv": (1, 1), "-boost": (1, 1), "-bm": (1, 1), "-cc": (1, 1),
    "-clamp": (1, 1), "-imfchan": (1, 1), "-mm": (2, 2), "-o": (1, 3), "-s": (1, 3), "-t": (1, 3),
    "-texres": (1, 1), "-type": (1, 1),
}  # fmt: skip
NEUTRAL = {"-o": 0.0, "-s": 1.0, "-t": 0.0}


def read_materials(path: Path, textures: TextureStore, limits: Limits) -> dict[str, Material]:
    """Materials by name; textures are confined to the folder of the mesh file."""
    text = open_bounded(path, limits, max_bytes=limits.max_text_bytes)
    tables: dict[str, dict[str, str]] = {}
    current: dict[str, str] = {}
    for line in text.decode("utf-8", errors="replace").splitlines():
        key, _, rest = line.split("#", 1)[0].strip().replace("\t", " ").partition(" ")
        if key == "newmtl":
            current = tables.setdefault(rest.strip(), {})
        elif key:
            current[key] = rest.strip()
    if len(tables) > limits.max_nodes:
        raise InputError(f"must have at most {limits.max_nodes} materials", file=path)
    return {name: _material(name, table, path, textures) for name, table in tables.items()}


def _material(name: str, table: dict[str, str], path: Path, textures: TextureStore) -> Material:
    lower = {key.lower(): value for key, value in table.items()}
    reflectance = _triple(table, "Kd", (0.5, 0.5, 0.5), name, path)
    if max(reflectance) > 1:
        raise InputError(
            f"Kd must be a reflectance in 0…1, got {reflectance}", file=path, field=name
        )
    image = lower.get("map_kd")
    if image and "Kd" not in table:
        reflectance = (1.0, 1.0, 1.0)
    return Material(
        name,
        reflectance,
        textures.from_reference(_texture_name(image, name, path)) if image else None,
        _triple(table, "Ke", (0.0, 0.0, 0.0), name, path),
        extensions=_kept(table, name, path),
    )


def _kept(table: dict[str, str], name: str, path: Path) -> dict[str, Any]:
    kept: dict[str, Any] = {}
    for key in KEPT:
        if key in table:
            values = _numbers(table[key].replace("-halo", ""), key, name, path)
            kept[key] = values[0] if len(values) == 1 else tuple(values)
    return {"mtl": kept} if kept else {}


def _triple(
    table: dict[str, str],
    key: str,
    default: tuple[float, float, float],
    name: str,
    path: Path,
) -> tuple[float, float, float]:
    if key not in table:
        return default
    values = _numbers(table[key], key, name, path)
    if len(values) == 1:
        values *= 3
    if len(values) != 3 or min(values) < 0:
        raise InputError(
            f"{key} must be three numbers ≥ 0, got {table[key][:60]!r}", file=path, field=name
        )
    return values[0], values[1], values[2]


def _numbers(text: str, key: str, name: str, path: Path) -> list[float]:
    try:
        values = [float(word) for word in text.split()]
    except ValueError:
        values = []
    if not values or not all(map(math.isfinite, values)):
        raise InputError(f"{key} must be finite numbers, got {text[:60]!r}", file=path, field=name)
    return values


def _texture_name(line: str, name: str, path: Path) -> str:
    """The file name of a texture line, after its options; names may contain spaces."""
    words = line.split(" ")
    at = 0
    while at < len(words) and words[at].lower() in OPTIONS:
        option = words[at].lower()
        least, most = OPTIONS[option]
        at += 1
        taken = 0
        while taken < most and at < len(words) and (taken < least or _is_number(words[at])):
            if option in NEUTRAL and _is_number(words[at]):
                _check_neutral(option, float(words[at]), name, path)
            at, taken = at + 1, taken + 1
    return " ".join(words[at:]).strip().strip('"')


def _check_neutral(option: str, value: float, name: str, path: Path) -> None:
    if value != NEUTRAL[option]:
        raise InputError(
            f"a texture must not be moved or scaled by {option}",
            file=path,
            field=name,
            remedy="put the transform into the texture coordinates",
        )


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True
