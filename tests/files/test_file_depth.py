"""Depth files: the raw numbers, whatever the format."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from andon.errors import InputError
from andon.files import read_depth_array, write_exr

from .specimens import DEPTH, npy, npz, pfm, pgm, pillow_bytes, png16, rgb


def put(folder: Path, name: str, data: bytes) -> Path:
    path = folder / name
    path.write_bytes(data)
    return path


@pytest.mark.parametrize("order", ["<", ">"])
def test_pfm_runs_bottom_up_in_either_byte_order(order: str, tmp_path: Path) -> None:
    values = np.array([[1.0, 2.0, 3.0], [4.0, np.inf, np.nan]])
    read = read_depth_array(put(tmp_path, "a.pfm", pfm(values, order)))
    assert read.dtype == np.float64
    np.testing.assert_array_equal(read, values)


def test_pfm_rows_by_hand_and_scale_is_not_applied(tmp_path: Path) -> None:
    data = b"Pf\r\n1 2\n-0.0039\n" + np.array([7, 9], "<f4").tobytes()  # 7 is the bottom row
    np.testing.assert_array_equal(read_depth_array(put(tmp_path, "a.pfm", data)), [[9.0], [7.0]])


@pytest.mark.parametrize(
    ("data", "match"),
    [
        (b"PF\n1 1\n-1\n" + b"\0" * 12, "one-channel"),
        (b"Pf\n1 1\n0\n" + b"\0" * 4, "scale"),
        (b"Pf\n1 1\nnan\n" + b"\0" * 4, "scale"),
        (b"Pf\n1 -1\n1\n" + b"\0" * 4, "height"),
        (b"Pf\n1 0\n1\n" + b"\0" * 4, "pixels"),
        (b"Pf\n2 2\n-1\n" + b"\0" * 15, "cut short"),
    ],
)
def test_bad_pfm_files_are_refused(data: bytes, match: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=match):
        read_depth_array(put(tmp_path, "a.pfm", data))


@pytest.mark.parametrize(
    "kind", [np.uint8, np.int16, np.uint16, np.int64, np.float16, np.float32, ">f8"]
)
def test_npy_of_every_type_is_float64_of_the_same_numbers(kind: object, tmp_path: Path) -> None:
    values = np.array([[0, 1, 2], [100, 101, 102]]).astype(kind)  # type: ignore[call-overload]
    read = read_depth_array(put(tmp_path, "a.npy", npy(values)))
    assert read.dtype == np.float64
    np.testing.assert_array_equal(read, values.astype(float))


def test_npy_orders_and_single_axes(tmp_path: Path) -> None:
    values = np.arange(6.0).reshape(2, 3)
    for array in (np.asfortranarray(values), values[..., None], values[None]):
        read = read_depth_array(put(tmp_path, "a.npy", npy(array)))
        np.testing.assert_array_equal(read, values)


@pytest.mark.parametrize(
    ("array", "match"),
    [
        (np.zeros((2, 3, 4)), r"shape \(H, W\)"),
        (np.zeros(5), r"shape \(H, W\)"),
        (np.zeros((2, 2), complex), "integers or floats"),
        (np.zeros((2, 2), bool), "integers or floats"),
        (np.zeros((2, 2), "U3"), "integers or floats"),
        (np.array([[{}]], object), "integers or floats"),
        (np.zeros((2, 0)), "pixels"),
    ],
)
def test_other_arrays_are_refused(array: np.ndarray, match: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=match):
        read_depth_array(put(tmp_path, "a.npy", npy(array)))


def test_npz_chooses_the_only_or_the_named_array(tmp_path: Path) -> None:
    other = np.ones((2, 2))
    for arrays in ({"x": DEPTH}, {"depth": DEPTH, "x": other}, {"disparity": DEPTH, "x": other},
                   {"arr_0": DEPTH, "x": other}):  # fmt: skip
        np.testing.assert_array_equal(
            read_depth_array(put(tmp_path, "a.npz", npz(**arrays))), DEPTH
        )
    with pytest.raises(InputError, match="has x, y"):
        read_depth_array(put(tmp_path, "a.npz", npz(x=other, y=other)))


def test_an_npz_that_unpacks_to_far_more_is_read_only_as_far_as_needed(tmp_path: Path) -> None:
    import io
    import tracemalloc
    import zipfile

    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("depth.npy", npy(DEPTH) + b"\0" * 200_000_000)
    path = put(tmp_path, "bomb.npz", stream.getvalue())
    tracemalloc.start()
    np.testing.assert_array_equal(read_depth_array(path), DEPTH)
    assert tracemalloc.get_traced_memory()[1] < 10e6
    tracemalloc.stop()


def test_png_and_pgm_numbers_are_not_scaled(tmp_path: Path) -> None:
    values = np.array([[0, 1, 255], [256, 40000, 65535]])
    for name, data in (("a.png", png16(values)), ("a.pgm", pgm(values))):
        np.testing.assert_array_equal(read_depth_array(put(tmp_path, name, data)), values)
    small = np.array([[0, 1, 255]])
    for name, data in (
        ("a.png", pillow_bytes(small.astype(np.uint8), "PNG")),
        ("a.pgm", pgm(small, 255)),
        ("a.pgm", b"P2 # text\n3 1\n255\n0 1\n255\n"),
    ):
        np.testing.assert_array_equal(read_depth_array(put(tmp_path, name, data)), small)


def test_colour_is_no_depth(tmp_path: Path) -> None:
    data = pillow_bytes(rgb().astype(np.uint8), "PNG")
    with pytest.raises(InputError, match="gray"):
        read_depth_array(put(tmp_path, "a.png", data))


def test_exr_prefers_z_then_y_then_the_first(tmp_path: Path) -> None:
    import OpenEXR

    planes = {name: np.full((2, 3), float(i), np.float32) for i, name in enumerate("ABYZ")}
    for drop, expected in (("", 3.0), ("Z", 2.0), ("ZY", 0.0)):
        chosen = {name: plane for name, plane in planes.items() if name not in drop}
        path = tmp_path / "a.exr"
        header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
        OpenEXR.File(header, chosen).write(str(path))
        np.testing.assert_array_equal(read_depth_array(path), np.full((2, 3), expected))


def test_an_unknown_suffix_lists_the_known_ones(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"\.exr, \.npy, \.npz, \.pfm, \.pgm, \.png, got \.tif"):
        read_depth_array(put(tmp_path, "a.tif", b"x"))


def test_exr_depth_round_trip(tmp_path: Path) -> None:
    path = write_exr(tmp_path / "z.exr", DEPTH, unit="m")
    np.testing.assert_allclose(read_depth_array(path), DEPTH, rtol=1e-7)


def test_real_depth(data_dir: Path) -> None:
    disparity = read_depth_array(data_dir / "middlebury_v3q/trainingQ/Motorcycle/disp0GT.pfm")
    known = np.isfinite(disparity)
    assert disparity.shape == (497, 741)
    assert 0.9 < known.mean() < 1
    # Z = baseline·f/(disparity + doffs) is 1.2…4.5 m for the whole set, so near is at the bottom:
    # a picture read upside down would have it on top.
    assert np.mean(disparity[-50:][known[-50:]]) > np.mean(disparity[:50][known[:50]])
    kinect = read_depth_array(data_dir / "rgbd_diningroom/depth/1.pgm")
    assert kinect.shape == (480, 640)
    assert 2.5e3 < np.median(kinect[kinect > 0]) < 3.1e3  # mm
    skimage = read_depth_array(data_dir / "motorcycle_skimage/motorcycle_disp.npz")
    assert skimage.shape == (500, 741)
    assert np.isfinite(skimage).mean() == pytest.approx(0.927, abs=1e-3)
