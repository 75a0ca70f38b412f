"""PNG and JPEG: values, bits, orientation, field of view, ICC profiles."""

from __future__ import annotations

import io
import math
import struct
import zlib
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageCms

from andon.errors import InputError
from andon.files import decode_picture, read_picture
from andon.responses import srgb_decode, srgb_encode

from .specimens import (
    ADOBE_D50,
    GAMMA_1,
    GAMMA_2_2,
    SRGB_D50,
    matrix_profile,
    pillow_bytes,
    png16,
    png_chunk,
    png_header,
    rgb,
)

RGB8 = rgb().astype(np.uint8)
RGB16 = rgb(top=65535).astype(np.uint16)


def put(folder: Path, name: str, data: bytes) -> Path:
    path = folder / name
    path.write_bytes(data)
    return path


def test_8_bit_modes_become_rgb() -> None:
    gray = RGB8[..., 0]
    alpha = np.dstack([RGB8, np.full(gray.shape, 7, np.uint8)])
    cases = [
        (RGB8, RGB8),
        (gray, np.repeat(gray[..., None], 3, axis=-1)),
        (alpha, RGB8),  # dropped, neither multiplied nor composited
        (np.dstack([gray, alpha[..., 3]]), np.repeat(gray[..., None], 3, axis=-1)),
    ]
    for stored, expected in cases:
        picture = decode_picture(pillow_bytes(stored, "PNG"), "a.png")
        assert (picture.encoding, picture.values.dtype) == ("srgb", np.uint8)
        np.testing.assert_array_equal(picture.values, expected)


@pytest.mark.parametrize("transparency", [None, 1])
def test_palettes_are_expanded(transparency: int | None) -> None:
    image = Image.fromarray(np.array([[0, 1], [2, 1]], np.uint8), "P")
    image.putpalette([10, 20, 30, 40, 50, 60, 70, 80, 90])
    stream = io.BytesIO()
    extra = {} if transparency is None else {"transparency": transparency}
    image.save(stream, "PNG", **extra)
    read = decode_picture(stream.getvalue(), "p.png").values
    np.testing.assert_array_equal(read[0], [[10, 20, 30], [40, 50, 60]])
    np.testing.assert_array_equal(read[1], [[70, 80, 90], [40, 50, 60]])


def test_one_bit_pictures_are_black_and_white() -> None:
    stream = io.BytesIO()
    Image.fromarray(np.array([[0, 255]], np.uint8)).convert("1").save(stream, "PNG")
    np.testing.assert_array_equal(
        decode_picture(stream.getvalue(), "b.png").values, [[[0, 0, 0], [255, 255, 255]]]
    )


def test_16_bits_stay_16_bits() -> None:
    gray = RGB16[..., 0]
    for stored, expected in (
        (RGB16, RGB16),
        (gray, np.repeat(gray[..., None], 3, axis=-1)),
    ):
        picture = decode_picture(png16(stored), "a.png")
        assert picture.values.dtype == np.uint16
        np.testing.assert_array_equal(picture.values, expected)


def test_16_bit_gray_with_alpha_by_hand() -> None:
    rows = b"".join(b"\0" + struct.pack(">HHHH", g, 65535, g + 1, 1) for g in (300, 40000))
    data = (
        png_header(2, 2, 16, 4) + png_chunk(b"IDAT", zlib.compress(rows)) + png_chunk(b"IEND", b"")
    )
    values = decode_picture(data, "a.png").values
    np.testing.assert_array_equal(values[..., 0], [[300, 301], [40000, 40001]])
    np.testing.assert_array_equal(values[..., 0], values[..., 2])


def test_contents_decide_between_png_and_jpeg(tmp_path: Path) -> None:
    path = put(tmp_path, "really_png.jpg", pillow_bytes(RGB8, "PNG"))
    np.testing.assert_array_equal(read_picture(path).values, RGB8)
    with pytest.raises(InputError, match="PNG or JPEG"):
        read_picture(put(tmp_path, "a.png", b"GIF89a" + bytes(50)))
    with pytest.raises(InputError, match=r"must be one of \.exr"):
        read_picture(put(tmp_path, "a.gif", b"GIF89a"))


def test_a_damaged_checksum_is_found() -> None:
    data = bytearray(pillow_bytes(RGB8, "PNG"))
    data[60] ^= 1
    with pytest.raises(InputError, match="checksum"):
        decode_picture(bytes(data), "a.png")


def exif_bytes(orientation: int | None = None, focal: int | None = None) -> bytes:
    exif = Image.Exif()
    if orientation is not None:
        exif[0x0112] = orientation
    if focal is not None:
        exif.get_ifd(0x8769)[0xA405] = focal
    return exif.tobytes()


# EXIF's own words: which side of the scene the stored first row and first column are.
STORED = {
    1: lambda up: up,
    2: lambda up: up[:, ::-1],
    3: lambda up: up[::-1, ::-1],
    4: lambda up: up[::-1],
    5: lambda up: np.swapaxes(up, 0, 1),  # first row is the left side, first column the top
    6: lambda up: np.swapaxes(up[:, ::-1], 0, 1),  # right side, top
    7: lambda up: np.swapaxes(up[::-1, ::-1], 0, 1),  # right side, bottom
    8: lambda up: np.swapaxes(up[::-1], 0, 1),  # left side, bottom
}


@pytest.mark.parametrize("orientation", range(1, 9))
@pytest.mark.parametrize("kind", ["PNG", "JPEG"])
def test_exif_orientation_is_applied(orientation: int, kind: str) -> None:
    upright = np.kron(RGB8[:2, :3] // 2 + 64, np.ones((16, 16, 1), np.uint8))
    stored = np.ascontiguousarray(STORED[orientation](upright))
    options = {"quality": 100, "subsampling": 0} if kind == "JPEG" else {}
    data = pillow_bytes(stored, kind, exif=exif_bytes(orientation), **options)
    read = decode_picture(data, "a").values
    assert read.shape == upright.shape
    assert np.abs(read.astype(int) - upright).max() <= (0 if kind == "PNG" else 4)


@pytest.mark.parametrize("orientation", [0, 9, 1000])
def test_impossible_orientations_count_as_upright(orientation: int) -> None:
    data = pillow_bytes(RGB8, "PNG", exif=exif_bytes(orientation))
    np.testing.assert_array_equal(decode_picture(data, "a.png").values, RGB8)


def test_the_field_of_view_comes_from_the_35_mm_focal_length() -> None:
    landscape = np.zeros((24, 36, 3), np.uint8)
    data = pillow_bytes(landscape, "JPEG", exif=exif_bytes(focal=18))
    assert decode_picture(data, "a").hfov_degrees == pytest.approx(90.0)  # 36 mm wide at 18 mm
    portrait = pillow_bytes(landscape, "JPEG", exif=exif_bytes(6, 18))  # held upright
    expected = 2 * math.degrees(math.atan(12 / 18))
    assert decode_picture(portrait, "a").hfov_degrees == pytest.approx(expected)
    for data in (pillow_bytes(landscape, "JPEG"),
                 pillow_bytes(landscape, "JPEG", exif=exif_bytes(focal=0))):  # fmt: skip
        assert decode_picture(data, "a").hfov_degrees is None


def srgb_profile() -> bytes:
    return ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes()


PARA_SRGB = b"para\0\0\0\0\0\x03\0\0" + struct.pack(
    ">5i", *(round(v * 65536) for v in (2.4, 1 / 1.055, 0.055 / 1.055, 1 / 12.92, 0.04045))
)
TABLE_SRGB = b"curv\0\0\0\0" + struct.pack(
    ">I1024H", 1024, *np.rint(srgb_decode(np.linspace(0, 1, 1024)) * 65535).astype(int)
)


def expected_srgb(values: np.ndarray, top: int, columns: np.ndarray, gamma: float) -> np.ndarray:
    linear = (values / top) ** gamma @ (np.linalg.inv(SRGB_D50) @ columns).T
    return srgb_encode(np.clip(linear, 0, 1)) * top


MUTED8 = (RGB8 // 3 + 80).astype(np.uint8)  # inside both gamuts
MUTED16 = (RGB16 // 3 + 20000).astype(np.uint16)


@pytest.mark.parametrize(("columns", "curve", "gamma"), [(ADOBE_D50, GAMMA_2_2, 563 / 256),
                                                         (SRGB_D50, GAMMA_1, 1.0)])  # fmt: skip
def test_profiles_are_converted_in_8_and_16_bits(
    columns: np.ndarray, curve: bytes, gamma: float
) -> None:
    profile = matrix_profile(columns, curve)
    picture = decode_picture(pillow_bytes(MUTED8, "PNG", icc_profile=profile), "a.png")
    assert picture.icc == "test profile"
    expected = expected_srgb(MUTED8, 255, columns, gamma)
    assert np.abs(picture.values - expected).max() <= 1.5
    assert np.abs(picture.values.astype(int) - MUTED8).max() > 8  # it did something

    body = png16(MUTED16)
    iccp = png_chunk(b"iCCP", b"x\0\0" + zlib.compress(profile))
    with_profile = body[:33] + iccp + body[33:]
    wide = decode_picture(with_profile, "a.png")
    assert wide.values.dtype == np.uint16
    expected = expected_srgb(MUTED16, 65535, columns, gamma)
    assert np.abs(wide.values - expected).max() <= 80  # the colorants have 4 digits: 1e-3


@pytest.mark.parametrize("curve", [PARA_SRGB, TABLE_SRGB], ids=["parametric", "table"])
def test_tone_curves_of_16_bit_profiles(curve: bytes) -> None:
    """Adobe's primaries with sRGB's curve: only the matrix differs, so gray must not move."""
    profile = matrix_profile(ADOBE_D50, curve)
    gray = np.repeat(np.linspace(0, 65535, 50).astype(np.uint16)[None, :, None], 3, axis=-1)
    body = png16(gray)
    iccp = png_chunk(b"iCCP", b"x\0\0" + zlib.compress(profile))
    read = decode_picture(body[:33] + iccp + body[33:], "a.png").values
    assert np.abs(read.astype(int) - gray).max() <= 60


def test_gray_profiles_are_converted() -> None:
    profile = matrix_profile(SRGB_D50, GAMMA_1, b"GRAY")
    gray = np.arange(30, 250, 10, dtype=np.uint8)[None]
    read = decode_picture(pillow_bytes(gray, "PNG", icc_profile=profile), "g.png").values
    assert np.abs(read[..., 1] - srgb_encode(gray / 255) * 255).max() <= 1
    body = png16(gray.astype(np.uint16) * 257)
    iccp = png_chunk(b"iCCP", b"x\0\0" + zlib.compress(profile))
    wide = decode_picture(body[:33] + iccp + body[33:], "g.png").values
    assert np.abs(wide[..., 1] - srgb_encode(gray / 255) * 65535).max() <= 2


@pytest.mark.parametrize("kind", ["PNG", "JPEG"])
def test_srgb_profiles_change_no_byte(kind: str) -> None:
    plain = decode_picture(pillow_bytes(RGB8, kind), "a")
    profiled = decode_picture(pillow_bytes(RGB8, kind, icc_profile=srgb_profile()), "a")
    assert plain.icc is None
    assert "sRGB" in (profiled.icc or "")
    np.testing.assert_array_equal(plain.values, profiled.values)


@pytest.mark.parametrize("profile", [b"not a profile", srgb_profile()[:200],
                                     matrix_profile(SRGB_D50, GAMMA_1, b"GRAY")])  # fmt: skip
@pytest.mark.parametrize("kind", ["PNG", "JPEG"])
def test_broken_or_unfit_profiles_are_refused(kind: str, profile: bytes) -> None:
    with pytest.raises(InputError, match="ICC profile must be sound"):
        decode_picture(pillow_bytes(RGB8, kind, icc_profile=profile), "a.png")


def test_cmyk_needs_a_profile() -> None:
    stream = io.BytesIO()
    Image.fromarray(RGB8).convert("CMYK").save(stream, "JPEG")
    with pytest.raises(InputError, match="CMYK"):
        decode_picture(stream.getvalue(), "a.jpg")


def test_png_gamma_is_reported() -> None:
    body = pillow_bytes(RGB8, "PNG")
    data = body[:33] + png_chunk(b"gAMA", struct.pack(">I", 100000)) + body[33:]
    assert decode_picture(data, "a.png").attributes["gamma"] == pytest.approx(1.0)


def test_real_photographs(data_dir: Path) -> None:
    phone = read_picture(data_dir / "opencv_calib/singlemarkersoriginal.jpg")
    assert phone.icc == "Display P3"
    assert phone.hfov_degrees == pytest.approx(67.3, abs=0.1)
    upright = read_picture(data_dir / "brackets_piccante/venice/IMG_4209.jpg")
    assert upright.icc == "Camera RGB Profile"
    motorcycle = read_picture(data_dir / "motorcycle_skimage/motorcycle_left.png")
    assert motorcycle.values.shape == (500, 741, 3)
    assert motorcycle.values.dtype == np.uint8
    # The bytes of an untagged photograph are the file's own.
    with Image.open(data_dir / "motorcycle_skimage/motorcycle_left.png") as image:
        np.testing.assert_array_equal(motorcycle.values, np.asarray(image.convert("RGB")))
