"""Wavefront OBJ: polygons, with materials from .mtl files beside it.

Own reader, because the general ones get negative indices wrong or merge by position only. Lines
are sorted into kinds in one pass; numbers are then converted all at once by NumPy. Lines, points,
curves and surfaces are skipped. Format: Wavefront, "Object files" 3.0 (1995).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.limits import DEFAULT_LIMITS, Limits, check_at_most
from andon.files.meshes.assemble import (
    check_geometry,
    facet_normals,
    fan_triangles,
    parse_numbers,
    unit_normals,
)
from andon.files.meshes.model import MeshFile
from andon.files.meshes.mtl import read_materials
from andon.files.meshes.textures import TextureStore
from andon.files.paths import confined, open_bounded
from andon.quantities import Geometry, Material

__all__ = ["read_obj"]

Float = NDArray[np.float64]
Int = NDArray[np.int64]


@dataclass
class _Lines:
    """The lines of an OBJ file by kind, and for each face what had been read before it."""

    vertices: list[str] = field(default_factory=list[str])
    uvs: list[str] = field(default_factory=list[str])
    normals: list[str] = field(default_factory=list[str])
    faces: list[str] = field(default_factory=list[str])
    before: list[tuple[int, int, int]] = field(default_factory=list[tuple[int, int, int]])
    materials: list[int] = field(default_factory=list[int])
    material_names: list[str] = field(default_factory=list[str])
    libraries: list[str] = field(default_factory=list[str])
    names: list[str] = field(default_factory=list[str])


def read_obj(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> MeshFile:
    """An OBJ file; texture coordinates are flipped to v down, polygons cut into fans.

    A vertex is split where position, texture coordinate or normal differ. Faces without normals
    in a file that has some get their facet normal. A material that no library defines is gray.
    """
    path = Path(path)
    lines = _sort_lines(
        open_bounded(path, limits, max_bytes=limits.max_mesh_text_bytes), path, limits
    )
    counts, corners = _corners(lines, path)
    positions = _table(lines.vertices, 3, "v", path)
    uvs = _table(lines.uvs, 1, "vt", path)
    normals = _table(lines.normals, 3, "vn", path)
    _check_range(corners, (len(positions), len(uvs), len(normals)), path)

    chosen, face_of_triangle = fan_triangles(counts)
    check_at_most(len(chosen), limits.max_triangles, "triangles", path)
    if len(normals):
        corners, normals = _fill_normals(corners, counts, positions, normals)
    used, inverse = _unique_corners(corners, len(uvs), len(normals))
    triangles = inverse[chosen]
    points = positions[used[:, 0]]
    check_geometry(points, triangles, str(path))
    return MeshFile(
        Geometry(
            points,
            triangles.astype(np.int32),
            unit_normals(normals[used[:, 2]], points, triangles, str(path))
            if len(normals)
            else None,
            _flipped_uvs(uvs, used[:, 1]) if len(uvs) else None,
            np.asarray(lines.materials, np.int32)[face_of_triangle],
            _materials(lines, path, limits),
        ),
        names=tuple(lines.names),
    )


def _sort_lines(data: bytes, path: Path, limits: Limits) -> _Lines:
    text = data.decode("utf-8", errors="replace").replace("\\\r\n", " ").replace("\\\n", " ")
    out = _Lines()
    tables = {"v": out.vertices, "vt": out.uvs, "vn": out.normals}
    known: dict[str, int] = {}
    material = -1
    for line in text.splitlines():
        parts = line.split(None, 1)
        if len(parts) < 2:
            continue
        key, rest = parts
        if "#" in rest:
            rest = rest.split("#", 1)[0]
        if key in tables:
            tables[key].append(rest)
        elif key == "f":
            if material < 0:
                material = known.setdefault("", len(known))
            out.faces.append(rest)
            out.before.append((len(out.vertices), len(out.uvs), len(out.normals)))
            out.materials.append(material)
        elif key == "usemtl":
            material = known.setdefault(rest.strip(), len(known))
        elif key == "mtllib":
            out.libraries.append(rest.strip())
        elif key in ("o", "g"):
            out.names.append(rest.strip())
    for name, lines in (("vertices", out.vertices), ("faces", out.faces)):
        most = limits.max_vertices if name == "vertices" else limits.max_triangles
        check_at_most(len(lines), most, name, path)
    check_at_most(len(out.uvs) + len(out.normals), 2 * limits.max_vertices, "vt and vn", path)
    out.material_names = list(known)
    return out


def _table(lines: list[str], least: int, key: str, path: Path) -> Float:
    """(n, 3) of the first three numbers of each line; missing ones are 0."""
    if not lines:
        return np.empty((0, 3))
    lengths = {len(line.split()) for line in lines}
    if len(lengths) > 1:  # weights or colours on some lines only
        width = min(max(lengths), 3)
        lines = [" ".join((line.split() + ["0"] * width)[:width]) for line in lines]
    else:
        width = lengths.pop()
    try:
        values = parse_numbers(" ".join(lines), np.float64)
    except ValueError:
        values = np.empty(0)
    if (lengths and min(lengths) < least) or width < least or values.size != width * len(lines):
        raise InputError(f"every {key} line must have {least} numbers or more", file=path)
    out = np.zeros((len(lines), 3))
    out[:, : min(width, 3)] = values.reshape(-1, width)[:, :3]
    return out


def _corners(lines: _Lines, path: Path) -> tuple[Int, Int]:
    """Corners per face (f,) and 0-based (position, uv, normal) per corner (c, 3); −1 is none."""
    if not lines.faces:
        raise InputError("a mesh must have faces, this one has none", file=path)
    words = [line.split() for line in lines.faces]
    counts = np.array([len(face) for face in words], np.int64)
    if counts.min() < 3:
        raise InputError(
            f"a face must have 3 corners or more, face {int(counts.argmin())} has {counts.min()}",
            file=path,
        )
    flat = [word for face in words for word in face]
    raw = _indices(flat, path)
    if (raw < 0).any():
        # Negative indices count back from the last vertex read so far: −1 is the newest.
        before = np.repeat(np.asarray(lines.before, np.int64), counts, axis=0)
        raw = np.where(raw < 0, np.where(raw + before < 0, MISSING, raw + before + 1), raw)
    return counts, raw - 1


MISSING = 2**40  # an index that no table has: a negative one that reaches before the first line


def _indices(flat: list[str], path: Path) -> Int:
    """(c, 3) 1-based or negative indices as written; 0 is none. Forms: a, a/b, a//c, a/b/c."""
    out = np.zeros((len(flat), 3), np.int64)
    forms = np.array([word.count("/") + (word.count("//") << 4) for word in flat])
    for form, columns in ((0, [0]), (1, [0, 1]), (2, [0, 1, 2]), (18, [0, 2])):
        rows = np.flatnonzero(forms == form)
        if not len(rows):
            continue
        chosen = flat if len(rows) == len(flat) else [flat[row] for row in rows]
        text = " ".join(chosen).replace("//", " ").replace("/", " ")
        try:
            values = parse_numbers(text, np.int64)
        except ValueError:
            values = np.empty(0, np.int64)
        if values.size != len(rows) * len(columns):
            raise InputError("face corners must be like 1, 1/2, 1//3 or 1/2/3", file=path)
        if (values == 0).any():
            raise InputError("indices count from 1 (or back from −1), one is 0", file=path)
        out[rows[:, None], np.array(columns)] = values.reshape(-1, len(columns))
        forms[rows] = -1
    if (forms != -1).any():
        raise InputError("face corners must be like 1, 1/2, 1//3 or 1/2/3", file=path)
    return out


def _check_range(corners: Int, sizes: tuple[int, int, int], path: Path) -> None:
    for column, (name, size) in enumerate(zip(("v", "vt", "vn"), sizes, strict=True)):
        top = int(corners[:, column].max())
        if top >= size:
            shown = "beyond the first" if top >= MISSING - 1 else str(top + 1)
            raise InputError(f"{name} indices must be 1…{size}, one is {shown}", file=path)


def _fill_normals(corners: Int, counts: Int, positions: Float, normals: Float) -> tuple[Int, Float]:
    """Give faces with a corner without normal their facet normal."""
    starts = np.cumsum(counts) - counts
    lacking = np.minimum.reduceat(corners[:, 2], starts) < 0
    if not lacking.any():
        return corners, normals
    first = corners[starts[lacking][:, None] + np.arange(3), 0]
    facets = facet_normals(positions, first)
    of_face = np.full(len(counts), -1, np.int64)
    of_face[lacking] = len(normals) + np.arange(len(facets))
    of_corner = np.repeat(of_face, counts)
    corners = corners.copy()
    corners[:, 2] = np.where(of_corner >= 0, of_corner, corners[:, 2])
    return corners, np.concatenate([normals, facets])


def _unique_corners(corners: Int, uvs: int, normals: int) -> tuple[Int, Int]:
    """Distinct rows (n, 3) and the row of each corner (c,); two steps keep the keys in 64 bits."""
    pairs = corners[:, 0] * (uvs + 1) + corners[:, 1] + 1
    _, inverse = np.unique(pairs, return_inverse=True)
    triples = inverse.reshape(-1) * (normals + 1) + corners[:, 2] + 1
    _, first, inverse = np.unique(triples, return_index=True, return_inverse=True)
    return corners[first], inverse.reshape(-1)


def _flipped_uvs(uvs: Float, chosen: Int) -> Float:
    """(n, 2) with v down; corners without a texture coordinate get (0, 0)."""
    flipped = np.stack([uvs[:, 0], 1.0 - uvs[:, 1]], axis=-1)
    out = np.where(chosen[:, None] >= 0, flipped[chosen], 0.0)
    return np.nan_to_num(out, nan=0.0, posinf=0.0, neginf=0.0)


def _materials(lines: _Lines, path: Path, limits: Limits) -> tuple[Material, ...]:
    textures = TextureStore(path, limits)
    found: dict[str, Material] = {}
    check_at_most(len(lines.libraries), limits.max_references, "material libraries", path)
    for library in dict.fromkeys(lines.libraries):
        source = confined(library, path.parent, file=path)
        found.update(read_materials(source, textures, limits))
    return tuple(found.get(name, Material(name)) for name in lines.material_names)
