"""Captures of every format: the same point at the same place, in metres, in our axes."""

import sys
from types import SimpleNamespace

import numpy as np
import pytest

from andon.errors import InputError, MachineError
from andon.files import decode_picture
from andon.files.captures import FORMATS, open_capture
from andon.spaces import WORLD_FROM_CAMERA_DEFAULT, invert_rigid
from comparison import assert_agree

from .folders import (
    DEPTH_M,
    INTRINSICS,
    PIXEL,
    WRITERS,
    world_from_camera,
    write_colmap,
    write_record3d,
    write_snapshot,
)

POSELESS = ("realsense", "realsense-snapshot")


@pytest.fixture(autouse=True)
def lzfse(monkeypatch):
    """Stored blocks need no decoder: those of tests are, so that none has to be installed."""

    def decompress(data):
        if data[:4] != b"bvx-" or data[-4:] != b"bvx$":
            raise ValueError("not stored")
        return data[8:-4]

    monkeypatch.setitem(sys.modules, "lzfse", SimpleNamespace(decompress=decompress))


def world_point(frame):
    """Where the red pixel's surface is."""
    height, width = frame.depth_m.shape
    row = int((PIXEL[1] + 0.5) * height / frame.view.height)
    column = int((PIXEL[0] + 0.5) * width / frame.view.width)
    ray = frame.view.rays_planar()[PIXEL[1], PIXEL[0]]
    pose = frame.view.world_from_camera
    return pose[:3, :3] @ ray * frame.depth_m[row, column] + pose[:3, 3]


def expected_point(intrinsics, pose):
    fx, fy, cx, cy = intrinsics
    ray = np.array([(PIXEL[0] - cx) / fx, (PIXEL[1] - cy) / fy, 1.0])
    return pose[:3, :3] @ ray * DEPTH_M + pose[:3, 3]


@pytest.mark.parametrize("name", WRITERS)
def test_every_format_puts_a_point_at_the_same_place(tmp_path, name):
    intrinsics = WRITERS[name](tmp_path)
    capture = open_capture(tmp_path)
    assert capture.format == name.removesuffix("-snapshot")
    assert len(capture.names) == 1
    frame = capture.read(0)
    assert_agree(
        [frame.view.fx, frame.view.fy, frame.view.cx, frame.view.cy], intrinsics, rtol=1e-6
    )
    assert frame.has_pose == (name not in POSELESS)
    pose = WORLD_FROM_CAMERA_DEFAULT if name in POSELESS else world_from_camera()
    assert_agree(frame.view.world_from_camera, pose, atol=1e-6)
    assert_agree(world_point(frame), expected_point(intrinsics, pose), atol=2e-4)
    assert np.isnan(frame.depth_m[0, 0])
    assert_agree(np.nanmax(frame.depth_m), 4.0, rtol=1e-6)
    picture = decode_picture(frame.photo.data, name)
    assert picture.shape == frame.view.shape
    red = picture.values[PIXEL[1], PIXEL[0]].astype(int)
    assert red[0] > red[1:].max() + 40


def test_every_format_has_a_specimen():
    assert set(WRITERS) == set(FORMATS)


@pytest.mark.parametrize("name", ["stray", "record3d"])
def test_what_the_sensor_does_not_trust_is_a_hole(tmp_path, name):
    WRITERS[name](tmp_path)
    depth = open_capture(tmp_path).read(0).depth_m
    assert np.isnan(depth[0, 2])
    assert np.isfinite(depth[0, 3])


def test_a_zip_of_record3d_is_the_folder(tmp_path):
    folder = tmp_path / "one"
    folder.mkdir()
    write_record3d(folder)
    write_record3d(tmp_path, tmp_path / "one.r3d")
    a, b = open_capture(folder).read(0), open_capture(tmp_path / "one.r3d").read(0)
    np.testing.assert_array_equal(a.depth_m, b.depth_m)
    assert a.photo == b.photo
    assert a.name == b.name


def test_without_lzfse_record3d_says_what_to_install(tmp_path, monkeypatch):
    write_record3d(tmp_path)
    monkeypatch.setitem(sys.modules, "lzfse", None)
    with pytest.raises(MachineError, match=r"rgbd/1.depth is packed by LZFSE.*pip install lzfse"):
        open_capture(tmp_path).read(0)


@pytest.mark.parametrize("binary", [False, True], ids=["text", "binary"])
def test_colmap_has_a_unit_of_its_own(tmp_path, binary):
    write_colmap(tmp_path, binary, unit_m=0.4)
    frame = open_capture(tmp_path, scale_to_m=0.4).read(0)
    assert_agree(world_point(frame), expected_point(INTRINSICS, world_from_camera()), atol=1e-5)
    assert "--scale-to-m states it" in open_capture(tmp_path).notes[-1]
    points = invert_rigid(frame.view.world_from_camera)
    assert_agree(frame.view.project((points @ [*world_point(frame), 1])[:3]), PIXEL, atol=1e-3)


# ── refusals ──────────────────────────────────────────────────────────────────────────────────


def refused(folder, rule, **options):
    with pytest.raises(InputError, match=rule):
        open_capture(folder, **options).read(0)


def replaced(path, old, new):
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


def test_no_capture_is_refused(tmp_path):
    refused(tmp_path, "is no capture of a known format: record3d, tum")
    refused(tmp_path / "gone", "must exist")


def test_a_scale_belongs_to_colmap(tmp_path):
    WRITERS["tum"](tmp_path)
    refused(tmp_path, "tum is in metres", scale_to_m=0.5)


def test_depth_of_another_camera_is_refused(tmp_path):
    write_snapshot(tmp_path, depth_fx=70.0)
    refused(tmp_path, "their intrinsics differ; align depth to colour")


@pytest.mark.parametrize(
    ("name", "file", "old", "new", "rule"),
    [
        ("tum", "rgb.txt", "rgb/1.000000.png", "../../etc/passwd", "must stay inside"),
        ("tum", "rgb.txt", "1.000000 ", "x ", "line 2: must be numbers, got 'x'"),
        ("tum", "depth.txt", "1.005000 d", "3.0 d", "no picture of rgb.txt has a depth .* 20 ms"),
        ("tum", "groundtruth.txt", "0 0 0 0 0 0 0 1", "0 0 0 0 1", "line 2: must have 8 numbers"),
        ("slambook", "pose.txt", "0 0 0 0 0 0 1", "# nothing", "has no line for 2.png"),
        ("realsense", "camera_intrinsic.json", '"width": 64', '"width": 65', "is 64×48 px, camera"),
        ("realsense", "camera_intrinsic.json", "{", "[{", "must be sound JSON"),
        ("realsense", "camera_intrinsic.json", "[60.0", "[-60.0", "camera.fx: must be > 0 px"),
        ("realsense-snapshot", "desk_Depth_metadata.csv", "Fx", "Gx", "must state fx"),
        ("realsense-snapshot", "desk_Depth_metadata.csv", "x,64", "x,640", "intrinsics differ"),
        ("record3d", "metadata", '"dw": 64', '"dw": 63', "must unpack to 12096 bytes, has 12288"),
        ("stray", "odometry.csv", "qw", "w", "must have the columns frame, x, y, z, qx"),
        ("stray", "odometry.csv", "000001", "000007", "has no depth of a frame"),
        ("arkitscenes", "lowres_wide.traj", "3386", "nan", "must be numbers, got 'nan"),
        ("colmap", "sparse/cameras.txt", "PINHOLE", "FISHEYE", "camera model FISHEYE is none of"),
        ("colmap", "sparse/images.txt", " a b.png", " ../a.png", "must stay inside"),
        ("colmap", "sparse/cameras.txt", "\n3 ", "\n4 ", "has no camera 3 of a b.png"),
    ],
)  # fmt: skip
def test_files_at_fault_are_named(tmp_path, name, file, old, new, rule):
    WRITERS[name](tmp_path)
    replaced(tmp_path / file, old, new)
    refused(tmp_path, rule)


def is_refused(folder):
    message = ""
    try:
        open_capture(folder).read(0)
    except InputError as error:
        message = str(error)
    assert "\n" not in message
    return bool(message)


@pytest.mark.parametrize("name", WRITERS)
def test_files_that_are_cut_short_are_refused_or_read(tmp_path, name):
    """Whatever is missing: one `InputError`, and nothing else."""
    WRITERS[name](tmp_path)
    files = [path for path in sorted(tmp_path.rglob("*")) if path.is_file()]
    faults = 0
    for path in files:
        whole = path.read_bytes()
        for count in (0, 1, len(whole) // 3, len(whole) // 2, len(whole) - 2):
            path.write_bytes(whole[:count])
            faults += is_refused(tmp_path)
        path.write_bytes(whole)
    assert faults >= 2 * len(files)


def test_a_header_that_claims_too_much_costs_nothing(tmp_path):
    write_colmap(tmp_path)
    path = tmp_path / "stereo" / "depth_maps" / "a b.png.geometric.bin"
    path.write_bytes(b"60000&60000&1&" + bytes(64))
    refused(tmp_path, "at most 32768")
    path.write_bytes(b"600&600&1&" + bytes(64))
    refused(tmp_path, "must have 1440010 bytes, is cut short at 74")
    path.write_bytes(b"6&6&3&" + bytes(640))
    refused(tmp_path, "has 3: a normal map")
