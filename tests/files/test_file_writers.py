"""Writers: what is written is what is read, atomically, with errors that say whose fault it is."""

from __future__ import annotations

import errno
import os
from pathlib import Path

import numpy as np
import pytest

from andon.errors import InputError, MachineError
from andon.files import (
    read_depth_array,
    read_picture,
    write_exr,
    write_jpeg,
    write_npy,
    write_picture,
    write_png,
)

from .specimens import rgb


def test_png_round_trips_exactly_in_8_and_16_bits(tmp_path: Path) -> None:
    for values in (rgb().astype(np.uint8), rgb(top=65535).astype(np.uint16)):
        picture = read_picture(write_png(tmp_path / "a.png", values))
        assert picture.values.dtype == values.dtype
        np.testing.assert_array_equal(picture.values, values)
        gray = read_picture(write_png(tmp_path / "g.png", values[..., 0]))
        np.testing.assert_array_equal(gray.values, np.repeat(values[..., :1], 3, axis=-1))


def test_jpeg_is_close_and_not_subsampled(tmp_path: Path) -> None:
    columns = np.zeros((16, 16, 3), np.uint8)
    columns[:, ::2] = (200, 40, 40)
    columns[:, 1::2] = (40, 40, 200)
    read = read_picture(write_jpeg(tmp_path / "a.jpg", columns)).values.astype(int)
    assert np.abs(read - columns).max() <= 12  # subsampled chroma would be off by 80


def test_write_picture_goes_by_suffix(tmp_path: Path) -> None:
    values = rgb().astype(np.uint8)
    assert write_picture(tmp_path / "a.PNG", values).read_bytes().startswith(b"\x89PNG")
    assert write_picture(tmp_path / "a.jpeg", values).read_bytes().startswith(b"\xff\xd8")
    with pytest.raises(InputError, match=r"\.png, \.jpg or \.jpeg"):
        write_picture(tmp_path / "a.gif", values)


def test_exr_keeps_floats_unit_and_photometry(tmp_path: Path) -> None:
    values = np.random.default_rng(0).normal(0, 1e3, (4, 5, 3)).astype(np.float32)
    values[0, 0] = (np.inf, -np.inf, np.nan)
    path = write_exr(
        tmp_path / "a.exr", values, unit="lx", photometry="relative", attributes={"lamp": "andon"}
    )
    picture = read_picture(path)
    np.testing.assert_array_equal(picture.values, values)
    assert picture.encoding == "linear"
    assert picture.attributes["andon:unit"] == "lx"
    assert picture.attributes["andon:photometry"] == "relative"
    assert picture.attributes["lamp"] == "andon"


@pytest.mark.parametrize("shape", [(4, 5), (4, 5, 1)])
def test_exr_of_one_channel_is_read_as_gray_and_as_depth(
    shape: tuple[int, ...], tmp_path: Path
) -> None:
    values = np.arange(20, dtype=np.float64).reshape(shape) / 3
    path = write_exr(tmp_path / "z.exr", values, unit="m")
    expected = values.reshape(4, 5).astype(np.float32)
    np.testing.assert_array_equal(read_depth_array(path), expected)
    np.testing.assert_array_equal(read_picture(path).values[..., 2], expected)


def test_npy_round_trips_and_refuses_objects(tmp_path: Path) -> None:
    values = np.arange(6.0).reshape(2, 3)
    np.testing.assert_array_equal(read_depth_array(write_npy(tmp_path / "a.npy", values)), values)
    with pytest.raises(InputError, match="objects"):
        write_npy(tmp_path / "b.npy", np.array([{}], object))


@pytest.mark.parametrize(
    "values",
    [
        rgb().astype(np.float32),
        np.zeros((0, 4, 3), np.uint8),
        np.zeros((4, 4, 2), np.uint8),
        np.zeros(4, np.uint8),
    ],
)
def test_wrong_arrays_are_named(values: np.ndarray, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"must be \(H, W\) or \(H, W, 3\)"):
        write_png(tmp_path / "a.png", values)
    assert not list(tmp_path.iterdir())


def test_a_missing_folder_is_the_users_and_has_a_remedy(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="create "):
        write_png(tmp_path / "no" / "a.png", rgb().astype(np.uint8))
    with pytest.raises(InputError, match="not a folder"):
        write_png(tmp_path, rgb().astype(np.uint8))


def test_a_full_disk_leaves_the_old_file_and_no_litter(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = write_png(tmp_path / "a.png", rgb().astype(np.uint8))
    before = path.read_bytes()

    def full(handle: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    for write in (
        lambda: write_png(path, rgb(top=9).astype(np.uint8)),
        lambda: write_exr(path.with_suffix(".exr"), np.ones((2, 2)), unit="lx"),
    ):
        with pytest.raises(MachineError, match="No space left"):
            write()
    assert path.read_bytes() == before
    assert [p.name for p in tmp_path.iterdir()] == ["a.png"]


@pytest.mark.skipif(not Path("/proc/self").is_dir(), reason="needs a folder nobody can write")
def test_a_folder_that_cannot_be_written_is_the_machines(tmp_path: Path) -> None:
    with pytest.raises(MachineError, match="cannot be written"):
        write_png("/proc/self/a.png", rgb().astype(np.uint8))
    with pytest.raises(MachineError, match="cannot be written"):
        write_exr("/proc/self/a.exr", np.ones((2, 2)), unit="lx")
    with pytest.raises(InputError, match="possible name"):
        write_png(tmp_path / ("x" * 300 + ".png"), rgb().astype(np.uint8))


def test_new_files_have_ordinary_permissions(tmp_path: Path) -> None:
    mask = os.umask(0o022)
    try:
        path = write_png(tmp_path / "a.png", rgb().astype(np.uint8))
    finally:
        os.umask(mask)
    assert path.stat().st_mode & 0o777 == 0o644
