"""A small writer of binary glTF 2.0 files for the makers of examples."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

__all__ = ["Glb"]

COMPONENTS = {"<f4": 5126, "<u2": 5123, "<u4": 5125, "|u1": 5121}
VERTICES, INDICES = 34962, 34963


class Glb:
    """The JSON of a file, whose lists are filled by hand, and its binary chunk."""

    def __init__(self, generator: str, copyright: str) -> None:
        self.document: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": generator, "copyright": copyright},
            "scene": 0,
        }
        self._data = b""
        self._views: list[dict[str, Any]] = []
        self._accessors: list[dict[str, Any]] = []

    def accessor(
        self, values: ArrayLike, kind: str, dtype: str = "<f4", target: int | None = None
    ) -> int:
        """Stores (n, …) values of type `kind` (SCALAR, VEC3, MAT4, …); its number."""
        array = np.ascontiguousarray(values, dtype)
        data = array.tobytes()
        view: dict[str, Any] = {
            "buffer": 0,
            "byteOffset": len(self._data),
            "byteLength": len(data),
        }
        if target is not None:
            view["target"] = target
        self._views.append(view)
        self._data += data + b"\0" * (-len(data) % 4)
        entry: dict[str, Any] = {
            "bufferView": len(self._views) - 1,
            "componentType": COMPONENTS[array.dtype.str],
            "count": len(array),
            "type": kind,
        }
        if dtype == "<f4" and kind in ("SCALAR", "VEC3"):
            columns = array.reshape(len(array), -1)
            entry |= {"min": columns.min(axis=0).tolist(), "max": columns.max(axis=0).tolist()}
        self._accessors.append(entry)
        return len(self._accessors) - 1

    def write(self, path: Path) -> None:
        """Writes the file."""
        self.document |= {
            "accessors": self._accessors,
            "bufferViews": self._views,
            "buffers": [{"byteLength": len(self._data)}],
        }
        text = json.dumps(self.document, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
        chunks += struct.pack("<II", len(self._data), 0x004E4942) + self._data
        path.write_bytes(struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks)
