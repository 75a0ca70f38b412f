"""glTF's buffers, views and accessors as NumPy arrays (glTF 2.0, section 3.6)."""

from __future__ import annotations

import base64
import binascii
import re
from typing import Any
from urllib.parse import unquote_to_bytes

import numpy as np
from numpy.typing import NDArray

from andon.files.limits import check_at_most
from andon.files.meshes.gltf.container import Document
from andon.files.numbers import to_float64
from andon.files.paths import confined, open_bounded
from andon.files.tree import Tree

__all__ = ["BufferStore"]

COMPONENTS = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
SIZES = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
DATA_URI = re.compile(r"^data:[^,]{0,200}?(;base64)?,", re.IGNORECASE)
MAX_BYTES = 2**40  # what an offset may say before it is compared with the data


class BufferStore:
    """Reads buffers, each once; external ones are confined to the folder of the file."""

    def __init__(self, document: Document) -> None:
        self._document = document
        self._known: dict[str, memoryview] = {}
        self._bytes = 0

    def view(self, index: Tree) -> memoryview:
        """The bytes of a bufferView."""
        view = self._document.entry("bufferViews", index)
        data = self._buffer(view.at("buffer"))
        offset = _integer(view, "byteOffset", 0, MAX_BYTES)
        length = view.at("byteLength").integer(1, MAX_BYTES)
        if offset + length > len(data):
            raise view.error(f"must lie within its buffer of {len(data)} bytes")
        return data[offset : offset + length]

    def accessor(self, index: Tree, kinds: tuple[str, ...]) -> NDArray[Any]:
        """(count, n) of an accessor of one of the types `kinds`.

        Integers keep their type unless they are normalised; then, and for floats, float64.
        """
        accessor = self._document.entry("accessors", index)
        kind = accessor.at("type").text()
        if kind not in kinds:
            raise accessor.error(f"must be {' or '.join(kinds)}, is {kind[:20]!r}")
        limits = self._document.limits
        most = max(limits.max_vertices, 3 * limits.max_triangles)
        count = accessor.at("count").integer(1, most)
        stored = self._stored(accessor, count, SIZES[kind])
        sparse = accessor.get("sparse")
        if sparse is not None:
            stored = self._patched(stored, sparse)
        if accessor.get("normalized") and accessor.at("normalized").boolean():
            return _normalised(stored)
        return to_float64(stored) if stored.dtype.kind == "f" else stored

    def attribute(
        self, attributes: Tree, name: str, kinds: tuple[str, ...], count: int
    ) -> NDArray[np.float64] | None:
        """(count, n) finite float64 of one attribute of `count` vertices; None without it."""
        stored = attributes.get(name)
        if stored is None:
            return None
        values = self.accessor(stored, kinds)
        if len(values) != count:
            raise stored.error(f"must have {count} elements like POSITION, has {len(values)}")
        values = values.astype(np.float64)
        if not np.isfinite(values).all():
            raise stored.error("must be finite")
        return values

    def _stored(self, accessor: Tree, count: int, width: int) -> NDArray[Any]:
        kind = _component(accessor)
        view_index = accessor.get("bufferView")
        if view_index is None:  # the standard's zeros, under a sparse accessor
            most = self._document.limits.max_vertices // 16  # they cost nothing in the file
            check_at_most(count, most, "zeros without a bufferView", self._document.path)
            return np.zeros((count, width), kind)
        view = self._document.entry("bufferViews", view_index)
        tight = kind.itemsize * width
        stride = _integer(view, "byteStride", 0, 2**16) or tight
        if stride < tight:
            raise view.error(f"must have a byteStride of {tight} or more, has {stride}")
        return self._strided(accessor, view_index, count, width, kind, stride)

    def _strided(
        self,
        owner: Tree,
        view_index: Tree,
        count: int,
        width: int,
        kind: np.dtype[Any],
        stride: int,
    ) -> NDArray[Any]:
        data = self.view(view_index)
        offset = _integer(owner, "byteOffset", 0, MAX_BYTES)
        if offset + stride * (count - 1) + kind.itemsize * width > len(data):
            raise owner.error(f"must lie within its view of {len(data)} bytes")
        return np.ndarray(
            (count, width), kind, buffer=data, offset=offset, strides=(stride, kind.itemsize)
        )

    def _patched(self, stored: NDArray[Any], sparse: Tree) -> NDArray[Any]:
        """Some rows replaced (3.6.2.3)."""
        count = sparse.at("count").integer(1, len(stored))
        indices, values = sparse.at("indices"), sparse.at("values")
        kind = _component(indices)
        if kind.kind != "u":
            raise indices.error("must be unsigned integers")
        rows = self._strided(indices, indices.at("bufferView"), count, 1, kind, kind.itemsize)
        if int(rows.max()) >= len(stored):
            raise indices.error(f"must be below {len(stored)}, one is {int(rows.max())}")
        width = stored.shape[1]
        tight = stored.dtype.itemsize * width
        new = self._strided(values, values.at("bufferView"), count, width, stored.dtype, tight)
        patched = stored.copy()
        patched[rows[:, 0]] = new
        return patched

    def _buffer(self, index: Tree) -> memoryview:
        buffer = self._document.entry("buffers", index)
        if buffer.place not in self._known:
            data = self._load(buffer)
            length = buffer.at("byteLength").integer(1, MAX_BYTES)
            if len(data) < length:
                raise buffer.error(f"must have {length} bytes, has {len(data)}")
            self._known[buffer.place] = data[:length]
        return self._known[buffer.place]

    def _load(self, buffer: Tree) -> memoryview:
        document = self._document
        uri = buffer.get("uri")
        if uri is None:
            if document.binary is None or buffer.place != "buffers[0]":
                raise buffer.error("must have a uri, or be the first buffer of a GLB file")
            return document.binary
        check_at_most(
            len(self._known) + 1, document.limits.max_references, "buffers", document.path
        )
        data = self.resolve(uri)
        self._bytes += len(data)
        check_at_most(
            self._bytes, document.limits.max_file_bytes, "bytes in buffers", document.path
        )
        return data

    def resolve(self, uri: Tree) -> memoryview:
        """The bytes that a ``uri`` means: a data URI or a file beside this one."""
        text = uri.text()
        if text[:5].lower() == "data:":
            return memoryview(decode_data_uri(uri))
        path = confined(
            text, self._document.path.parent, file=self._document.path, percent_encoded=True
        )
        return memoryview(open_bounded(path, self._document.limits))


def decode_data_uri(uri: Tree) -> bytes:
    """The bytes in a data URI (RFC 2397), base64 or percent-encoded."""
    text = uri.text()
    match = DATA_URI.match(text)
    if match is None:
        raise uri.error("must be a sound data URI")
    body = text[match.end() :]
    try:
        if match[1]:
            return base64.b64decode(body.encode("ascii"), validate=True)
        return unquote_to_bytes(body.encode("ascii"))
    except (binascii.Error, ValueError) as error:
        raise uri.error("must be a sound data URI") from error


def _component(owner: Tree) -> np.dtype[Any]:
    code = owner.at("componentType").integer(0, 2**16)
    if code not in COMPONENTS:
        raise owner.error(f"must have a componentType of {sorted(COMPONENTS)}, has {code}")
    return np.dtype(COMPONENTS[code])


def _normalised(values: NDArray[Any]) -> NDArray[np.float64]:
    """Integers as fractions of their type's largest value (3.6.2.2); floats unchanged."""
    if values.dtype.kind == "f":
        return to_float64(values)
    return np.maximum(values / float(np.iinfo(values.dtype).max), -1.0)


def _integer(owner: Tree, key: str, default: int, most: int) -> int:
    found = owner.get(key)
    return default if found is None else found.integer(0, most)
