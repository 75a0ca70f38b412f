"""OBJ and PLY: polygons, indices, seams, materials, both byte orders."""

from __future__ import annotations

import struct
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from andon.errors import InputError
from andon.files import DEFAULT_LIMITS, read_mesh
from andon.quantities import Geometry

from .specimens import MTL, OBJ, PLY, pillow_bytes, png16, rgb


def put(folder: Path, name: str, data: bytes | str) -> Path:
    path = folder / name
    path.write_bytes(data.encode() if isinstance(data, str) else data)
    return path


def areas(mesh: Geometry) -> np.ndarray:
    a, b, c = (mesh.positions[mesh.triangles[:, i]] for i in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=-1) / 2


def corner_points(mesh: Geometry) -> np.ndarray:
    return mesh.positions[mesh.triangles]


CUBE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"


def test_the_specimen_in_full(tmp_path: Path) -> None:
    texture = rgb().astype(np.uint8)
    put(tmp_path, "t.png", pillow_bytes(texture, "PNG"))
    put(tmp_path, "m.mtl", MTL)
    mesh = read_mesh(put(tmp_path, "a.obj", OBJ))
    geometry = mesh.geometry
    np.testing.assert_array_equal(
        corner_points(geometry),
        [
            [[0, 0, 0], [2, 0, 0], [2, 1, 0]],
            [[0, 0, 0], [2, 1, 0], [0, 1, 0]],
            [[0, 1, 0], [2, 1, 0], [1, 2, 0]],  # −2, −3, −1 counted back from the hat's vertex
        ],
    )
    assert geometry.uvs is not None
    assert geometry.normals is not None
    # v is up in OBJ and down here: (0, 0) of the file is the lower left corner.
    np.testing.assert_array_equal(geometry.uvs[geometry.triangles[0]], [[0, 1], [1, 1], [1, 0]])
    np.testing.assert_array_equal(
        geometry.normals, np.tile([0.0, 0, 1], (len(geometry.normals), 1))
    )
    material = geometry.materials[0]
    assert (material.name, material.reflectance) == ("paper", (0.2, 0.4, 0.6))
    assert material.emissive_cd_m2 == (1.0, 2.0, 3.0)
    assert material.extensions == {"mtl": {"d": 0.5}}
    np.testing.assert_array_equal(material.texture, texture)
    assert mesh.names == ("square",)
    assert geometry.triangles.dtype == np.int32
    assert geometry.positions.dtype == np.float64


def test_negative_and_positive_indices_mean_the_same(tmp_path: Path) -> None:
    faces = [(1, 2, 3, 4), (5, 6, 7, 8)]
    plain = CUBE + "".join("f " + " ".join(map(str, face)) + "\n" for face in faces)
    negative = CUBE + "".join("f " + " ".join(str(i - 9) for i in face) + "\n" for face in faces)
    lines = CUBE.splitlines(keepends=True)
    woven = "".join(lines[:4]) + "f -4 -3 -2 -1\n" + "".join(lines[4:]) + "f -4 -3 -2 -1\n"
    meshes = [read_mesh(put(tmp_path, "a.obj", text)).geometry for text in (plain, negative, woven)]
    for mesh in meshes[1:]:
        np.testing.assert_array_equal(corner_points(mesh), corner_points(meshes[0]))


@pytest.mark.parametrize("corners", range(3, 9))
def test_polygons_keep_their_area(corners: int, tmp_path: Path) -> None:
    angles = np.arange(corners) / corners * 2 * np.pi
    text = "".join(f"v {np.cos(a)} {np.sin(a)} 0\n" for a in angles)
    text += "f " + " ".join(str(i + 1) for i in range(corners)) + "\n"
    mesh = read_mesh(put(tmp_path, "a.obj", text)).geometry
    assert len(mesh.triangles) == corners - 2
    assert areas(mesh).sum() == pytest.approx(corners / 2 * np.sin(2 * np.pi / corners))


def test_mixed_forms_in_one_file(tmp_path: Path) -> None:
    text = CUBE + "vt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\nvn 0 0 -3\n"
    text += "f 1 2 3\nf 1/1 2/2 3/3\nf 1//1 2//1 3//1\nf 1/1/2 2/2/2 3/3/2\n"
    mesh = read_mesh(put(tmp_path, "a.obj", text)).geometry
    assert mesh.uvs is not None
    assert mesh.normals is not None
    points = corner_points(mesh)
    for triangle in range(1, 4):
        np.testing.assert_array_equal(points[triangle], points[0])
    normals = mesh.normals[mesh.triangles][:, 0]
    # Faces without normals have their own, lengths become 1.
    np.testing.assert_array_equal(normals, [[0, 0, 1], [0, 0, 1], [0, 0, 1], [0, 0, -1]])
    np.testing.assert_array_equal(mesh.uvs[mesh.triangles[1]], [[0, 1], [1, 1], [1, 0]])


def test_vertices_are_split_at_seams_and_nowhere_else(tmp_path: Path) -> None:
    text = CUBE + "vt 0 0\nvt 1 1\n"
    shared = read_mesh(put(tmp_path, "a.obj", text + "f 1/1 2/1 3/1\nf 1/1 3/1 4/1\n")).geometry
    assert len(shared.positions) == 4
    seam = read_mesh(put(tmp_path, "b.obj", text + "f 1/1 2/1 3/1\nf 1/2 3/1 4/1\n")).geometry
    assert len(seam.positions) == 5
    plain = read_mesh(put(tmp_path, "c.obj", CUBE + "f 1 2 3\nf 1 3 4\n")).geometry
    assert plain.normals is None
    assert plain.uvs is None


def test_materials_by_face(tmp_path: Path) -> None:
    put(tmp_path, "a b.mtl", "newmtl red wall\nKd 0.6 0.1 0.1\n\nnewmtl lamp\n\tKe 5\n")
    text = "mtllib a b.mtl\n" + CUBE + "f 1 2 3\nusemtl red wall\nf 1 2 3\nusemtl lamp\n"
    text += "f 1 2 3 4\nusemtl red wall\nf 1 2 3\nusemtl unknown\nf 1 2 3\n"
    mesh = read_mesh(put(tmp_path, "a.obj", text)).geometry
    assert mesh.material_ids is not None
    names = [mesh.materials[i].name for i in mesh.material_ids]
    assert names == ["", "red wall", "lamp", "lamp", "red wall", "unknown"]
    assert mesh.materials[1].reflectance == (0.6, 0.1, 0.1)
    assert mesh.materials[2].emissive_cd_m2 == (5.0, 5.0, 5.0)
    assert mesh.materials[3].reflectance == (0.5, 0.5, 0.5)


def test_continued_lines_comments_weights_and_other_elements(tmp_path: Path) -> None:
    text = "# c\nv 0 0 0 1\nv 1 0 0 # here\nv 1 1 0 0.1 0.2 0.3\n"
    text += "l 1 2\np 1\ns off\nf 1 \\\r\n2 3 # x\n"
    mesh = read_mesh(put(tmp_path, "a.obj", text)).geometry
    np.testing.assert_array_equal(corner_points(mesh), [[[0, 0, 0], [1, 0, 0], [1, 1, 0]]])


@pytest.mark.parametrize(
    ("line", "name"),
    [
        ("map_Kd t.png", "t.png"),
        ("map_kd -clamp on -s 1 1 1 -o 0 0 t.png", "t.png"),
        ("map_Kd  my texture.png", "my texture.png"),
        ("map_Kd sub\\t.png", "sub/t.png"),
        ("map_Kd -bm 0.5 2.png", "2.png"),
    ],
)
def test_texture_lines(line: str, name: str, tmp_path: Path) -> None:
    (tmp_path / "sub").mkdir()
    put(tmp_path, name, pillow_bytes(rgb().astype(np.uint8), "PNG"))
    put(tmp_path, "m.mtl", f"newmtl m\n{line}\n")
    mesh = read_mesh(put(tmp_path, "a.obj", "mtllib m.mtl\nusemtl m\n" + CUBE + "f 1 2 3\n"))
    material = mesh.geometry.materials[0]
    assert material.texture is not None
    assert material.reflectance == (1.0, 1.0, 1.0)  # no Kd: the texture alone


def test_16_bit_textures_become_linear(tmp_path: Path) -> None:
    put(tmp_path, "t.png", png16(np.full((2, 2, 3), 65535 // 2)))
    put(tmp_path, "m.mtl", "newmtl m\nmap_Kd t.png\n")
    mesh = read_mesh(put(tmp_path, "a.obj", "mtllib m.mtl\nusemtl m\n" + CUBE + "f 1 2 3\n"))
    texture = mesh.geometry.materials[0].texture
    assert texture is not None
    assert texture.dtype == np.float32
    np.testing.assert_allclose(texture, 0.21404, atol=1e-4)  # sRGB's inverse of ½


@pytest.mark.parametrize(
    ("text", "match"),
    [
        (CUBE, "must have faces"),
        ("# nothing\n", "must have faces"),
        (CUBE + "f 1 2\n", "3 corners or more, face 0 has 2"),
        (CUBE + "f 1 2 9\n", "v indices must be 1…8, one is 9"),
        (CUBE + "f 1 2 -9\n", "v indices must be 1…8"),
        (CUBE + "f 0 1 2\n", "count from 1"),
        (CUBE + "f 1/1 2/1 3/1\n", "vt indices must be 1…0"),
        (CUBE + "f 1//1 2//1 3//1\n", "vn indices"),
        (CUBE + "f 1 2 x\n", "face corners must be like"),
        (CUBE + "f 1/ 2/ 3/\n", "face corners must be like"),
        (CUBE + "f 1/1/1/1 2 3\n", "face corners must be like"),
        (CUBE + "f 1.5 2 3\n", "face corners must be like"),
        (CUBE + "f 99999999999999999999 2 3\n", "v indices"),
        ("v 0 0\nv 1 0\nv 1 1\nf 1 2 3\n", "every v line must have 3"),
        ("v 0 0 a\nv 1 0 0\nv 1 1 0\nf 1 2 3\n", "every v line"),
        ("v 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n", "every v line"),
        ("v nan 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n", "positions must be finite, vertex 0"),
        (CUBE + "vn 0 0 0\nf 1//1 2//1 3//1\n", "normals must be finite and not zero, 1 triangles"),
        ("mtllib no.mtl\n" + CUBE + "f 1 2 3\n", "no.mtl: must exist"),
    ],
)
def test_bad_obj_files_are_refused(text: str, match: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=match):
        read_mesh(put(tmp_path, "a.obj", text))


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("newmtl m\nKd 1.2 0 0\n", "reflectance in 0…1"),
        ("newmtl m\nKd -1 0 0\n", "numbers ≥ 0"),
        ("newmtl m\nKd 1 1\n", "three numbers"),
        ("newmtl m\nKd spectral a.rfl\n", "finite numbers"),
        ("newmtl m\nmap_Kd no.png\n", "no.png: must exist"),
        ("newmtl m\nmap_Kd t.tga\n", r"must be one of \.exr"),
        ("newmtl m\nmap_Kd -s 2 2 1 t.png\n", "moved or scaled by -s"),
        ("newmtl m\nmap_Kd\tt.png\nNi x\n", "Ni must be finite numbers"),
    ],
)
def test_bad_materials_are_refused(text: str, match: str, tmp_path: Path) -> None:
    put(tmp_path, "t.png", pillow_bytes(rgb().astype(np.uint8), "PNG"))
    put(tmp_path, "m.mtl", text)
    with pytest.raises(InputError, match=match):
        read_mesh(put(tmp_path, "a.obj", "mtllib m.mtl\nusemtl m\n" + CUBE + "f 1 2 3\n"))


def test_degenerate_triangles_are_kept_even_with_zero_normals(tmp_path: Path) -> None:
    text = CUBE + "vn 0 0 0\nvn 0 0 2\nf 1//2 2//2 3//2\nf 1//1 1//1 2//1\n"
    mesh = read_mesh(put(tmp_path, "a.obj", text)).geometry
    assert len(mesh.triangles) == 2
    assert mesh.normals is not None
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=-1), 1.0)


def test_limits_are_kept(tmp_path: Path) -> None:
    path = put(tmp_path, "a.obj", CUBE + "f 1 2 3 4\n")
    from andon.files import reader_for

    for limits, match in (
        (replace(DEFAULT_LIMITS, max_triangles=1), "triangles"),
        (replace(DEFAULT_LIMITS, max_vertices=7), "vertices"),
        (replace(DEFAULT_LIMITS, max_mesh_text_bytes=10), "bytes"),
    ):
        with pytest.raises(InputError, match=f"at most .* {match}"):
            reader_for(path, "mesh").read(path, limits=limits)
    put(tmp_path, "t.png", pillow_bytes(rgb().astype(np.uint8), "PNG"))
    put(tmp_path, "m.mtl", "newmtl m\nmap_Kd t.png\n")
    path = put(tmp_path, "a.obj", "mtllib m.mtl\nusemtl m\n" + CUBE + "f 1 2 3\n")
    with pytest.raises(InputError, match="at most 53 pixels"):
        read_mesh(path, limits=replace(DEFAULT_LIMITS, max_total_pixels=53))


def test_70_000_triangles_are_read_in_good_time(tmp_path: Path) -> None:
    n = 188
    rows, columns = np.mgrid[0:n, 0:n]
    text = ["".join(f"v {x} 0.25 {y}\n" for x, y in zip(columns.flat, rows.flat, strict=True))]
    text.append(
        "".join(f"vt {x / n} {y / n}\n" for x, y in zip(columns.flat, rows.flat, strict=True))
    )
    text.append("vn 0 1 0\n")
    corner = (rows[:-1, :-1] * n + columns[:-1, :-1] + 1).ravel()
    quads = np.stack([corner, corner + n, corner + n + 1, corner + 1], axis=-1)
    text.append("".join("f " + " ".join(f"{i}/{i}/1" for i in quad) + "\n" for quad in quads))
    path = put(tmp_path, "grid.obj", "".join(text))
    started = time.perf_counter()
    mesh = read_mesh(path).geometry
    assert time.perf_counter() - started < 2
    assert len(mesh.triangles) == 2 * (n - 1) ** 2
    assert len(mesh.positions) == n * n
    assert areas(mesh).sum() == pytest.approx((n - 1) ** 2)


PLY_HEAD = """ply
format {form} 1.0
comment made by hand
element camera 1
property float tilt
element vertex 5
property float x
property double y
property short z
property uchar red
property float {u}
property float {v}
element face {faces}
property uchar flags
property list {count} {kind} {indices}
end_header
"""
POINTS = [(0, 0, 0), (2, 0, 0), (2, 1, 0), (0, 1, 0), (1, 0.5, 3)]
UVS = [(0, 0), (1, 0), (1, 1), (0, 1), (0.5, 0.5)]


def ply_bytes(form: str, faces: list[tuple[int, ...]], kind: str = "int", u: str = "s") -> bytes:
    head = PLY_HEAD.format(
        form=form, faces=len(faces), count="uchar", kind=kind,
        indices="vertex_indices" if u == "s" else "vertex_index", u=u, v={"s": "t", "u": "v"}[u],
    ).encode()  # fmt: skip
    if form == "ascii":
        lines = ["0.5"]
        lines += [f"{x} {y} {z} 9 {s} {t}" for (x, y, z), (s, t) in zip(POINTS, UVS, strict=True)]
        lines += [f"1 {len(face)} {' '.join(map(str, face))}" for face in faces]
        return head + "\n".join(lines).encode()
    order = "<" if "little" in form else ">"
    body = struct.pack(order + "f", 0.5)
    for (x, y, z), (s, t) in zip(POINTS, UVS, strict=True):
        body += struct.pack(order + "fdhBff", x, y, z, 9, s, t)
    for face in faces:
        code = {"int": "i", "ushort": "H", "uint": "I"}[kind]
        body += struct.pack(f"{order}BB{len(face)}{code}", 1, len(face), *face)
    return head + body


@pytest.mark.parametrize("form", ["ascii", "binary_little_endian", "binary_big_endian"])
@pytest.mark.parametrize("kind", ["int", "uint", "ushort"])
@pytest.mark.parametrize("u", ["s", "u"])
@pytest.mark.parametrize("faces", [[(0, 1, 2), (0, 2, 4)], [(0, 1, 2, 3), (0, 1, 4)]])
def test_ply_forms_agree(
    form: str, kind: str, u: str, faces: list[tuple[int, ...]], tmp_path: Path
) -> None:
    mesh = read_mesh(put(tmp_path, "a.ply", ply_bytes(form, faces, kind, u))).geometry
    np.testing.assert_array_equal(mesh.positions, np.array(POINTS, float))
    expected = [[f[0], f[i], f[i + 1]] for f in faces for i in range(1, len(f) - 1)]
    np.testing.assert_array_equal(mesh.triangles, expected)
    assert mesh.uvs is not None
    np.testing.assert_array_equal(mesh.uvs, np.array(UVS) * [1, -1] + [0, 1])  # v turned down
    assert mesh.normals is None


def test_ply_normals(tmp_path: Path) -> None:
    mesh = read_mesh(put(tmp_path, "a.ply", PLY.replace(b"0 0 0 0 0 1", b"0 0 0 0 0 5"))).geometry
    assert mesh.normals is not None
    np.testing.assert_array_equal(mesh.normals, np.tile([0.0, 0, 1], (4, 1)))


@pytest.mark.parametrize(
    ("old", "new", "match"),
    [
        (b"3 0 2 3\n", b"", "cut short"),
        (b"3 0 2 3", b"3 0 2 4", "vertex indices must be 0…3, one is 4"),
        (b"3 0 2 3", b"3 0 2 -1", "vertex indices must be 0…3, one is -1"),
        (b"3 0 2 3", b"3 0 2 1.5", "whole numbers"),
        (b"3 0 2 3", b"3 0 2 inf", "whole numbers"),
        (b"3 0 2 3", b"2 0 2", "3 corners or more, one has 2"),
        (b"3 0 2 3", b"-3 0 2", "sound rows of face"),
        (b"3 0 2 3", b"3 0 2 x", "numbers after the header"),
        (b"2 0 0", b"nan 0 0", "positions must be finite"),
        (b"0 0 1\n3", b"0 0 0\n3", "normals must be finite and not zero"),
        (b"element face 2", b"element face 0", "must have faces"),
        (b"property float x", b"property float q", "x, y and z"),
        (b"vertex_indices", b"something", "vertex_indices"),
        (b"format ascii 1.0", b"format text 1.0", "ascii or binary"),
        (b"element vertex 4", b"element vertex many", "no PLY"),
        (b"property float nx", b"property half nx", "no PLY"),
        (b"property float nx", b"property float x", "distinct"),
        (b"end_header", b"end", "end_header"),
        (b"element face 2", b"element face 99999999", "at most"),
    ],
)
def test_bad_ply_files_are_refused(old: bytes, new: bytes, match: str, tmp_path: Path) -> None:
    assert old in PLY
    with pytest.raises(InputError, match=match):
        read_mesh(put(tmp_path, "a.ply", PLY.replace(old, new)))


def test_real_obj_files(data_dir: Path) -> None:
    box = read_mesh(data_dir / "cornell_mcguire/CornellBox-Original.obj").geometry
    # Negative indices and quads: the known bounds of the room of 2 × 2 × 2 units.
    np.testing.assert_allclose(box.positions.min(0), [-1.02, 0, -1.04])
    np.testing.assert_allclose(box.positions.max(0), [1.0, 1.99, 0.99])
    lamps = [m for m in box.materials if max(m.emissive_cd_m2) > 0]
    assert [lamp.emissive_cd_m2 for lamp in lamps] == [(17.0, 12.0, 4.0)]
    started = time.perf_counter()
    sponza = read_mesh(data_dir / "sponza_dabrovic/sponza.obj").geometry
    assert time.perf_counter() - started < 2
    assert len(sponza.triangles) == 66_450
    assert len(sponza.materials) == 14
    assert all(m.texture is not None for m in sponza.materials if "skap" in m.name)
    sibenik = read_mesh(data_dir / "sibenik_dabrovic/sibenik.obj").geometry
    assert len(sibenik.triangles) == 75_284
    lantern = read_mesh(data_dir / "japanese_room_cc0/JapaneseLantern/JapaneseLantern.obj").geometry
    np.testing.assert_allclose(np.ptp(lantern.positions, axis=0), [15.6, 35, 15.6], atol=0.2)  # cm
