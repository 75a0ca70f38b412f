"""Every registered reader against truncated, altered and oversized files."""

from __future__ import annotations

import io
import time
import tracemalloc
import warnings
import zipfile
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from PIL import Image

from andon.errors import InputError
from andon.files import READERS, Reader, decode_picture, reader_for

from .specimens import (
    GLTF_BINARY,
    SPECIMENS,
    glb,
    gltf_json,
    hdr_header,
    huge_exr,
    matrix_profile,
    npy,
    pillow_bytes,
    png16,
    png_chunk,
    png_header,
    rgb,
)

SIDE = 60_000
OFFSETS = 80


def specimen(reader: Reader, folder: Path) -> Path:
    path = folder / f"specimen{reader.suffixes[0]}"
    SPECIMENS[reader.name](path)
    return path


def read_or_refuse(reader: Reader, path: Path) -> bool:
    """True if it was read; anything but an InputError passes through and fails the test."""
    message = ""
    try:
        reader.read(path)
    except InputError as error:
        message = str(error)
    assert "\n" not in message
    return not message


def by_name(reader: Reader) -> str:
    return reader.name


def test_every_registered_reader_has_a_specimen_and_a_kind() -> None:
    assert [reader.name for reader in READERS] == list(SPECIMENS)
    kinds = {"picture", "depth", "mesh", "camera", "response", "photometry", "volume"}
    kinds |= {"exposures", "gaze", "gaps", "maps", "geometry", "illuminance", "radiance"}
    kinds |= {"harmonics", "surface-response"}
    assert {reader.kind for reader in READERS} == kinds


@pytest.mark.parametrize("reader", READERS, ids=by_name)
def test_every_reader_reads_its_specimen_by_every_suffix(reader: Reader, tmp_path: Path) -> None:
    path = specimen(reader, tmp_path)
    for suffix in reader.suffixes:
        if suffix == ".json":  # the YAML specimen is no JSON
            continue
        other = path.with_suffix(suffix)
        other.write_bytes(path.read_bytes())
        assert reader_for(other, reader.kind) is reader  # type: ignore[arg-type]
        assert read_or_refuse(reader, other)


@pytest.mark.parametrize("reader", READERS, ids=by_name)
def test_every_reader_survives_truncation(reader: Reader, tmp_path: Path) -> None:
    path = specimen(reader, tmp_path)
    data = path.read_bytes()
    offsets = {int(at) for at in np.linspace(0, len(data) - 1, OFFSETS)}
    assert len(offsets) >= 64
    started = time.perf_counter()
    refused = 0
    for offset in sorted(offsets):
        path.write_bytes(data[:offset])
        refused += not read_or_refuse(reader, path)
    assert refused >= 32
    assert time.perf_counter() - started < 5


@pytest.mark.parametrize("reader", READERS, ids=by_name)
@settings(
    max_examples=60,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(changes=st.lists(st.tuples(st.floats(0, 1), st.integers(0, 255)), min_size=1, max_size=6))
def test_every_reader_survives_flipped_bytes(
    reader: Reader, tmp_path: Path, changes: list[tuple[float, int]]
) -> None:
    path = specimen(reader, tmp_path)
    data = bytearray(path.read_bytes())
    for place, value in changes:
        data[min(int(place * len(data)), len(data) - 1)] = value
    path.write_bytes(bytes(data))
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # a warning on the user's screen is not an answer either
        read_or_refuse(reader, path)


@pytest.mark.parametrize("reader", READERS, ids=by_name)
@settings(
    max_examples=25,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(data=st.binary(min_size=0, max_size=200))
def test_every_reader_survives_noise(reader: Reader, tmp_path: Path, data: bytes) -> None:
    path = specimen(reader, tmp_path)
    head = path.read_bytes()[: len(data) % 17]
    path.write_bytes(head + data)
    read_or_refuse(reader, path)


@pytest.mark.parametrize("reader", READERS, ids=by_name)
def test_every_reader_refuses_missing_empty_and_folder(reader: Reader, tmp_path: Path) -> None:
    path = tmp_path / f"x{reader.suffixes[0]}"
    with pytest.raises(InputError, match="must exist"):
        reader.read(path)
    path.write_bytes(b"")
    with pytest.raises(InputError, match="empty"):
        reader.read(path)
    path.unlink()
    path.mkdir()
    with pytest.raises(InputError, match="folder"):
        reader.read(path)


def huge_jpeg() -> bytes:
    start = b"\xff\xd8\xff\xc0\x00\x11\x08" + SIDE.to_bytes(2, "big") * 2
    return start + b"\x03\x01\x11\x00\x02\x11\x00\x03\x11\x00" + b"\xff\xda\x00\x08" + b"\0" * 64


def huge_npy() -> bytes:
    head = npy(np.zeros((2, 2)))
    return head.replace(b"(2, 2), }".ljust(20), f"({SIDE}, {SIDE}), }}".encode().ljust(20))


def huge_npz() -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        archive.writestr("depth.npy", huge_npy())
    return stream.getvalue()


PNG_END = b"\0\0\0\0IEND\xaeB`\x82"
HOSTILE = {
    "picture.png": png_header(SIDE, SIDE) + PNG_END,
    "picture.jpeg": huge_jpeg(),
    "picture.exr": huge_exr(SIDE),
    "picture.hdr": hdr_header(SIDE, SIDE) + b"\0" * 100,
    "depth.npy": huge_npy(),
    "depth.npz": huge_npz(),
    "depth.pfm": f"Pf\n{SIDE} {SIDE}\n-1\n".encode() + b"\0" * 100,
    "depth.png": png_header(SIDE, SIDE, 16, 0) + PNG_END,
    "depth.pgm": f"P5\n{SIDE} {SIDE}\n65535\n".encode() + b"\0" * 100,
    "depth.exr": huge_exr(SIDE),
    "geometry.exr": huge_exr(SIDE),
    "illuminance.exr": huge_exr(SIDE),
}


def test_every_reader_of_pixels_has_a_hostile_header() -> None:
    expected = [
        r.name for r in READERS if r.kind in ("picture", "depth", "geometry", "illuminance")
    ]
    assert list(HOSTILE) == expected


@pytest.mark.parametrize("name", HOSTILE)
def test_a_60000_by_60000_header_is_refused_at_once(name: str, tmp_path: Path) -> None:
    reader = next(reader for reader in READERS if reader.name == name)
    read_or_refuse(reader, specimen(reader, tmp_path))  # the decoder's library is loaded by now
    path = tmp_path / f"huge{reader.suffixes[0]}"
    path.write_bytes(HOSTILE[name])
    started = time.perf_counter()
    with pytest.raises(InputError, match=r"60000|3600000000"):
        reader.read(path)
    assert time.perf_counter() - started < 0.1
    tracemalloc.start()
    before = peak_kilobytes()
    with pytest.raises(InputError):
        reader.read(path)
    assert tracemalloc.get_traced_memory()[1] < 50e6
    tracemalloc.stop()
    assert peak_kilobytes() - before < 50_000


def peak_kilobytes() -> int:
    import resource

    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


@pytest.mark.parametrize(
    ("name", "data"),
    [
        ("x.ply", b"ply\nformat binary_little_endian 1.0\nelement vertex 16000000\n"
         b"property float x\nproperty float y\nproperty float z\nelement face 16000000\n"
         b"property list uchar int vertex_indices\nend_header\n" + b"\0" * 50),
        ("x.ply", b"ply\nformat ascii 1.0\nelement face 16000000\n"
         b"property list uchar int vertex_indices\nend_header\n3 0 1 2\n"),
        ("x.obj", b"f 1 2 3\n" * 10),
        ("x.yml", b"a: &a [1,1,1]\nb: &b [*a,*a,*a]\nc: [*b,*b,*b]\n"),
        ("x.yml", b"[" * 5000),
        ("x.json", b"[" * 200_000),
        ("x.gltf", b"[" * 200_000),
        ("x.toml", b"a = " + b"[" * 100_000),
    ],
    ids=["ply-binary", "ply-text", "obj", "yaml-alias", "yaml-deep", "json-deep", "gltf", "toml"],
)  # fmt: skip
def test_claims_and_nesting_are_refused_cheaply(name: str, data: bytes, tmp_path: Path) -> None:
    path = tmp_path / name
    path.write_bytes(data)
    kind = "mesh" if path.suffix in (".ply", ".obj", ".gltf") else "camera"
    reader = reader_for(path, kind)
    started = time.perf_counter()
    tracemalloc.start()
    with pytest.raises(InputError):
        reader.read(path)
    assert tracemalloc.get_traced_memory()[1] < 50e6
    tracemalloc.stop()
    assert time.perf_counter() - started < 1.0


JSON_VALUES = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-2, 9),
    st.sampled_from([2**31, 10**30, 1e308, -0.5, "", "x", "data:,", "../x", "VEC3", 5125, 5126]),
    st.lists(st.integers(0, 3), max_size=16),
    st.dictionaries(st.sampled_from(["index", "light", "count", "indices"]), st.integers(0, 3)),
)


@settings(
    max_examples=150,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(
    places=st.lists(st.lists(st.integers(0, 20), max_size=8), min_size=1, max_size=3),
    values=st.lists(JSON_VALUES, min_size=3, max_size=3),
)
def test_gltf_survives_wrong_values_in_any_place(
    tmp_path: Path, places: list[list[int]], values: list[object]
) -> None:
    document: Any = gltf_json()
    for place, value in zip(places, values, strict=False):
        at = document
        for step in place:
            keys = list(at) if isinstance(at, dict) else list(range(len(at)))
            if not keys:
                break
            key = keys[step % len(keys)]
            if step == place[-1] or not isinstance(at[key], dict | list):
                at[key] = value
                break
            at = at[key]
    path = tmp_path / "a.glb"
    document = document if isinstance(document, dict) else {}
    path.write_bytes(glb(document, GLTF_BINARY))
    read_or_refuse(reader_for(path, "mesh"), path)


@pytest.mark.parametrize("bits", [8, 16])
@settings(max_examples=80, deadline=None, derandomize=True)
@given(changes=st.lists(st.tuples(st.floats(0, 1), st.integers(0, 255)), min_size=1, max_size=4))
def test_damaged_profiles_and_exif_inside_sound_files(
    bits: int, changes: list[tuple[float, int]]
) -> None:
    """The checksums of a PNG would hide these from bytes flipped in the file."""
    body = png16(rgb(top=65535)) if bits == 16 else pillow_bytes(rgb().astype(np.uint8), "PNG")
    exif = Image.Exif()
    exif[0x0112] = 6
    exif.get_ifd(0x8769)[0xA405] = 28
    damaged = []
    for block in (matrix_profile(), exif.tobytes()[6:]):
        data = bytearray(block)
        for place, value in changes:
            data[min(int(place * len(data)), len(data) - 1)] = value
        damaged.append(bytes(data))
    extra = png_chunk(b"iCCP", b"x\0\0" + zlib.compress(damaged[0])) + png_chunk(
        b"eXIf", damaged[1]
    )
    try:
        picture = decode_picture(body[:33] + extra + body[33:], "a.png")
    except InputError:
        return
    assert picture.values.dtype == (np.uint16 if bits == 16 else np.uint8)
