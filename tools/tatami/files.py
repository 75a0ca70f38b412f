"""Writers: the room as binary glTF with its textures inside, lanterns as OBJ."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tatami.materials import LOOKS
from tatami.shapes import Part

FLOAT, SHORT = 5126, 5123


class _Blob:
    """The binary chunk and the tables that point into it."""

    def __init__(self) -> None:
        self.data = b""
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []

    def view(self, data: bytes) -> int:
        self.views.append({"buffer": 0, "byteOffset": len(self.data), "byteLength": len(data)})
        self.data += data + b"\0" * (-len(data) % 4)
        return len(self.views) - 1

    def accessor(self, values: NDArray[Any], kind: str, component: int) -> int:
        entry: dict[str, Any] = {"bufferView": self.view(values.tobytes()), "type": kind}
        entry |= {"componentType": component, "count": len(values)}
        if kind == "VEC3":
            entry |= {"min": values.min(0).tolist(), "max": values.max(0).tolist()}
        self.accessors.append(entry)
        return len(self.accessors) - 1


def write_room(path: Path, parts: list[Part], textures: dict[str, bytes]) -> int:
    """One primitive a part; returns the number of triangles."""
    blob = _Blob()
    images = list(textures)
    stored = [
        {"bufferView": blob.view(textures[name]), "mimeType": "image/jpeg"} for name in images
    ]
    names = list(dict.fromkeys(part.material for part in parts))
    document = {
        "asset": {"version": "2.0", "generator": "Andon tools/make_tatami_room.py"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": "tatami room", "mesh": 0}],
        "meshes": [{"primitives": [_primitive(part, blob, names) for part in parts]}],
        "materials": [_material(name, images) for name in names],
        "textures": [{"source": k} for k in range(len(images))],
        "images": stored,
    }
    if not images:
        del document["textures"], document["images"]
    document |= {
        "accessors": blob.accessors,
        "bufferViews": blob.views,
        "buffers": [{"byteLength": len(blob.data)}],
    }
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
    chunks += struct.pack("<II", len(blob.data), 0x004E4942) + blob.data
    path.write_bytes(struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks)
    return sum(len(part.triangles) for part in parts)


def _material(name: str, images: list[str]) -> dict[str, Any]:
    look = LOOKS[name]
    surface: dict[str, Any] = {"baseColorFactor": [*look.factor, 1.0]}
    surface |= {"metallicFactor": 0.0, "roughnessFactor": 1.0}
    if look.texture is not None:
        surface["baseColorTexture"] = {"index": images.index(look.texture)}
    return {"name": name, "pbrMetallicRoughness": surface}


def _primitive(part: Part, blob: _Blob, names: list[str]) -> dict[str, Any]:
    columns = [part.positions, part.uvs]
    if part.normals is not None:
        columns.append(part.normals)
    rows = np.concatenate(columns, axis=1).astype("<f4")
    rows, inverse = np.unique(rows, axis=0, return_inverse=True)
    attributes = {
        "POSITION": blob.accessor(np.ascontiguousarray(rows[:, :3]), "VEC3", FLOAT),
        "TEXCOORD_0": blob.accessor(np.ascontiguousarray(rows[:, 3:5]), "VEC2", FLOAT),
    }
    if part.normals is not None:
        attributes["NORMAL"] = blob.accessor(np.ascontiguousarray(rows[:, 5:]), "VEC3", FLOAT)
    order = inverse.reshape(-1)[part.triangles].reshape(-1)
    assert len(rows) < 2**16
    indices = blob.accessor(order.astype("<u2"), "SCALAR", SHORT)
    return {
        "attributes": attributes,
        "indices": indices,
        "material": names.index(part.material),
    }


def write_obj(path: Path, positions: ArrayLike, faces: ArrayLike, *, comment: str) -> None:
    """A mesh without material: (n, 3) metres, and triangles or quads."""
    lines = [f"# {comment}"]
    lines += [f"v {x:.5f} {y:.5f} {z:.5f}" for x, y, z in np.asarray(positions).tolist()]
    lines += ["f " + " ".join(str(k + 1) for k in face) for face in np.asarray(faces).tolist()]
    path.write_text("\n".join(lines) + "\n", encoding="ascii")
