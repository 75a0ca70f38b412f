"""A small valid file for every registered reader, and the bytes of formats built by hand."""

from __future__ import annotations

import io
import json
import struct
import zlib
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
from PIL import Image

from andon.files import write_camera, write_exr, write_volume
from andon.spaces import View
from gaze_files import EYELINK, own_gaze
from map_files import small_maps
from photometry_files import ies, ldt
from volume_files import two_rooms

RNG_SEED = 7


def rgb(height: int = 6, width: int = 9, top: int = 255) -> np.ndarray:
    return np.random.default_rng(RNG_SEED).integers(0, top + 1, (height, width, 3))


def pillow_bytes(array: np.ndarray, kind: str, **options: object) -> bytes:
    stream = io.BytesIO()
    Image.fromarray(array).save(stream, format=kind, **options)
    return stream.getvalue()


def png_chunk(kind: bytes, body: bytes) -> bytes:
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))


def png_header(width: int, height: int, depth: int = 8, colour: int = 2) -> bytes:
    head = struct.pack(">IIBBBBB", width, height, depth, colour, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + png_chunk(b"IHDR", head)


def png16(array: np.ndarray) -> bytes:
    stored = array[..., ::-1] if array.ndim == 3 and array.shape[2] == 3 else array
    return cv2.imencode(".png", np.ascontiguousarray(stored, np.uint16))[1].tobytes()


def rgbe_pixels(height: int = 3, width: int = 9) -> np.ndarray:
    pixels = np.random.default_rng(RNG_SEED).integers(2, 256, (height, width, 4)).astype(np.uint8)
    pixels[..., 3] = 128 + pixels[..., 3] % 8
    return pixels


def hdr_header(height: int, width: int, *lines: str, form: str = "32-bit_rle_rgbe") -> bytes:
    head = ["#?RADIANCE", *lines, f"FORMAT={form}", "", f"-Y {height} +X {width}"]
    return ("\n".join(head) + "\n").encode()


def hdr_new_rle(pixels: np.ndarray) -> bytes:
    """Scanlines in the new scheme: literal codes, and a run where a plane is constant."""
    out = b""
    for line in pixels:
        out += struct.pack(">BBH", 2, 2, len(line))
        for plane in line.T:
            if (plane == plane[0]).all():
                out += bytes([128 + len(plane), plane[0]])
            else:
                out += bytes([len(plane)]) + plane.tobytes()
    return out


def huge_exr(side: int) -> bytes:
    """A header written out by hand: OpenEXR would not write one."""

    def attribute(name: bytes, kind: bytes, value: bytes) -> bytes:
        return name + b"\0" + kind + b"\0" + len(value).to_bytes(4, "little") + value

    window = np.array([0, 0, side - 1, side - 1], "<i4").tobytes()
    one = np.float32(1).tobytes()
    channels = b"".join(
        name + b"\0" + np.array([2, 0, 1, 1], "<i4").tobytes() for name in (b"B", b"G", b"R")
    )
    return (
        b"\x76\x2f\x31\x01\x02\0\0\0"
        + attribute(b"channels", b"chlist", channels + b"\0")
        + attribute(b"compression", b"compression", b"\x03")
        + attribute(b"dataWindow", b"box2i", window)
        + attribute(b"displayWindow", b"box2i", window)
        + attribute(b"lineOrder", b"lineOrder", b"\0")
        + attribute(b"pixelAspectRatio", b"float", one)
        + attribute(b"screenWindowCenter", b"v2f", b"\0" * 8)
        + attribute(b"screenWindowWidth", b"float", one)
        + b"\0" * 1000
    )


# sRGB's and Adobe RGB's primaries adapted to D50 (both from their published profiles).
SRGB_D50 = np.array([[0.4361, 0.3851, 0.1431], [0.2225, 0.7169, 0.0606], [0.0139, 0.0971, 0.7141]])
ADOBE_D50 = np.array([[0.6097, 0.2053, 0.1492], [0.3111, 0.6257, 0.0632], [0.0195, 0.0609, 0.7446]])
GAMMA_1 = b"curv\0\0\0\0" + struct.pack(">I", 0)
GAMMA_2_2 = b"curv\0\0\0\0" + struct.pack(">IH", 1, 563)  # 2.19921875 as Adobe RGB


def matrix_profile(
    columns: np.ndarray = ADOBE_D50, curve: bytes = GAMMA_2_2, space: bytes = b"RGB "
) -> bytes:
    """An ICC v2 display profile with the given XYZ columns (PCS, D50) and one tone curve."""

    def xyz(values: np.ndarray) -> bytes:
        return b"XYZ \0\0\0\0" + struct.pack(">3i", *np.rint(np.array(values) * 65536).astype(int))

    name = b"test profile\0"
    described = b"desc\0\0\0\0" + struct.pack(">I", len(name)) + name + bytes(78)
    tags = {b"desc": described, b"cprt": b"text\0\0\0\0free\0",
            b"wtpt": xyz(np.array([0.9642, 1.0, 0.8249]))}  # fmt: skip
    if space == b"GRAY":
        tags[b"kTRC"] = curve
    else:
        for i, letter in enumerate((b"r", b"g", b"b")):
            tags[letter + b"XYZ"] = xyz(columns[:, i])
            tags[letter + b"TRC"] = curve
    table, body = b"", b""
    start = 128 + 4 + 12 * len(tags)
    for key, value in tags.items():
        table += struct.pack(">4sII", key, start + len(body), len(value))
        body += value + bytes(-len(value) % 4)
    size = start + len(body)
    head = struct.pack(">I4sI4s4s4s12s4s", size, bytes(4), 0x02400000, b"mntr", space, b"XYZ ",
                       bytes(12), b"acsp").ljust(68, b"\0")  # fmt: skip
    head += struct.pack(">3i", 63190, 65536, 54061)
    return head.ljust(128, b"\0") + struct.pack(">I", len(tags)) + table + body


def pfm(values: np.ndarray, order: str = "<") -> bytes:
    head = f"Pf\n{values.shape[1]} {values.shape[0]}\n{-1.0 if order == '<' else 1.0}\n"
    return head.encode() + values[::-1].astype(f"{order}f4").tobytes()


def pgm(values: np.ndarray, maximum: int = 65535) -> bytes:
    kind = ">u2" if maximum > 255 else "u1"
    head = f"P5\n# a comment\n{values.shape[1]} {values.shape[0]}\n{maximum}\n"
    return head.encode() + values.astype(kind).tobytes()


def npy(values: np.ndarray) -> bytes:
    stream = io.BytesIO()
    np.save(stream, values)
    return stream.getvalue()


def npz(**arrays: np.ndarray) -> bytes:
    stream = io.BytesIO()
    np.savez_compressed(stream, **arrays)
    return stream.getvalue()


QUAD = np.array([[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]], np.float32)
QUAD_UV = np.array([[0, 1], [1, 1], [1, 0], [0, 0]], np.float32)

OBJ = b"""# a square with a hat
mtllib m.mtl
o square
v 0 0 0
v 2 0 0
v 2 1 0
v 0 1 0
vt 0 0
vt 1 0
vt 1 1
vt 0 1
vn 0 0 1
usemtl paper
f 1/1/1 2/2/1 3/3/1 4/4/1
v 1 2 0
f -2//-1 -3//-1 -1//-1
"""
MTL = b"newmtl paper\nKd 0.2 0.4 0.6\nKe 1 2 3\nd 0.5\nmap_Kd t.png\n"

PLY = b"""ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
property float nx
property float ny
property float nz
element face 2
property list uchar int vertex_indices
end_header
0 0 0 0 0 1
2 0 0 0 0 1
2 1 0 0 0 1
0 1 0 0 0 1
3 0 1 2
3 0 2 3
"""

GAPS_CSV = b"""azimuth_degrees,elevation_degrees,diameter_degrees
3.5,12.0,0.2
-4.0,9.5,0.35
"""
GAPS_JSON = (
    b'[{"azimuth_degrees": 3.5, "elevation_degrees": 12.0, "diameter_degrees": 0.2}, '
    b'{"azimuth_degrees": -4, "elevation_degrees": 9.5, "diameter_degrees": 0.35}]'
)
HARMONICS_JSON = (
    b'{"coefficients_cd_m2": [[282, 270, 255], [35, 30, 24], [-8, -7, -6], [12, 11, 9], [1, 1, 1], '
    b"[2, 2, 2], [-3, -3, -2], [0, 0.5, 0], [4, 4, 3]]}"
)
EXPOSURE_LIST = b"""# Filename exposure 1/shutter_speed f/stop gain(db) ND_filters
bright.png 2 0.5 8 0 0
middle.png 0.5 2 8 0 0
dark.png   0.125 8 8 0 0
"""

RAD = b"""# a lamp of measured light on a table
void brightdata measured
5 corr d.dat source.cal src_theta src_phi2
0
1 1

measured light glowing
0
0
3 100 90 80

glowing sphere bulb 0 0 4 0 1 0 .05
void plastic wood 0 0 5 .3 .2 .1 0 0
void alias oak wood
oak polygon table
0
0
12
 0 0 0
 0 0 1
 1 0 1
 1 0 0
"""

RESPONSE_CSV = b"""encoded,linear_r,linear_g,linear_b
0,0,0,0
0.5,0.2,0.21,0.22
1,1,1,1
"""

SURFACE_RESPONSE_CSV = b"""# paper
illuminance_lux,linear_r,linear_g,linear_b
0,0.001,0.001,0.0012
120,0.061,0.048,0.03
480,0.236,0.19,0.113
"""

CAMERA_YAML = b"""%YAML:1.0
---
image_width: 640
image_height: 480
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 500., 0., 320., 0., 510., 240., 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ 0.1, -0.2, 0.001, 0.002, 0.05 ]
"""


def gltf_json(buffer_uri: str | None = "q.bin") -> dict[str, object]:
    """The quad as glTF: float positions, u8 indices, one textured material, a lamp."""
    buffer: dict[str, object] = {"byteLength": 86}
    if buffer_uri is not None:
        buffer["uri"] = buffer_uri
    return {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0, 1]}],
        "nodes": [
            {"name": "quad", "mesh": 0, "translation": [0, 0, -1]},
            {"name": "lamp", "extensions": {"KHR_lights_punctual": {"light": 0}}},
        ],
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {
            "KHR_lights_punctual": {"lights": [{"type": "spot", "intensity": 60, "spot": {}}]}
        },
        "meshes": [
            {
                "primitives": [
                    {"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}
                ]
            }
        ],
        "materials": [
            {
                "name": "paper",
                "pbrMetallicRoughness": {"baseColorFactor": [0.2, 0.4, 0.6, 1.0]},
                "emissiveFactor": [1, 0.5, 0],
                "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 100}},
            }
        ],
        "buffers": [buffer],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 32},
            {"buffer": 0, "byteOffset": 80, "byteLength": 6},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
            {"bufferView": 2, "componentType": 5121, "count": 6, "type": "SCALAR"},
        ],
    }


GLTF_BINARY = QUAD.tobytes() + QUAD_UV.tobytes() + bytes([0, 1, 2, 0, 2, 3])


def glb(document: dict[str, object], binary: bytes) -> bytes:
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    body = struct.pack("<I4s", len(text), b"JSON") + text
    body += struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body


def _write(data: bytes) -> Callable[[Path], None]:
    def write(path: Path) -> None:
        path.write_bytes(data)

    return write


def _exr(path: Path) -> None:
    write_exr(path, rgb().astype(np.float32) / 255, unit="lx")


def _obj(path: Path) -> None:
    path.write_bytes(OBJ)
    (path.parent / "m.mtl").write_bytes(MTL)
    (path.parent / "t.png").write_bytes(pillow_bytes(rgb().astype(np.uint8), "PNG"))


def _gltf(path: Path) -> None:
    path.write_text(json.dumps(gltf_json()))
    (path.parent / "q.bin").write_bytes(GLTF_BINARY)


def _toml(path: Path) -> None:
    write_camera(path, View("pinhole", 640, 480, 500.0, 510.0, 320.0, 240.0, (0.1, -0.2, 0, 0)))


def _volume(path: Path) -> None:
    write_volume(path, two_rooms())


def _rad(path: Path) -> None:
    path.write_bytes(RAD)
    (path.parent / "d.dat").write_bytes(b"1\n0 1 2\n.5 1\n")


def _map(name: str) -> Callable[[Path], None]:
    def write(path: Path) -> None:
        path.write_bytes(small_maps()[name])

    return write


DEPTH = np.random.default_rng(RNG_SEED).uniform(1, 5, (5, 7))

# name of the reader → how to write a small valid file at a path with the reader's suffix
SPECIMENS: dict[str, Callable[[Path], None]] = {
    "picture.png": _write(pillow_bytes(rgb().astype(np.uint8), "PNG")),
    "picture.jpeg": _write(pillow_bytes(rgb(24, 24).astype(np.uint8), "JPEG")),
    "picture.exr": _exr,
    "picture.hdr": _write(hdr_header(3, 9, "EXPOSURE=2") + hdr_new_rle(rgbe_pixels())),
    "depth.npy": _write(npy(DEPTH)),
    "depth.npz": _write(npz(depth=DEPTH, other=DEPTH)),
    "depth.pfm": _write(pfm(DEPTH)),
    "depth.png": _write(png16(np.round(DEPTH * 1000))),
    "depth.pgm": _write(pgm(np.round(DEPTH * 1000))),
    "depth.exr": _exr,
    "mesh.obj": _obj,
    "mesh.ply": _write(PLY),
    "mesh.gltf": _gltf,
    "mesh.glb": _write(glb(gltf_json(None), GLTF_BINARY)),
    "camera.toml": _toml,
    "camera.opencv": _write(CAMERA_YAML),
    "response.csv": _write(RESPONSE_CSV),
    "surface-response.csv": _write(SURFACE_RESPONSE_CSV),
    "photometry.ies": _write(ies(horizontals=(0, 90, 180)).encode()),
    "photometry.ldt": _write(ldt(symmetry=2).encode()),
    "volume.glb": _volume,
    "exposures.list": _write(EXPOSURE_LIST),
    "gaze.csv": _write(own_gaze().encode()),
    "gaze.eyelink": _write(EYELINK.encode()),
    "gaps.csv": _write(GAPS_CSV),
    "gaps.json": _write(GAPS_JSON),
    "maps.json": _map("maps.json"),
    "geometry.exr": _map("geometry-0.exr"),
    "illuminance.exr": _map("light-1-0-1.exr"),
    "radiance.rad": _rad,
    "harmonics.json": _write(HARMONICS_JSON),
}
