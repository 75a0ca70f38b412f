"""Arrays into the one buffer of a GLB file (glTF 2.0, sections 3.6 and 4.4)."""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["ATTRIBUTES", "INDICES", "GlbArrays", "glb_bytes"]

ATTRIBUTES, INDICES = 34962, 34963  # bufferView.target of vertex attributes and of indices
COMPONENTS = {"u1": 5121, "u4": 5125, "f4": 5126}
TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}
PAD = 4  # every view begins at a multiple of the largest component


class GlbArrays:
    """Collects arrays; `accessors` and `views` are the JSON lists that tell where they lie."""

    def __init__(self) -> None:
        self.accessors: list[dict[str, Any]] = []
        self.views: list[dict[str, Any]] = []
        self._parts: list[bytes] = []
        self._length = 0

    def add(self, values: NDArray[Any], *, target: int | None = None, bounds: bool = False) -> int:
        """The number of a new accessor of (count, width) or (count,) values, count ≥ 1.

        uint8, int32, uint32 and float32 are stored; int32 as uint32 with the same bits, since
        glTF has no signed type of 32 bits. `bounds`: min and max, which positions must have.
        """
        stored = values.view(np.uint32) if values.dtype == np.int32 else values
        kind = stored.dtype.newbyteorder("<")
        view = self.blob(np.ascontiguousarray(stored, kind).tobytes(), target=target)
        accessor: dict[str, Any] = {
            "bufferView": view,
            "componentType": COMPONENTS[kind.str[1:]],
            "count": len(stored),
            "type": TYPES[1 if stored.ndim == 1 else stored.shape[1]],
        }
        if bounds:
            accessor["min"] = [float(x) for x in stored.min(axis=0)]
            accessor["max"] = [float(x) for x in stored.max(axis=0)]
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def blob(self, data: bytes, *, target: int | None = None) -> int:
        """The number of a new bufferView of `data` (a whole picture, for example)."""
        view: dict[str, Any] = {
            "buffer": 0,
            "byteOffset": self._length,
            "byteLength": len(data),
        }
        if target is not None:
            view["target"] = target
        self.views.append(view)
        padded = data + b"\0" * (-len(data) % PAD)
        self._parts.append(padded)
        self._length += len(padded)
        return len(self.views) - 1

    def document(self, tables: Mapping[str, Any]) -> bytes:
        """The GLB file of these arrays and the other top-level `tables` of its JSON."""
        stored: dict[str, Any] = {"accessors": self.accessors} if self.accessors else {}
        stored |= {"bufferViews": self.views, "buffers": [{"byteLength": self._length}]}
        return glb_bytes({**tables, **stored}, b"".join(self._parts))


def glb_bytes(document: Mapping[str, Any], binary: bytes) -> bytes:
    """A GLB file of its JSON and its binary chunk, each padded to four bytes (4.4.2)."""
    text = json.dumps(document, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    encoded = text.encode("utf-8")
    chunks = b""
    for data, kind, pad in ((encoded, b"JSON", b" "), (binary, b"BIN\0", b"\0")):
        padded = data + pad * (-len(data) % 4)
        chunks += struct.pack("<I4s", len(padded), kind) + padded
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks
