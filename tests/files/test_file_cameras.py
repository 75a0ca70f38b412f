"""Camera files: TOML round trips, OpenCV's and ROS's spellings, and what is refused."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from andon.errors import InputError
from andon.files import read_camera, write_camera
from andon.spaces import View, look_at

from .specimens import CAMERA_YAML


def put(folder: Path, name: str, text: str | bytes) -> Path:
    path = folder / name
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return path


positive = st.floats(1e-3, 1e6)
coefficient = st.floats(-10, 10)


@settings(max_examples=40, deadline=None)
@given(
    st.sampled_from(["pinhole", "fisheye", "latlong"]),
    st.integers(1, 65536),
    st.integers(1, 65536),
    st.tuples(positive, positive, coefficient, coefficient),
    st.sampled_from([0, 4]),
    st.tuples(coefficient, coefficient, coefficient),
    st.text(max_size=8),
)
def test_toml_round_trips_to_the_last_bit(
    tmp_path_factory: pytest.TempPathFactory,
    projection: str,
    width: int,
    height: int,
    intrinsics: tuple[float, ...],
    coefficients: int,
    position: tuple[float, float, float],
    name: str,
) -> None:
    flat = projection == "latlong"
    view = View(
        projection,  # type: ignore[arg-type]
        width,
        height,
        *((0.0,) * 4 if flat else intrinsics),
        distortion=() if flat else tuple(np.linspace(-0.3, 0.1, coefficients)),
        world_from_camera=look_at(np.array(position), np.add(position, (1, 2, -3))),
        name=name,
    )
    path = tmp_path_factory.getbasetemp() / "camera.toml"
    read = read_camera(write_camera(path, view))
    np.testing.assert_array_equal(read.world_from_camera, view.world_from_camera)
    for key in ("projection", "width", "height", "fx", "fy", "cx", "cy", "distortion", "name"):
        assert getattr(read, key) == getattr(view, key)


def test_defaults_put_the_axis_in_the_middle(tmp_path: Path) -> None:
    view = read_camera(put(tmp_path, "a.toml", "width = 4\nheight = 3\nfx = 5\n"))
    assert (view.projection, view.fy, view.cx, view.cy) == ("pinhole", 5.0, 1.5, 1.0)
    np.testing.assert_array_equal(view.world_from_camera, np.diag([1, -1, -1, 1]))


@pytest.mark.parametrize(("projection", "hfov"), [("pinhole", 90.0), ("fisheye", 180.0)])
def test_hfov_spans_the_picture_from_edge_to_edge(
    projection: str, hfov: float, tmp_path: Path
) -> None:
    text = f'[camera]\nprojection="{projection}"\nwidth=100\nheight=50\nhfov_degrees={hfov}\n'
    view = read_camera(put(tmp_path, "a.toml", text))
    half = np.radians(hfov / 2)
    edge = view.project(np.array([np.sin(half), 0.0, max(np.cos(half), 0.0)]))
    np.testing.assert_allclose(edge, [99.5, 24.5], atol=1e-9)


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("width=4\nheight=3\nfx=5\nfz=1\n", "unknown key 'fz'; did you mean 'f"),
        ("[camera]\nwidht=4\nheight=3\nfx=5\n", "did you mean 'width'"),
        ("[camera]\nwidth=4\nheight=3\nfx=5\n[other]\n", "unknown key 'other'"),
        ("width=4\nheight=3\n", "exactly one of fx and hfov_degrees"),
        ("width=4\nheight=3\nfx=5\nhfov_degrees=50\n", "exactly one"),
        ("height=3\nfx=5\n", "must have 'width'"),
        ("width=4.5\nheight=3\nfx=5\n", "width: must be a whole number"),
        ("width=0\nheight=3\nfx=5\n", "width: must be 1"),
        ("width=4\nheight=3\nfx=-5\n", "fx: must be > 0"),
        ("width=4\nheight=3\nfx=nan\n", "finite"),
        ('width=4\nheight=3\nfx="5"\n', "must be a number"),
        ("width=4\nheight=3\nfx=true\n", "must be a number"),
        ('width=4\nheight=3\nfx=5\nprojection="ortho"\n', "one of pinhole, fisheye, latlong"),
        ("width=4\nheight=3\nfx=5\ndistortion=[1,2,3]\n", "0 or 4 or 5 or 8 or 12 or 14 numbers"),
        ("width=4\nheight=3\nfx=5\nworld_from_camera=[[1,0,0,0]]\n", "4 rows of 4"),
        ("width=4\nheight=3\nfx=5\nworld_from_camera=[[2,0,0,0],[0,2,0,0],[0,0,2,0],[0,0,0,1]]\n",
         "rigid"),
        ("width = \n", "sound TOML"),
        (b"\xff\xfe", "sound TOML"),
    ],
)  # fmt: skip
def test_bad_toml_is_refused_with_its_place(text: str | bytes, match: str, tmp_path: Path) -> None:
    path = put(tmp_path, "a.toml", text)
    with pytest.raises(InputError, match=match) as caught:
        read_camera(path)
    assert str(path) in str(caught.value)


def check_reference_camera(view: View) -> None:
    assert (view.width, view.height, view.projection) == (640, 480, "pinhole")
    assert (view.fx, view.fy, view.cx, view.cy) == (500.0, 510.0, 320.0, 240.0)
    assert view.distortion == (0.1, -0.2, 0.001, 0.002, 0.05)


@pytest.mark.parametrize("head", ["%YAML:1.0\n---", "%YAML:1.0", "%YAML 1.2\n---", "---", ""])
def test_opencv_yaml_with_every_head(head: str, tmp_path: Path) -> None:
    body = CAMERA_YAML.decode().removeprefix("%YAML:1.0\n---\n")
    check_reference_camera(read_camera(put(tmp_path, "a.yml", f"{head}\n{body}")))


def test_opencv_json_and_ros_yaml_and_plain_lists(tmp_path: Path) -> None:
    matrix = [500.0, 0, 320, 0, 510, 240, 0, 0, 1]
    coefficients = [0.1, -0.2, 0.001, 0.002, 0.05]

    def stored(rows: int, cols: int, data: list[float]) -> dict[str, object]:
        return {"type_id": "opencv-matrix", "rows": rows, "cols": cols, "dt": "d", "data": data}

    opencv = {
        "image_width": 640,
        "image_height": 480,
        "camera_matrix": stored(3, 3, matrix),
        "distortion_coefficients": stored(5, 1, coefficients),
    }
    check_reference_camera(read_camera(put(tmp_path, "a.json", json.dumps(opencv))))
    plain = {
        "image_size": [640, 480],
        "K": [matrix[:3], matrix[3:6], matrix[6:]],
        "D": [coefficients],
        "distortion_model": "plumb_bob",
    }
    check_reference_camera(read_camera(put(tmp_path, "b.json", json.dumps(plain))))
    ros = f"""
image_width: 640
image_height: 480
camera_name: head
camera_matrix: {{rows: 3, cols: 3, data: {matrix}}}
distortion_model: plumb_bob
distortion_coefficients: {{rows: 1, cols: 5, data: {coefficients}}}
"""
    check_reference_camera(read_camera(put(tmp_path, "c.yaml", ros)))


@pytest.mark.parametrize(
    "line", ["fisheye_model: 1", "model: fisheye", "distortion_model: equidistant"]
)
def test_fisheye_is_recognised(line: str, tmp_path: Path) -> None:
    text = f"K: [300, 0, 99.5, 0, 300, 49.5, 0, 0, 1]\nD: [0.1, 0, 0, 0]\n{line}\n"
    view = read_camera(put(tmp_path, "a.yml", text), size=(200, 100))
    assert (view.projection, view.distortion) == ("fisheye", (0.1, 0.0, 0.0, 0.0))


def test_the_size_is_needed_and_must_agree(tmp_path: Path) -> None:
    path = put(tmp_path, "a.yml", "K: [300, 0, 99.5, 0, 300, 49.5, 0, 0, 1]\n")
    with pytest.raises(InputError, match="image_width and image_height"):
        read_camera(path)
    assert read_camera(path, size=(200, 100)).shape == (100, 200)
    for name, data in (("b.yml", CAMERA_YAML), ("c.toml", b"width=640\nheight=480\nfx=5\n")):
        other = put(tmp_path, name, data)
        assert read_camera(other, size=(640, 480)).width == 640
        with pytest.raises(InputError, match="is for 640×480 px, the picture has 480×640"):
            read_camera(other, size=(480, 640))


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("a: 1\n", "must hold a camera matrix; known names are"),
        ("[1, 2]\n", "must be a table"),
        ("K: [500, 1, 3, 0, 500, 2, 0, 0, 1]\n", "no skew"),
        ("K: [500, 0, 3, 0, 500, 2, 0, 0, 2]\n", "3×3"),
        ("K: [500, 0, 3]\n", "3×3"),
        ("K: [[500, 0, 3], [0, 500]]\n", "equal length"),
        ("K: {rows: 3, cols: 3, data: [1, 2]}\n", "3×3 numbers, has 2"),
        ("K: [500, 0, 3, 0, .nan, 2, 0, 0, 1]\n", "finite"),
        ("K: [500, 0, 3, 0, -5, 2, 0, 0, 1]\n", "> 0"),
        ("K: [500, 0, 3, 0, 500, 2, 0, 0, 1]\nmodel: mei\n", "one of pinhole"),
        ("K: [500, 0, 3, 0, 500, 2, 0, 0, 1]\nD: [1, 2, 3]\n", "numbers for pinhole, got 3"),
        ("K: &a [500, 0, 3, 0, 500, 2, 0, 0, 1]\nD: *a\n", "aliases"),
        ("a: !!python/object/apply:os.system ['true']\n", "sound YAML"),
        ("a: [1\n", "sound YAML"),
        ("a: b: c\n", "sound YAML"),
        (b"\xff\xfe\xff", "UTF-8"),
    ],
)
def test_bad_calibrations_are_refused(text: str | bytes, match: str, tmp_path: Path) -> None:
    path = put(tmp_path, "a.yml", text)
    with pytest.raises(InputError, match=match) as caught:
        read_camera(path, size=(8, 8))
    assert str(path) in str(caught.value)


def test_real_calibrations(data_dir: Path) -> None:
    folder = data_dir / "opencv_calib"
    left = read_camera(folder / "left_intrinsics.yml")
    assert (left.width, left.height) == (640, 480)
    assert left.fx == pytest.approx(535.9157, abs=1e-4)
    assert left.distortion[0] == pytest.approx(-0.26637, abs=1e-5)
    stereo = read_camera(folder / "intrinsics.yml", size=(640, 480))  # M1, D1
    assert stereo.fx == pytest.approx(534.8033, abs=1e-4)
    marker = read_camera(data_dir / "aruco_video/single/intrinsics.yml")  # has .Nan elsewhere
    assert (marker.fx, marker.cy) == (628.158, 260.908)
    for name in ("calibration.yml", "detector_params.yml", "tutorial_dict.yml"):
        with pytest.raises(InputError, match="camera matrix"):
            read_camera(folder / name)
