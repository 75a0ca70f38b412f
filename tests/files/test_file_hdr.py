"""EXR and Radiance pictures: linear values, windows, primaries, run lengths, orientations."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest

from andon.errors import InputError
from andon.files import read_depth_array, read_picture
from requirements import missing, required

from .specimens import hdr_header, hdr_new_rle, huge_exr, rgbe_pixels

GRAY_XY = (0.64, 0.33, 0.30, 0.60, 0.15, 0.06)


def put(folder: Path, name: str, data: bytes) -> Path:
    path = folder / name
    path.write_bytes(data)
    return path


def decoded(pixels: np.ndarray) -> np.ndarray:
    """By the definition: (mantissa + ½)·2^(exponent − 136)."""
    scale = 2.0 ** (pixels[..., 3:].astype(float) - 136)
    return np.where(pixels[..., 3:] == 0, 0.0, (pixels[..., :3] + 0.5) * scale)


def old_runs(pixels: np.ndarray) -> bytes:
    """Old run-length coding: a repeated pixel becomes (1, 1, 1, n), with a second digit of n."""
    out = b""
    for line in pixels:
        at = 0
        while at < len(line):
            same = 1
            while at + same < len(line) and (line[at + same] == line[at]).all():
                same += 1
            out += line[at].tobytes()
            repeats = same - 1
            while repeats:
                out += bytes([1, 1, 1, repeats & 255])
                repeats >>= 8
            at += same
    return out


PIXELS = rgbe_pixels(4, 12)
PIXELS[1, :, 0] = 77  # a run in one plane
PIXELS[2, 3, 3] = 0  # black by exponent


def test_the_three_ways_to_store_a_line_agree(tmp_path: Path) -> None:
    expected = decoded(PIXELS).astype(np.float32)
    head = hdr_header(4, 12)
    for body in (PIXELS.tobytes(), hdr_new_rle(PIXELS), old_runs(PIXELS)):
        picture = read_picture(put(tmp_path, "a.hdr", head + body))
        assert (picture.encoding, picture.values.dtype) == ("linear", np.float32)
        np.testing.assert_array_equal(picture.values, expected)


def test_old_runs_longer_than_a_byte(tmp_path: Path) -> None:
    pixels = np.tile(np.array([10, 20, 30, 129], np.uint8), (2, 700, 1))
    body = old_runs(pixels)
    assert len(body) == 2 * 12
    read = read_picture(put(tmp_path, "a.hdr", hdr_header(2, 700) + body)).values
    np.testing.assert_array_equal(read, decoded(pixels).astype(np.float32))


@pytest.mark.parametrize(
    ("resolution", "stored"),
    [
        ("-Y {h} +X {w}", lambda up: up),
        ("-Y {h} -X {w}", lambda up: up[:, ::-1]),
        ("+Y {h} +X {w}", lambda up: up[::-1]),
        ("+Y {h} -X {w}", lambda up: up[::-1, ::-1]),
        ("+X {w} -Y {h}", lambda up: np.swapaxes(up, 0, 1)),
        ("+X {w} +Y {h}", lambda up: np.swapaxes(up[::-1], 0, 1)),
        ("-X {w} -Y {h}", lambda up: np.swapaxes(up[:, ::-1], 0, 1)),
        ("-X {w} +Y {h}", lambda up: np.swapaxes(up[::-1, ::-1], 0, 1)),
    ],
)
def test_every_orientation_is_turned_upright(
    resolution: str, stored: object, tmp_path: Path
) -> None:
    line = resolution.format(h=4, w=12)
    head = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n{line}\n".encode()
    body = np.ascontiguousarray(stored(PIXELS)).tobytes()  # type: ignore[operator]
    read = read_picture(put(tmp_path, "a.hdr", head + body)).values
    np.testing.assert_array_equal(read, decoded(PIXELS).astype(np.float32))


def test_exposures_multiply_and_are_divided_out(tmp_path: Path) -> None:
    head = hdr_header(4, 12, "EXPOSURE=2", "EXPOSURE= 0.25", "COLORCORR=1 2 4")
    read = read_picture(put(tmp_path, "a.hdr", head + PIXELS.tobytes())).values
    np.testing.assert_allclose(read, decoded(PIXELS) / 0.5 / [1, 2, 4], rtol=1e-6)


def test_a_parents_indented_lines_do_not_count(tmp_path: Path) -> None:
    head = hdr_header(4, 12, "\tEXPOSURE=2", "\tVIEW= -vh 1", "# EXPOSURE=3")
    read = read_picture(put(tmp_path, "a.hdr", head + PIXELS.tobytes()))
    np.testing.assert_allclose(read.values, decoded(PIXELS), rtol=1e-6)
    assert read.view_line is None


def test_view_and_other_lines_are_kept(tmp_path: Path) -> None:
    head = hdr_header(4, 12, "VIEW= -vtv -vp 0 1 2", "VIEW= -vh 40", "CAMERA= x", "rpict -vf a")
    picture = read_picture(put(tmp_path, "a.hdr", head + PIXELS.tobytes()))
    assert picture.view_line == "-vtv -vp 0 1 2 -vh 40"
    assert picture.attributes == {"CAMERA": "x"}


def test_xyze_becomes_radiance_with_equal_channels_for_neutral_light(tmp_path: Path) -> None:
    """Radiance writes X = Y = Z = 179·L for neutral light of radiance L."""
    gray = PIXELS.copy()
    gray[..., :3] = gray[..., :1]
    head = hdr_header(4, 12, form="32-bit_rle_xyze")
    read = read_picture(put(tmp_path, "a.hdr", head + gray.tobytes())).values
    np.testing.assert_allclose(read, decoded(gray) / 179, rtol=2e-5, atol=1e-12)


def test_xyze_written_by_radiance_comes_back(tmp_path: Path) -> None:
    pyradiance = required("pyradiance")
    import os
    import subprocess

    folder = Path(pyradiance.__file__).parent / "bin"
    program = folder / "ra_xyze"
    if not program.exists():
        missing("this pyradiance has no ra_xyze")
    gray = PIXELS.copy()
    gray[..., :3] = gray[..., :1] | 128
    source = put(tmp_path, "a.hdr", hdr_header(4, 12, "EXPOSURE=4") + gray.tobytes())
    target = tmp_path / "b.hdr"
    with target.open("wb") as stream:
        environment = {**os.environ, "RAYPATH": str(tmp_path)}
        subprocess.run([program, source], stdout=stream, check=True, env=environment)
    assert b"xyze" in target.read_bytes()[:400]
    rows = read_picture(source).values
    # One more rounding to 8-bit mantissas, each at least 128: half a step is 0.4 %.
    np.testing.assert_allclose(read_picture(target).values, rows, rtol=0.012, atol=1e-6)


def test_primaries_lines(tmp_path: Path) -> None:
    plain = decoded(PIXELS).astype(np.float32)

    def read(line: str) -> np.ndarray:
        head = hdr_header(4, 12, f"PRIMARIES={line}")
        return read_picture(put(tmp_path, "a.hdr", head + PIXELS.tobytes())).values

    # Photoshop's zeros, Rec.709 and Radiance's own are channel-wise.
    for line in ("0 0 0 0 0 0 0 0", ".64 .33 .3 .6 .15 .06 .3127 .329",
                 "0.6400 0.3300 0.2900 0.6000 0.1500 0.0600 0.3333 0.3333"):  # fmt: skip
        np.testing.assert_array_equal(read(line), plain)
    # Rec.2020 (ITU-R BT.2087, table 2: its inverse matrix has 1.6605 −0.5876 −0.0728 on top).
    wide = read(".708 .292 .17 .797 .131 .046 .3127 .329")
    np.testing.assert_allclose(
        wide[..., 0], plain @ [1.6605, -0.5876, -0.0728], rtol=2e-3, atol=1e-3
    )
    with pytest.raises(InputError, match="colour space"):
        read(".3 .3 .3 .3 .3 .3 .3 .3")


@pytest.mark.parametrize(
    ("data", "match"),
    [
        (b"P6\n", "starts with #"),
        (b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n", "empty line"),
        (b"#?RADIANCE\n\n-Y 4", "resolution line"),
        (b"#?RADIANCE\n\n-Y 4 +Y 4\n" + bytes(99), "resolution line"),
        (b"#?RADIANCE\n\n-Y 0 +X 4\n" + bytes(99), "pixels"),
        (b"#?RADIANCE\nFORMAT=64-bit\n\n-Y 4 +X 4\n" + bytes(99), "FORMAT"),
        (b"#?RADIANCE\nEXPOSURE=0\n\n-Y 1 +X 4\n" + bytes(99), "EXPOSURE"),
        (b"#?RADIANCE\nEXPOSURE=x\n\n-Y 1 +X 4\n" + bytes(99), "EXPOSURE"),
        (b"#?RADIANCE\n\n-Y 2 +X 4\n" + bytes(20), "cut short"),
        (b"#?RADIANCE\n\n-Y 1 +X 4\n\1\1\1\3" + bytes(12), "beyond its end"),
        (b"#?RADIANCE\n\n-Y 1 +X 9\n\2\2\0\x08" + bytes(99), "9 pixels"),
        (b"#?RADIANCE\n\n-Y 1 +X 9\n\2\2\0\x09\xff\1" + bytes(99), "beyond its end|length 0"),
    ],
)
def test_bad_hdr_files_are_refused(data: bytes, match: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=match):
        read_picture(put(tmp_path, "a.hdr", data))


def write(path: Path, channels: dict[str, np.ndarray], **header: object) -> Path:
    import OpenEXR

    head = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage, **header}
    OpenEXR.File(head, dict(channels)).write(str(path))
    return path


COLOUR = np.random.default_rng(1).uniform(-1, 100, (3, 4, 3)).astype(np.float32)
PLANES = {name: np.ascontiguousarray(COLOUR[..., i]) for i, name in enumerate("RGB")}


def test_exr_rgb_rgba_half_and_layers(tmp_path: Path) -> None:
    path = tmp_path / "a.exr"
    alpha = {"A": np.full((3, 4), 0.5, np.float32)}
    for channels in (PLANES, PLANES | alpha, {f"beauty.{k}": v for k, v in PLANES.items()}):
        np.testing.assert_array_equal(read_picture(write(path, channels)).values, COLOUR)
    half = {name: COLOUR[..., i].astype(np.float16) for i, name in enumerate("RGB")}
    read = read_picture(write(path, half)).values
    assert read.dtype == np.float32
    np.testing.assert_array_equal(read, COLOUR.astype(np.float16).astype(np.float32))
    gray = read_picture(write(path, {"Y": PLANES["G"]})).values
    np.testing.assert_array_equal(gray, np.repeat(COLOUR[..., 1:2], 3, axis=-1))


@pytest.mark.parametrize(
    "channels",
    [
        {"Z": PLANES["R"]},
        {"R": PLANES["R"], "G": PLANES["G"]},
        {f"{layer}.{k}": v for layer in ("a", "b") for k, v in PLANES.items()},
        {"Y": PLANES["R"], "RY": PLANES["G"], "BY": PLANES["B"]},
    ],
    ids=["depth", "two", "two layers", "chroma"],
)
def test_exr_without_plain_colour_is_refused(
    channels: dict[str, np.ndarray], tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=r"must have channels R, G, B|chroma"):
        read_picture(write(tmp_path / "a.exr", channels))


@pytest.mark.parametrize(
    ("origin", "place", "part"),
    [
        ((1, 2), (slice(1, 4), slice(2, 6)), (slice(0, 3), slice(0, 4))),  # inside
        ((-1, -2), (slice(0, 2), slice(0, 2)), (slice(1, 3), slice(2, 4))),  # over the corner
        ((100, 100), (slice(0, 0), slice(0, 0)), (slice(0, 0), slice(0, 0))),  # nowhere
    ],
)
def test_data_windows_are_placed_in_the_display_window(
    origin: tuple[int, int], place: tuple[slice, slice], part: tuple[slice, slice], tmp_path: Path
) -> None:
    row, column = origin
    window = (np.array([column, row], np.int32), np.array([column + 3, row + 2], np.int32))
    display = (np.array([0, 0], np.int32), np.array([7, 5], np.int32))
    path = write(tmp_path / "a.exr", PLANES, dataWindow=window, displayWindow=display)
    expected = np.zeros((6, 8, 3), np.float32)
    expected[place] = COLOUR[part]
    np.testing.assert_array_equal(read_picture(path).values, expected)
    depth = read_depth_array(path)
    assert np.isnan(depth).sum() == 48 - expected[place][..., 0].size


def test_exr_chromaticities_are_converted(tmp_path: Path) -> None:
    path = tmp_path / "a.exr"
    rec709 = (*GRAY_XY, 0.3127, 0.3290)
    np.testing.assert_array_equal(
        read_picture(write(path, PLANES, chromaticities=rec709)).values, COLOUR
    )
    rec2020 = (0.708, 0.292, 0.170, 0.797, 0.131, 0.046, 0.3127, 0.3290)
    read = read_picture(write(path, PLANES, chromaticities=rec2020)).values
    # ITU-R BT.2087-0, table 2.
    matrix = [[1.6605, -0.5876, -0.0728], [-0.1246, 1.1329, -0.0083], [-0.0182, -0.1006, 1.1187]]
    np.testing.assert_allclose(read, COLOUR @ np.array(matrix).T, atol=0.02)
    # Neutral stays neutral under any white.
    flat = {name: np.full((2, 2), 3.0, np.float32) for name in "RGB"}
    warm = (*GRAY_XY, 0.3457, 0.3585)
    np.testing.assert_allclose(
        read_picture(write(path, flat, chromaticities=warm)).values, 3.0, rtol=1e-5
    )


def test_exr_attributes_are_kept(tmp_path: Path) -> None:
    picture = read_picture(write(tmp_path / "a.exr", PLANES, whiteLuminance=621.0, owner="me"))
    assert picture.attributes["whiteLuminance"] == 621.0
    assert picture.attributes["owner"] == "me"
    assert "channels" not in picture.attributes


def test_deep_exr_pictures_are_refused(tmp_path: Path) -> None:
    head = huge_exr(4).replace(b"\x02\0\0\0channels", b"\x02\x08\0\0channels")
    kind = b"type\0string\0" + struct.pack("<I", 12) + b"deepscanline"
    data = head.replace(b"lineOrder\0lineOrder", kind + b"lineOrder\0lineOrder")
    with pytest.raises(InputError):
        read_picture(put(tmp_path, "a.exr", data))


def test_damaged_exr_pixels_are_refused_and_nothing_is_printed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    data = write(tmp_path / "a.exr", PLANES).read_bytes()
    with pytest.raises(InputError, match="damaged or cut short"):
        read_picture(put(tmp_path, "a.exr", data[:-3]))
    assert capsys.readouterr().out == ""


def test_real_hdr_pictures(data_dir: Path) -> None:
    beach = read_picture(data_dir / "hdri_spiaggia/spiaggia_di_mondello_1k.hdr")
    assert beach.values.shape == (512, 1024, 3)
    assert beach.values.max() == pytest.approx(7.296e4)
    assert beach.values.mean() == pytest.approx(0.69, rel=0.01)
    fisheye = read_picture(data_dir / "radiance_tests/px/ref/test.hdr")
    assert fisheye.view_line == "-vta -vh 180 -vv 180"
    interior = read_picture(data_dir / "hdri_blender_cc0/interior.exr")
    assert interior.values.max() == pytest.approx(3.3e4, rel=0.05)
    assert interior.values.mean() == pytest.approx(0.95, rel=0.01)
    tree = read_picture(data_dir / "openexr_photos/Tree.exr")
    assert tree.attributes["whiteLuminance"] == 621.0
    sky = read_picture(data_dir / "hdri_pmndrs_cc0/sunrise.exr")
    assert sky.values.min() < -700  # the set's known ringing is handed on, not hidden
