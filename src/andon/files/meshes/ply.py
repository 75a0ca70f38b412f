"""PLY meshes: ASCII and both binary orders, polygons as fans.

Normals (nx, ny, nz) and texture coordinates (s, t or u, v; v is up in the tools that write them,
so it is flipped) are kept. Vertex colours are not: a reflectance belongs to a material here.
Format: G. Turk, "The PLY Polygon File Format" (1994).
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.limits import DEFAULT_LIMITS, Limits, check_at_most
from andon.files.meshes.assemble import check_geometry, fan_triangles, unit_normals
from andon.files.meshes.model import MeshFile
from andon.files.meshes.ply_body import BinaryBody, Body, Element, Property, TextBody
from andon.files.paths import open_bounded
from andon.quantities import Geometry

__all__ = ["read_ply"]

TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2",
    "ushort": "u2", "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4",
    "float": "f4", "float32": "f4", "double": "f8", "float64": "f8",
}  # fmt: skip
ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">"}
INDEX_NAMES = ("vertex_indices", "vertex_index")
UV_NAMES = (("s", "t"), ("u", "v"), ("texture_u", "texture_v"))
MAX_COLUMNS = 256
END = re.compile(rb"^end_header[ \t]*(\r\n|\n|\r)", re.MULTILINE)


def read_ply(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> MeshFile:
    """A PLY file with a ``vertex`` and a ``face`` element."""
    data = open_bounded(path, limits)
    form, elements, start = _header(data, path, limits)
    if form == "ascii":
        check_at_most(len(data), limits.max_mesh_text_bytes, "bytes of text", path)
    body: Body = (
        TextBody(data[start:], str(path))
        if form == "ascii"
        else BinaryBody(data, start, ORDERS[form], str(path))
    )
    vertices: dict[str, NDArray[np.float64]] = {}
    counts, indices = np.empty(0, np.int64), np.empty(0)
    for element in elements:
        listed = [p.name for p in element.properties if p.count_kind]
        if element.name == "face":
            wanted = next((name for name in INDEX_NAMES if name in listed), None)
            if wanted is None:
                raise InputError("faces must have a list vertex_indices", file=path)
            counts, indices = body.lists(element, wanted)
        elif listed:
            body.lists(element, listed[0])
        else:
            columns = body.columns(element)
            vertices = columns if element.name == "vertex" else vertices
    return _assemble(vertices, counts, indices, str(path), limits)


def _assemble(
    vertices: dict[str, NDArray[np.float64]],
    counts: NDArray[np.int64],
    indices: NDArray[np.float64],
    file: str,
    limits: Limits,
) -> MeshFile:
    if not {"x", "y", "z"} <= vertices.keys():
        raise InputError("vertices must have x, y and z", file=file)
    if not len(counts):
        raise InputError("a mesh must have faces, this one has none", file=file)
    if counts.min() < 3:
        raise InputError(f"a face must have 3 corners or more, one has {counts.min()}", file=file)
    check_at_most(int((counts - 2).sum()), limits.max_triangles, "triangles", file)
    if (indices != np.floor(indices)).any() or (np.abs(indices) > 2**31).any():
        raise InputError("vertex indices must be whole numbers", file=file)
    triangles = indices.astype(np.int64)[fan_triangles(counts)[0]]
    positions = np.stack([vertices[axis] for axis in "xyz"], axis=-1)
    check_geometry(positions, triangles, file)
    normals = uvs = None
    if {"nx", "ny", "nz"} <= vertices.keys():
        stored = np.stack([vertices[f"n{axis}"] for axis in "xyz"], axis=-1)
        normals = unit_normals(stored, positions, triangles, file)
    for u, v in UV_NAMES:
        if uvs is None and {u, v} <= vertices.keys():
            uvs = np.nan_to_num(np.stack([vertices[u], 1.0 - vertices[v]], axis=-1))
    ids = np.zeros(len(triangles), np.int32)
    return MeshFile(Geometry(positions, triangles.astype(np.int32), normals, uvs, ids))


def _header(data: bytes, path: str | Path, limits: Limits) -> tuple[str, list[Element], int]:
    """The format, the elements and where the body starts."""
    if not data.startswith(b"ply"):
        raise InputError("must be a PLY file", file=path)
    end = END.search(data[: limits.max_header_bytes])
    if end is None:
        raise InputError("the header must end with end_header", file=path)
    form = ""
    tables: list[tuple[str, int, list[Property]]] = []
    for line in data[: end.start()].decode("latin-1").splitlines()[1:]:
        words = line.split()
        match words:
            case ["format", str(form), *_]:
                pass
            case ["element", name, count] if re.fullmatch(r"\d{1,10}", count):
                most = max(limits.max_vertices, limits.max_triangles)
                check_at_most(int(count), most, f"rows of {name[:20]}", path)
                tables.append((name, int(count), []))
            case ["property", kind, name] if tables and kind in TYPES:
                tables[-1][2].append(Property(name, TYPES[kind]))
            case ["property", "list", length, kind, name] if (
                tables and kind in TYPES and length in TYPES
            ):
                tables[-1][2].append(Property(name, TYPES[kind], TYPES[length]))
            case [] | ["comment" | "obj_info", *_]:
                pass
            case _:
                raise InputError(f"has a header line that is no PLY: {line[:60]!r}", file=path)
    if form not in ("ascii", *ORDERS):
        raise InputError(f"the format must be ascii or binary, got {form[:30]!r}", file=path)
    for name, _, columns in tables:
        names = {column.name for column in columns}
        if not 0 < len(columns) <= MAX_COLUMNS or len(names) != len(columns):
            raise InputError(f"{name} must have 1…{MAX_COLUMNS} distinct properties", file=path)
    return form, [Element(n, count, tuple(c)) for n, count, c in tables], end.end()
