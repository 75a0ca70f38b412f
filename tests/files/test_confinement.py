"""References stay inside their folder; files are opened only if they are ordinary and bounded."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from andon.errors import InputError
from andon.files import DEFAULT_LIMITS, confined, open_bounded, read_mesh

from .specimens import GLTF_BINARY, MTL, OBJ, gltf_json, pillow_bytes, rgb

ESCAPES = [
    "../secret",
    "a/../../secret",
    "/etc/passwd",
    "~/secret",
    "~root/secret",
    "file:///etc/passwd",
    "file:secret",
    "http://example.org/a.png",
    "HTTPS://example.org/a.png",
    "data:text/plain,hello",
    "javascript:alert(1)",
    "C:\\windows\\system.ini",
    "c:secret",
    "\\\\server\\share\\x",
    "..\\secret",
    "a\\..\\..\\secret",
    "a/..\\../secret",
    "a\0.png",
    "a\nb.png",
    "",
    "   ",
    ".",
    "a/..",
    "x" * 2000,
]
ENCODED = [
    "%2e%2e/secret",
    "..%2fsecret",
    "%2E%2E%2Fsecret",
    "%2fetc/passwd",
    "%5c%5cserver/share",
    "..%5csecret",
    "a%00.png",
    "file%3a///etc/passwd",
    "%ff%fe.png",
]


@pytest.mark.parametrize("reference", ESCAPES)
@pytest.mark.parametrize("percent_encoded", [False, True])
def test_escaping_references_are_refused(
    reference: str, percent_encoded: bool, tmp_path: Path
) -> None:
    (tmp_path / "inner").mkdir()
    (tmp_path / "secret").write_text("x")
    with pytest.raises(InputError, match="reference"):
        confined(reference, tmp_path / "inner", percent_encoded=percent_encoded)


@pytest.mark.parametrize("reference", ENCODED)
def test_percent_encoded_escapes_are_refused_where_percent_means_something(
    reference: str, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match="reference"):
        confined(reference, tmp_path, percent_encoded=True)


def test_decoding_happens_once_and_only_for_uris(tmp_path: Path) -> None:
    assert confined("a%20b.png", tmp_path, percent_encoded=True) == tmp_path.resolve() / "a b.png"
    assert confined("a%20b.png", tmp_path) == tmp_path.resolve() / "a%20b.png"
    twice = confined("%252e%252e/x", tmp_path, percent_encoded=True)
    assert twice == tmp_path.resolve() / "%2e%2e" / "x"


def test_references_that_stay_inside_are_followed(tmp_path: Path) -> None:
    base = tmp_path.resolve()
    assert confined("textures/a b.png", tmp_path) == base / "textures" / "a b.png"
    assert confined("textures\\a.png", tmp_path) == base / "textures" / "a.png"
    assert confined("a/../b.png", tmp_path) == base / "b.png"
    assert confined("./b..png", tmp_path) == base / "b..png"


def test_symlinks_that_leave_or_loop_are_refused(tmp_path: Path) -> None:
    inner = tmp_path / "inner"
    inner.mkdir()
    (tmp_path / "secret").write_text("x")
    (inner / "out").symlink_to(tmp_path)
    (inner / "file").symlink_to(tmp_path / "secret")
    (inner / "real").write_text("y")
    (inner / "alias").symlink_to("real")
    for reference in ("out/secret", "file"):
        with pytest.raises(InputError, match="stay inside"):
            confined(reference, inner)
    assert confined("alias", inner) == (inner / "real").resolve()
    (inner / "loop").symlink_to("loop")
    with pytest.raises(InputError):
        open_bounded(confined("loop", inner))


def test_a_folder_that_is_itself_a_symlink_is_the_folder(tmp_path: Path) -> None:
    (tmp_path / "real").mkdir()
    (tmp_path / "link").symlink_to("real")
    assert confined("a.png", tmp_path / "link") == (tmp_path / "real" / "a.png").resolve()


@given(st.text(max_size=60), st.booleans())
def test_no_reference_at_all_leaves_the_folder(reference: str, percent_encoded: bool) -> None:
    folder = Path("/some/folder")
    try:
        path = confined(reference, folder, percent_encoded=percent_encoded)
    except InputError:
        return
    assert path.is_relative_to(folder.resolve())


@given(st.lists(st.sampled_from(["..", ".", "a", "/", "\\", "%2e", "%2F", "b"]), max_size=12))
def test_no_mixture_of_dots_and_slashes_leaves_the_folder(parts: list[str]) -> None:
    folder = Path("/some/folder")
    for percent_encoded in (False, True):
        try:
            path = confined("".join(parts), folder, percent_encoded=percent_encoded)
        except InputError:
            continue
        assert path.is_relative_to(folder.resolve())


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes on this system")
def test_pipes_and_devices_are_refused_without_waiting(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    for path in (tmp_path / "pipe", Path("/dev/zero")):
        with pytest.raises(InputError, match="regular file"):
            open_bounded(path)


def test_size_limits_are_kept(tmp_path: Path) -> None:
    path = tmp_path / "x"
    path.write_bytes(b"12345")
    assert open_bounded(path, replace(DEFAULT_LIMITS, max_file_bytes=5)) == b"12345"
    with pytest.raises(InputError, match="at most 4 bytes, has 5"):
        open_bounded(path, replace(DEFAULT_LIMITS, max_file_bytes=4))
    with pytest.raises(InputError, match="at most 3 bytes"):
        open_bounded(path, max_bytes=3)


@pytest.mark.parametrize("reference", ["../t.png", "/etc/hostname", "http://x.org/t.png"])
def test_obj_textures_and_libraries_are_confined(reference: str, tmp_path: Path) -> None:
    inner = tmp_path / "inner"
    inner.mkdir()
    (tmp_path / "t.png").write_bytes(pillow_bytes(rgb().astype("u1"), "PNG"))
    (tmp_path / "m.mtl").write_bytes(MTL)
    path = inner / "a.obj"
    path.write_bytes(OBJ)
    (inner / "m.mtl").write_bytes(MTL.replace(b"t.png", reference.encode()))
    with pytest.raises(InputError, match="a reference must"):
        read_mesh(path)
    path.write_bytes(OBJ.replace(b"m.mtl", reference.replace("t.png", "m.mtl").encode()))
    with pytest.raises(InputError, match="a reference must"):
        read_mesh(path)


@pytest.mark.parametrize("uri", ["../q.bin", "%2e%2e/q.bin", "file:///q.bin", "/q.bin", "o/q.bin"])
def test_gltf_buffers_and_images_are_confined(uri: str, tmp_path: Path) -> None:
    import json

    inner = tmp_path / "inner"
    inner.mkdir()
    (tmp_path / "q.bin").write_bytes(GLTF_BINARY)
    (inner / "o").symlink_to(tmp_path)
    path = inner / "a.gltf"
    path.write_text(json.dumps(gltf_json(uri)))
    with pytest.raises(InputError, match="a reference must"):
        read_mesh(path)
    (inner / "q.bin").write_bytes(GLTF_BINARY)
    document = gltf_json()
    document["images"], document["textures"] = [{"uri": uri}], [{"source": 0}]
    document["materials"] = [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]
    path.write_text(json.dumps(document))
    with pytest.raises(InputError, match="a reference must"):
        read_mesh(path)
