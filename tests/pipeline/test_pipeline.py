"""Scenes and arrays through the whole flow, on both engines; one rig with two eyes."""

import numpy as np
import pytest

import andon
from andon.engines.prepared import prepare
from andon.errors import InputError
from andon.files.pictures import write_exr, write_png
from andon.lamps import PointLamp
from andon.pipeline import Renderer
from andon.scene import scene_from_dict
from andon.spaces import View, look_at, transform_points
from comparison import assert_agree, assert_same_picture
from worlds import (
    block,
    scene,
    sphere_depth,
    write_glb,
    write_obj,
    write_relight_files,
    write_scene_files,
)

LAMP = {
    "kind": "point", "name": "lamp", "position": [-0.5, 0.3, -1.2], "intensity_cd": 60.0,
    "temperature_k": 2700.0, "visible_radius_m": 0.03,
}  # fmt: skip


def test_a_scene_on_both_engines(gpu, tmp_path):
    room = scene(tmp_path, lamp=[LAMP])
    expected, actual = (Renderer(room, name).render() for name in ("reference", "gpu"))
    assert_same_picture(actual.image.rgb, expected.image.rgb, tmp_path, share=0.01)
    assert_agree(actual.illuminance.lux, expected.illuminance.lux, rtol=3e-3, atol=0.1, share=0.01)
    for frame in (expected, actual):
        assert frame.report.photometry == "absolute"
        assert frame.report.hole_pixels == 15
        assert (frame.illuminance.lux[:3, :5] == 0).all()
        assert (frame.image.rgb[:3, :5] == np.rint(
            255 * andon.Response("srgb").encode(frame.captured.linear[:3, :5]))).all()  # fmt: skip
    assert (expected.image.rgb.astype(int) - read(tmp_path)).mean() > 3


def read(folder):
    from andon.files.pictures import read_picture

    return read_picture(folder / "photo.png").values


def test_arrays_and_files_give_the_same(engine, tmp_path):
    photo, depth, view = write_relight_files(tmp_path)
    lamp = {k: v for k, v in LAMP.items() if k != "temperature_k"}
    by_files = andon.render(scene(tmp_path, lamp=[lamp]), engine=engine)
    by_arrays = andon.relight(
        photo, view, [PointLamp("lamp", np.array(lamp["position"]), np.full(3, 60.0),
                                visible_radius_m=0.03)],
        depth_m=depth, ambient_lux=200.0, engine=engine,
    )  # fmt: skip
    assert (by_arrays.image.rgb == by_files.image.rgb).all()


CURVE = {"kind": "curve", "file": "curve.csv"}


@pytest.mark.parametrize(
    "response", ["srgb", "linear", "gamma:2.2", {"kind": "gamma", "gamma": 1.8}, CURVE]
)
def test_no_lamps_no_change_through_files(engine, tmp_path, response):
    from worlds import ALL_CODES

    tables = write_scene_files(tmp_path)
    write_png(tmp_path / "photo.png", ALL_CODES)
    depth = np.full((16, 48), 2.0)
    depth[4:9, 7:30] = np.nan
    np.save(tmp_path / "depth.npy", depth)
    rows = [f"{x},{x**1.8},{x**2.2},{x**2.6}" for x in np.linspace(0, 1, 9)]
    text = "\n".join(["encoded,linear_r,linear_g,linear_b", *rows])
    (tmp_path / "curve.csv").write_text(text)
    tables["capture"]["response"] = response
    frame = Renderer(scene_from_dict(tables, folder=tmp_path), engine).render()
    assert (frame.image.rgb == ALL_CODES).all()
    assert frame.report.hole_pixels == 5 * 23


def test_a_fisheye_and_a_panorama_through_files(engine, tmp_path):
    for projection in ("fisheye", "latlong"):
        tables = write_scene_files(tmp_path, lamp=[LAMP])
        camera = {"projection": projection}
        if projection == "fisheye":
            camera["hfov_degrees"] = 150.0
        tables["rig"] = {"camera": camera}
        frame = Renderer(scene_from_dict(tables, folder=tmp_path), engine).render()
        assert frame.surface.view.projection == projection
        assert np.isfinite(frame.luminance.cd_m2).all()
        assert frame.illuminance.lux.max() > 5


# ── stereo ────────────────────────────────────────────────────────────────────────────────────

BASELINE = 0.12


def stereo_scene(folder, **tables):
    """Two pictures of one ball before a wall, and the left one's depth."""
    _, depth, view = write_relight_files(folder)
    for name in ("left", "right"):
        write_png(folder / f"{name}.png", np.full((*view.shape, 3), 110, np.uint8))
    np.save(folder / "depth.npy", np.where(np.isfinite(depth), depth, 2.5))
    poses = []
    for shift in (-BASELINE / 2, BASELINE / 2):
        pose = np.diag([1.0, -1, -1, 1])
        pose[0, 3] = shift
        poses.append({"fx": view.fx, "world_from_camera": pose.tolist()})
    base = {
        "rig": {"kind": "stereo", "left": poses[0], "right": poses[1]},
        "capture": {"source": {"left": "left.png", "right": "right.png"}},
        "surface": {"depth": "depth.npy", "occluder_triangles": 0},
        "ambient": {"illuminance_lux": 200.0},
        "lamp": [LAMP],
    }
    return scene_from_dict(base | tables, folder=folder)


def test_both_eyes_see_the_same_light(engine, tmp_path):
    renderer = Renderer(stereo_scene(tmp_path), engine)
    assert renderer.view_names == ("left", "right")
    left, right = renderer.render(view="left"), renderer.render(view="right")
    assert left.captured.view.name == "left"
    assert right.report.maps_redrawn == 0, "the second eye draws no shadow map again"
    view = right.surface.view
    points = left.surface.position
    pixels = view.project(transform_points(view.camera_from_world, points))
    column, row = np.moveaxis(np.rint(pixels), -1, 0).astype(int)
    inside = left.surface.valid & (column >= 0) & (column < view.width)
    inside &= np.abs(pixels - np.rint(pixels)).max(axis=-1) < 0.1
    lit = inside.copy()
    there = right.surface.position[row[inside], column[inside]]
    lit[inside] = np.linalg.norm(there - points[inside], axis=-1) < 0.01
    assert lit.sum() > 50
    here = left.illuminance.lux[lit]
    beyond = right.illuminance.lux[row[lit], column[lit]]
    assert here.max() > 20
    # The pixel next to it is up to a tenth of a pixel away; shadow edges may fall between.
    assert_agree(beyond, here, rtol=0.03, atol=0.3, share=0.03)


def test_the_first_view_is_drawn_unless_another_is_named(tmp_path):
    renderer = Renderer(stereo_scene(tmp_path), "reference")
    assert renderer.render().captured.view.name == "left"
    with pytest.raises(
        InputError, match=r"no view 'rigth', this rig has left and right; did you m"
    ):
        renderer.render(view="rigth")


def test_lamps_are_where_they_are_for_both_eyes(engine, tmp_path):
    """The disc moves by baseline·f/z pixels from eye to eye."""
    renderer = Renderer(stereo_scene(tmp_path), engine)
    columns = []
    for name in ("left", "right"):
        luminance = renderer.render(view=name).luminance.cd_m2[..., 0]
        weight = np.where(luminance > 0.5 * luminance.max(), luminance, 0)
        columns.append((weight.sum(axis=0) * np.arange(64)).sum() / weight.sum())
    assert columns[0] - columns[1] == pytest.approx(BASELINE * 57.6 / 1.2, abs=0.35)


def test_stereo_agrees_between_engines(gpu, tmp_path):
    room = stereo_scene(tmp_path)
    for name in ("left", "right"):
        expected = Renderer(room, "reference").render(view=name)
        actual = Renderer(room, "gpu").render(view=name)
        assert_same_picture(actual.image.rgb, expected.image.rgb, tmp_path, share=0.02, what=name)


def test_one_picture_for_two_eyes_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"capture\.source: is one picture for two eyes"):
        prepare(stereo_scene(tmp_path, capture={"source": "left.png"}))


# ── time ──────────────────────────────────────────────────────────────────────────────────────


def test_a_lamp_moves_by_its_keys_and_its_map_is_drawn_again(engine, tmp_path):
    keys = [{"time_seconds": 0.0, "position": [-0.5, 0.3, -1.2]},
            {"time_seconds": 2.0, "position": [0.5, 0.3, -1.2]}]  # fmt: skip
    renderer = Renderer(scene(tmp_path, lamp=[{**LAMP, "key": keys}]), engine)
    first, again, later = (renderer.render(t) for t in (0.0, 0.0, 2.0))
    assert (first.image.rgb == again.image.rgb).all()
    assert again.report.maps_redrawn == 0
    if engine == "gpu":
        assert later.report.maps_redrawn == 1
    half = first.illuminance.lux.shape[1] // 2
    assert first.illuminance.lux[:, :half].mean() > later.illuminance.lux[:, :half].mean()
    still = Renderer(
        scene(tmp_path, lamp=[{**LAMP, "position": [0.5, 0.3, -1.2]}]), engine
    ).render()
    assert (still.image.rgb == later.image.rgb).all()


# ── objects and meshes through files ──────────────────────────────────────────────────────────


def test_an_object_is_lit_hides_and_casts_a_shadow(engine, tmp_path):
    write_glb(tmp_path / "box.glb", block((0.3, 0.3, 0.1), (0, 0, 0)))
    box = {"mesh": "box.glb", "position": [-0.45, 0.2, -1.8]}
    lamp = {**LAMP, "visible_radius_m": 0.0}
    without = Renderer(scene(tmp_path, lamp=[lamp]), engine).render()
    casting = Renderer(scene(tmp_path, lamp=[lamp], object=[box]), engine).render()
    ghost = Renderer(
        scene(tmp_path, lamp=[lamp], object=[{**box, "casts_shadow": False}]), engine
    ).render()
    seen = casting.surface.is_object
    assert 30 < seen.sum() < 600
    reflectance = casting.surface.reflectance[seen]
    assert_agree(reflectance, np.broadcast_to([0.8, 0.4, 0.2], reflectance.shape), atol=0.01)
    expected = reflectance * (200 + casting.illuminance.lux[seen]) / np.pi
    assert_agree(casting.luminance.cd_m2[seen], expected, rtol=5e-3, atol=0.05)
    rest = ~seen
    assert_agree(ghost.illuminance.lux[rest], without.illuminance.lux[rest], rtol=1e-3, atol=0.1)
    shadowed = rest & (casting.illuminance.lux[..., 0] < 0.5 * without.illuminance.lux[..., 0])
    assert shadowed.sum() > 100


def test_a_mesh_receives_light_by_the_closed_form(engine, tmp_path):
    """A floor 1 m below a point lamp of 100 cd: 100·cos φ/d² = 100/d³ lx."""
    pose = look_at(np.array([0.0, 1, 1]), np.array([0.0, 0, -0.5]))
    write_obj(tmp_path / "floor.obj", block((6, 0.2, 6), (0, -0.1, 0)))
    tables = write_scene_files(tmp_path)
    tables["rig"]["camera"]["world_from_camera"] = pose.tolist()
    tables["surface"] = {"mesh": "floor.obj"}
    tables["lamp"] = [{"kind": "point", "position": [0, 1, -0.5], "intensity_cd": 100}]
    frame = Renderer(scene_from_dict(tables, folder=tmp_path), engine).render()
    ground = frame.surface.valid & (frame.surface.normal[..., 1] > 0.9)
    assert ground.mean() > 0.5
    away = np.linalg.norm(frame.surface.position[ground] - (0, 1, -0.5), axis=-1)
    expected = np.repeat((100 / away**3)[:, None], 3, axis=1)
    assert_agree(frame.illuminance.lux[ground], expected, rtol=2e-3, atol=0.05)


def test_a_map_of_e0_through_files(engine, tmp_path):
    tables = write_scene_files(tmp_path, lamp=[LAMP])
    shape = read(tmp_path).shape
    write_exr(tmp_path / "e0.exr", np.full(shape, 200, np.float32), unit="lx")
    constant = Renderer(scene_from_dict(tables, folder=tmp_path), engine).render()
    tables["ambient"] = {"map": "e0.exr"}
    mapped = Renderer(scene_from_dict(tables, folder=tmp_path), engine).render()
    difference = np.abs(mapped.image.rgb.astype(int) - constant.image.rgb)
    assert difference.max() <= 1
    assert difference.mean() < 0.02


# ── arrays that do not fit ────────────────────────────────────────────────────────────────────

VIEW = View("pinhole", 20, 10, 15.0, 15.0, 9.5, 4.5)
PHOTO = np.full((10, 20, 3), 90, np.uint8)
DEPTH = np.full((10, 20), 2.0)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"photo": PHOTO[:, :-1]}, "is 19×10 px but the camera is 20×10"),
        ({"photo": PHOTO[..., 0]}, r"photo: must be \(H, W, 3\)"),
        ({"photo": PHOTO.astype(int)}, "photo: must be"),
        ({"photo": PHOTO * np.float32(np.nan)}, "NaN"),
        ({"depth_m": DEPTH.T}, "depth_m: must be an array"),
        ({"depth_m": DEPTH * np.nan}, "no pixel with a depth above 0"),
        ({"ambient_lux": 0.0}, "ambient_lux: must be finite and > 0"),
        ({"ambient_lux": [1.0, 2.0]}, "ambient_lux: must be a number"),
        ({"ambient_lux": [1.0, np.nan, 2.0]}, "ambient_lux: must be finite"),
        ({"dimming": -0.1}, "dimming: must be ≥ 0"),
        ({"dimming": np.inf}, "dimming: must be ≥ 0"),
        ({"dimming": [1.0, 2.0]}, "dimming: must be"),
        ({"engine": "gpuu"}, "engine: must be one of auto, gpu, reference"),
        ({"view": View(**{**vars(VIEW), "distortion": (0.1, 0, 0, 0)})}, "undistort"),
    ],
)
def test_arrays_that_do_not_fit_are_refused(changed, message):
    given = {"photo": PHOTO, "view": VIEW, "depth_m": DEPTH, "ambient_lux": 100.0} | changed
    photo, view = given.pop("photo"), given.pop("view")
    with pytest.raises(InputError, match=message):
        andon.relight(photo, view, [], **({"engine": "reference"} | given))


def test_inputs_are_not_written_to():
    photo, depth = PHOTO.copy(), DEPTH.copy()
    depth[0, 0] = 0
    kept = depth.copy()
    for array in (photo, depth):
        array.flags.writeable = False
    andon.relight(photo, VIEW, [], depth_m=depth, ambient_lux=100.0, engine="reference")
    assert (depth == kept).all()


def test_a_ball_by_the_closed_form(engine):
    """A lamp at the eye: E = I·cos φ/d² with cos φ = −n·ray, on every pixel of the ball."""
    view = View("pinhole", 80, 80, 120.0, 120.0, 39.5, 39.5)
    depth, normal = sphere_depth(view, (0, 0, 2.0), 0.4)
    photo = np.full((80, 80, 3), 90, np.uint8)
    lamp = PointLamp("eye", np.array([0.0, 0, 0]), np.array([50.0, 25, 10]), None)
    frame = andon.relight(photo, view, [lamp], depth_m=depth, ambient_lux=50.0, engine=engine)
    rays = view.directions()
    cosine = -np.einsum("...i,...i->...", normal, rays)
    steep = cosine > 0.5
    away = np.linalg.norm(view.rays_planar() * depth[..., None], axis=-1)
    expected = (cosine / away**2)[steep, None] * lamp.intensity_cd
    # Normals of a curved surface from 7×7 pixels: two hundredths at the rim.
    assert_agree(frame.illuminance.lux[steep], expected, rtol=0.025)
    assert frame.image.rgb[steep].min() > 90
