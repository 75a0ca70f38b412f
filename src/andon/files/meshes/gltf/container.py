"""The JSON of a .gltf or .glb file and the binary chunk of the latter (glTF 2.0, section 4)."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any, NoReturn, cast

from andon.errors import InputError
from andon.files.limits import Limits, check_at_most
from andon.files.paths import open_bounded
from andon.files.tree import Tree, check_complexity

__all__ = ["Document", "open_document"]

GLB_MAGIC, JSON_CHUNK, BIN_CHUNK = b"glTF", b"JSON", b"BIN\0"

# Extensions that a file may *require*. Those of materials change the look, not the geometry, and
# are handed on; quantisation needs nothing beyond reading the stored types.
SUPPORTED = ("KHR_lights_punctual", "KHR_mesh_quantization", "KHR_texture_transform")
SUPPORTED_PREFIX = "KHR_materials_"


class Document:
    """A checked glTF file: `root` of the JSON, `path`, `limits`, and the GLB's `binary` chunk."""

    def __init__(self, root: Tree, path: Path, limits: Limits, binary: memoryview | None) -> None:
        self.root, self.path, self.limits, self.binary = root, path, limits, binary

    def entry(self, collection: str, index: Tree) -> Tree:
        """The element of a top-level list that `index` (a number in the file) refers to."""
        items = self.root.table().get(collection)
        if not isinstance(items, list) or not items:
            raise index.error(f"refers to {collection}, of which there are none")
        entries = cast("list[Any]", items)
        number = index.integer(0, len(entries) - 1)
        return Tree(entries[number], f"{collection}[{number}]", self.root.file)


def open_document(path: str | Path, limits: Limits) -> Document:
    """Parse and check a .gltf or .glb file (told apart by contents)."""
    path = Path(path)
    data = open_bounded(path, limits)
    binary: memoryview | None = None
    text = data
    if data.startswith(GLB_MAGIC):
        text, binary = _split_glb(data, path)
    check_at_most(len(text), limits.max_text_bytes, "bytes of JSON", path)
    try:
        value: Any = json.loads(text.decode("utf-8-sig"), parse_constant=_no_constant)
    except (ValueError, RecursionError) as error:
        raise InputError(f"must be sound glTF JSON: {str(error)[:160]}", file=path) from error
    check_complexity(value, str(path), limits)
    root = Tree(value, "", str(path))
    _check_asset(root)
    return Document(root, path, limits, binary)


def _no_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is no JSON number")


def _split_glb(data: bytes, path: Path) -> tuple[bytes, memoryview | None]:
    """The JSON chunk and the binary chunk; unknown chunks are skipped, as the standard asks."""
    if len(data) < 20:
        raise InputError("must be a sound GLB file, is cut short", file=path)
    _, version, length = struct.unpack_from("<4sII", data)
    if version != 2:
        raise InputError(f"must be GLB version 2, is {version}", file=path)
    if length > len(data):
        raise InputError(f"must have {length} bytes, is cut short at {len(data)}", file=path)
    text: bytes | None = None
    binary: memoryview | None = None
    at = 12
    while at + 8 <= length:
        size, kind = struct.unpack_from("<I4s", data, at)
        if at + 8 + size > length:
            raise InputError("has a chunk beyond its end", file=path)
        chunk = memoryview(data)[at + 8 : at + 8 + size]
        if text is None:
            if kind != JSON_CHUNK:
                raise InputError("must begin with a JSON chunk", file=path)
            text = bytes(chunk)
        elif kind == BIN_CHUNK and binary is None:
            binary = chunk
        at += 8 + size
    if text is None:
        raise InputError("must have a JSON chunk", file=path)
    return text, binary


def _check_asset(root: Tree) -> None:
    version = root.at("asset").at("version").text()
    if version.split(".")[0] != "2":
        raise root.error(f"must be glTF 2, is {version[:20]!r}", "convert it to glTF 2.0")
    for item in root.list_of("extensionsRequired"):
        name = item.text()
        if name not in SUPPORTED and not name.startswith(SUPPORTED_PREFIX):
            raise item.error(
                f"requires the extension {name[:60]!r}, which is not read here",
                "export it without compression and special extensions",
            )
