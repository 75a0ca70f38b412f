"""Conventions of space and pixels: each test fails if its convention is turned round."""

import numpy as np
import pytest

import andon
from andon.engines.prepared import prepare
from andon.engines.reading import view_of
from andon.files.pictures import read_picture, write_exr, write_picture
from andon.gbuffer import VIEW_RECORD, pack_view
from andon.glass.model import Ball, Slab, Solid
from andon.glass.paths import trace
from andon.glass.pencils import vergence
from andon.gpu.layout import HostStruct
from andon.harmonics import cube_directions
from andon.scene import scene_from_dict
from andon.spaces import View, invert_rigid, rotate, transform_points
from andon.surface.depth import DepthEncoding, depth_from_raw
from andon.surface.objects import object_geometry
from andon.surface.triangulate import triangulate_depth

from .settings import ORIGIN, VIEW, X, Y, Z, close, grey, lamps_of, relit


def test_world(tmp_path):
    """A mesh in centimetres with z up: its z becomes +Y, its y becomes −Z; nothing is mirrored."""
    (tmp_path / "m.obj").write_text("v 100 0 0\nv 0 100 0\nv 0 0 100\nf 1 2 3\n")
    tables = {"scene": {"unit": "cm", "up": "z"}, "object": [{"mesh": "m.obj"}]}
    geometry = object_geometry(andon.scene_from_dict(tables, folder=tmp_path), 0)
    corners = geometry.positions[geometry.triangles[0]]
    start = int(np.argmax(corners[:, 0]))
    close(np.roll(corners, -start, axis=0), [X, -Z, Y])
    assert np.linalg.det([X, -Z, Y]) > 0


def test_camera_frame():
    d = VIEW.directions()
    close(d[1, 2], Z)
    assert d[1, 3][0] > 0, "the pixel to the right looks towards +x"
    assert d[2, 2][1] > 0, "the pixel below looks towards +y"


def test_default_pose():
    origin, directions = VIEW.rays_world()
    close(origin, ORIGIN)
    close(directions[1, 2], -Z)
    assert directions[0, 2] @ Y > 0, "the upper row looks up"
    assert directions[1, 3] @ X > 0, "the right column looks right"


def test_matrices():
    world_from_camera = andon.look_at(np.array([1.0, 2, 3]), np.array([1.0, 2, -5]))
    point = np.array([0.1, 0.2, 4.0])
    close(transform_points(world_from_camera, point), (world_from_camera @ [*point, 1])[:3])
    close(rotate(world_from_camera, point), world_from_camera[:3, :3] @ point)
    close(world_from_camera[:3, 3], [1, 2, 3])  # the translation is the last column
    close(invert_rigid(world_from_camera) @ world_from_camera, np.eye(4))


def test_matrices_in_wgsl():
    """WGSL reads columns one after the other: the translation comes last."""
    matrix = np.eye(4)
    matrix[:3, 3] = [7, 8, 9]
    struct = HostStruct("S", (("m", "mat4x4f"),))
    words = np.frombuffer(struct.pack(m=matrix).tobytes(), np.float32)
    close(words[12:], [7, 8, 9, 1])
    close(words[[3, 7, 11]], 0)


def test_pixel_centres():
    corner = View("pinhole", 4, 4, 10.0, 10.0, 0.0, 0.0)
    close(corner.directions()[0, 0], Z)
    close(corner.project(Z), [0, 0])
    # Twice the pixels: the old centre (0, 0) lies between the four new ones around (½, ½).
    twice = corner.resized(8, 8)
    close([twice.cx, twice.cy, twice.fx], [0.5, 0.5, 20])


def test_row_0_is_the_top(tmp_path):
    picture = np.zeros((2, 3, 3), np.uint8)
    picture[0] = 255
    write_picture(tmp_path / "a.png", picture)
    assert (read_picture(tmp_path / "a.png").values[0] == 255).all()
    write_exr(tmp_path / "a.exr", picture.astype(np.float32), unit="lx")
    assert (read_picture(tmp_path / "a.exr").values[0] == 255).all()


def test_half_pixel_of_the_gpu():
    record = pack_view(VIEW)[0]
    assert record.dtype == VIEW_RECORD.dtype
    close(record["centre"], [VIEW.cx + 0.5, VIEW.cy + 0.5])
    # What WGSL does at its pixel centre (2.5, 1.5) is what NumPy does at (2, 1).
    close((np.array([2.5, 1.5]) - record["centre"]) / record["focal"], [0, 0])


def test_fisheye():
    """Image radius = f·θ: 90° off the axis is f·π/2 pixels away."""
    view = View("fisheye", 3, 3, 10.0, 10.0, 1.0, 1.0)
    close(view.project(X), [1 + 10 * np.pi / 2, 1])


def test_latlong():
    _, directions = View("latlong", 5, 3).rays_world()
    close(directions[1, 2], -Z)
    assert directions[1, 3] @ X > 0.9, "right of the middle is +X"
    assert directions[0, 2] @ Y > 0.8, "above the middle is +Y"
    close(View("latlong", 8, 4).solid_angles().sum(), 4 * np.pi)


def test_upright(tmp_path):
    """Orientation 6: the stored left column is the top row."""
    from PIL import Image

    stored = np.zeros((32, 16, 3), np.uint8)
    stored[:, :8] = 255
    exif = Image.Exif()
    exif[0x0112] = 6
    Image.fromarray(stored).save(tmp_path / "a.jpg", exif=exif, quality=95)
    values = read_picture(tmp_path / "a.jpg").values
    assert values.shape == (16, 32, 3)
    assert values[:6].min() > 200
    assert values[10:].max() < 50


def test_undistorted(tmp_path):
    write_picture(tmp_path / "a.png", grey())
    np.save(tmp_path / "d.npy", np.full(VIEW.shape, 2.0))
    tables = {
        "rig": {"camera": {"fx": 4.0, "distortion": [0.1, 0, 0, 0]}},
        "capture": {"source": "a.png"},
        "surface": {"depth": "d.npy"},
        "ambient": {"illuminance_lux": 100},
    }
    frame = prepare(andon.scene_from_dict(tables, folder=tmp_path)).frames["mono"]
    assert frame.view.distortion == ()


def test_depth_is_planar():
    """A wall at z = 2 has depth 2 in every pixel, and its corners are farther away than that."""
    points = VIEW.rays_planar() * 2.0
    close(points[..., 2], 2.0)
    length = np.linalg.norm(points, axis=-1)
    assert length[0, 0] > 2.1
    raw = depth_from_raw(length, VIEW, DepthEncoding("distance"))
    close(raw, 2.0)
    close(depth_from_raw(np.full(VIEW.shape, 2.0), VIEW, DepthEncoding("z")), 2.0)


def test_disparity():
    encoding = DepthEncoding("disparity", baseline_m=0.2, doffs_px=1.0)
    close(depth_from_raw(np.full(VIEW.shape, 3.0), VIEW, encoding), 0.2 * VIEW.fx / 4.0)


def test_holes():
    raw = np.full(VIEW.shape, 2.0)
    raw[0] = [0, -1, np.nan, np.inf, 9]
    depth = depth_from_raw(raw, VIEW, DepthEncoding(invalid=(9.0,)))
    assert np.isnan(depth[0]).all()
    assert relit(grey(), depth=depth).report.hole_pixels == 5


@pytest.mark.parametrize(("step", "triangles"), [(1.04, 2), (1.06, 0)])
def test_jumps(step, triangles):
    depth = np.array([[1.0, step], [1.0, step]])
    geometry = triangulate_depth(depth, View("pinhole", 2, 2, 2.0, 2.0, 0.5, 0.5))
    assert len(geometry.triangles) == triangles


def test_quaternions(tmp_path):
    """(0, sin 45°, 0, cos 45°) turns by 90° about +Y: +Z goes to +X."""
    half = np.sqrt(0.5)
    tables = {"object": [{"mesh": "a.glb", "rotation_xyzw": [0, half, 0, half]}]}
    placed = andon.scene_from_dict(tables).object[0].world_from_object()
    close(rotate(placed, Z), X)


def test_angles():
    table = {"kind": "spot", "position": [0, 0, 0], "direction": [0, -1, 0], "intensity_cd": 1}
    (lamp,) = lamps_of(table | {"inner_degrees": 30, "outer_degrees": 60})
    close([lamp.inner_radians, lamp.outer_radians], [np.pi / 6, np.pi / 3])


def test_cube_maps():
    directions = cube_directions(2)
    close(directions.mean(axis=(1, 2)) * np.sqrt(1.5), [X, -X, Y, -Y, Z, -Z])
    first = np.sign(directions[:, 0, 0])  # row 0, column 0 of each face
    close(first, [[1, 1, 1], [-1, 1, -1], [-1, 1, -1], [-1, -1, 1], [-1, 1, 1], [1, 1, -1]])


def test_eyes_apart():
    camera = {"width": 4, "height": 4, "hfov_degrees": 60.0}
    tables = {"rig": {"kind": "stereo", "camera": camera}, "observer": {"interpupillary_mm": 60.0}}
    scene = scene_from_dict(tables)
    left, right = (view_of(scene, name, None).world_from_camera for name in ("left", "right"))
    np.testing.assert_allclose(left[:3, 3], [-0.03, 0, 0])
    np.testing.assert_allclose(right[:3, 3], [0.03, 0, 0])
    np.testing.assert_array_equal(left[:3, :3], right[:3, :3])


def test_vergence():
    ahead, eye = np.array([[0.0, 0.0, -1.0]]), np.array([[0.0, 0.0, 0.4]])
    bare = trace((), eye, ahead)
    np.testing.assert_allclose(
        vergence(bare.pencil, np.array([2.0]), ahead)[0], 0.5 * np.eye(2), atol=1e-12
    )
    # Refracted once by a ball, light of a point 0.2 m behind its middle converges behind the eye.
    entered = trace((Solid("ball", Ball(0.075), interfaces=1),), eye, ahead)
    behind = vergence(entered.pencil, np.array([0.275]), ahead)[0]
    assert np.linalg.eigvalsh(behind).max() < 0


def test_stickers():
    ahead = np.array([[0.0, 0.0, -1.0]])
    points = {(0.0, 0.0): (0.5, 0.5), (0.03, 0.0): (0.56, 0.5), (0.0, 0.03): (0.5, 0.37)}
    for (x, y), expected in points.items():
        seen = trace((Solid("ball", Ball(0.075)),), np.array([[x, y, 0.4]]), ahead)
        np.testing.assert_allclose(seen.uv[0], expected, atol=0.01)
    slab = Solid("slab", Slab(np.array([0.1, 0.05, 0.01])))
    seen = trace((slab,), np.array([[0.05, 0.025, 0.4]]), ahead)
    np.testing.assert_allclose(seen.uv[0], [0.75, 0.25])
