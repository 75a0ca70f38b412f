"""Scenes without a photograph: everything in them is virtual."""

import numpy as np
import pytest

import andon
from andon.errors import InputError
from andon.scene import scene_from_dict
from worlds import block, sheet, write_glb, write_obj, write_scene_files

RHO = np.array([0.8, 0.4, 0.2])
SUN = {"kind": "directional", "direction": [0.0, -1.0, -0.75], "illuminance_lux": 1000.0}


def virtual(folder, geometry=None, **tables):
    floor = sheet((-20, -1, 20), (40, 0, 0), (0, 0, -40)) if geometry is None else geometry
    write_glb(folder / "floor.glb", floor, colour=RHO)
    base = {
        "rig": {"camera": {"width": 40, "height": 30, "fx": 30.0}},
        "surface": {"mesh": "floor.glb"},
        "lamp": [SUN],
    }
    return scene_from_dict(base | tables, folder=folder)


def test_a_floor_under_a_directional_lamp_is_the_closed_form(tmp_path, engine):
    frame = andon.render(virtual(tmp_path), engine=engine)
    seen = frame.surface.valid
    assert 0.3 < seen.mean() < 0.7, "the floor fills the lower half"
    expected = RHO / np.pi * 1000.0 * 0.8  # the lamp stands 0.8 of the way up
    # Half floats of the picture, and 8 bits of √ρ.
    np.testing.assert_allclose(
        frame.luminance.cd_m2[seen], np.broadcast_to(expected, (seen.sum(), 3)), rtol=6e-3
    )
    np.testing.assert_array_equal(frame.luminance.cd_m2[~seen], 0)


def test_its_reflectance_may_be_stated(tmp_path, engine):
    surface = {"mesh": "floor.glb", "reflectance": 0.25}
    frame = andon.render(virtual(tmp_path, surface=surface), engine=engine)
    got = frame.luminance.cd_m2[frame.surface.valid]
    np.testing.assert_allclose(got, 0.25 / np.pi * 800, rtol=1e-2)  # 8 bits of √ρ


def test_white_is_what_distant_lamps_give(tmp_path):
    sky = {"kind": "sky", "illuminance_lux": 500.0}
    point = {"kind": "point", "position": [0, 1, -2], "intensity_cd": 1e5}
    scene = virtual(tmp_path, lamp=[SUN, sky, point], ambient={"illuminance_lux": 70.0})
    frame = andon.render(scene, engine="reference")
    assert frame.captured.luminance_per_unit == pytest.approx(1570 / np.pi)


def test_white_may_be_stated(tmp_path):
    scene = virtual(tmp_path, capture={"luminance_per_unit": 123.0})
    assert andon.render(scene, engine="reference").captured.luminance_per_unit == 123.0


def test_without_distant_lamps_it_has_to_be(tmp_path):
    point = {"kind": "point", "position": [0, 1, -2], "intensity_cd": 100.0}
    with pytest.raises(InputError, match=r"capture\.luminance_per_unit: is missing"):
        andon.render(virtual(tmp_path, lamp=[point]), engine="reference")


def test_ambient_light_is_on_everything(tmp_path, engine):
    ambient = {"illuminance_lux": [100.0, 200.0, 400.0], "dimming": 0.5}
    frame = andon.render(virtual(tmp_path, lamp=[], ambient=ambient), engine=engine)
    expected = RHO / np.pi * [50, 100, 200]
    seen = frame.surface.valid
    np.testing.assert_allclose(
        frame.luminance.cd_m2[seen], np.broadcast_to(expected, (seen.sum(), 3)), rtol=6e-3
    )


def test_what_its_materials_emit_is_seen(tmp_path, engine):
    write_glb(tmp_path / "light.glb", sheet((-1, -1, -3), (2, 0, 0), (0, 2, 0)),
              colour=(0, 0, 0), emissive=(1.0, 0.5, 0.25))  # fmt: skip
    scene = virtual(
        tmp_path, surface={"mesh": "light.glb"}, lamp=[], capture={"luminance_per_unit": 1.0}
    )
    frame = andon.render(scene, engine=engine)
    middle = frame.luminance.cd_m2[15, 20]
    np.testing.assert_allclose(middle / middle[0], [1, 0.5, 0.25], rtol=2e-3)
    assert middle[0] > 0


def test_other_objects_stand_on_it_and_cast_shadows(tmp_path, engine):
    write_obj(tmp_path / "box.obj", block((1, 1, 1), (0, 0, 0)))
    down = SUN | {"direction": [0.0, -1.0, 0.0]}
    box = {"mesh": "box.obj", "position": [0.0, 2.0, -4.0], "name": "box"}
    frame = andon.render(virtual(tmp_path, lamp=[down], object=[box]), engine=engine)
    points = frame.surface.position
    below = (np.abs(points[..., 0]) < 0.3) & (np.abs(points[..., 2] + 4) < 0.3)
    assert below.any()
    np.testing.assert_allclose(frame.luminance.cd_m2[below & (points[..., 1] < 0)], 0, atol=1e-3)


def test_what_moves_keeps_its_material_beside_the_surface(tmp_path, engine):
    write_glb(tmp_path / "box.glb", block((1, 1, 1), (0, 0, 0)), colour=(0.1, 0.2, 0.9))
    keys = [{"time_seconds": t, "position": [x, 0, -4]} for t, x in ((0, -9), (1, 0))]
    box = {"mesh": "box.glb", "name": "box", "key": keys}
    ambient = {"illuminance_lux": 100.0}
    scene = virtual(tmp_path, lamp=[], ambient=ambient, object=[box])
    renderer = andon.Renderer(scene, engine)
    before, after = (renderer.render(t).luminance.cd_m2 for t in (0.0, 1.0))
    np.testing.assert_allclose(after[14, 20], np.array([0.1, 0.2, 0.9]) * 100 / np.pi, rtol=0.02)
    np.testing.assert_array_equal(before[14, 20], 0)
    np.testing.assert_allclose(after[-1, 20], RHO * 100 / np.pi, rtol=6e-3)


@pytest.mark.parametrize("projection", ["fisheye", "latlong"])
def test_curved_views_see_it_too(tmp_path, engine, projection):
    camera = {"projection": projection, "width": 48, "height": 24}
    if projection == "fisheye":
        camera["fx"] = 15.0
    frame = andon.render(virtual(tmp_path, rig={"camera": camera}), engine=engine)
    got = frame.luminance.cd_m2[frame.surface.valid]
    assert frame.surface.valid.any()
    np.testing.assert_allclose(got, np.broadcast_to(RHO / np.pi * 800, got.shape), rtol=6e-3)


def test_both_eyes_see_it(tmp_path, engine):
    eye = {"width": 32, "height": 24, "fx": 20.0}
    rig = {
        "kind": "stereo",
        "left": eye | {"position": [-0.3, 0, 0], "look_at": [-0.3, 0, -1]},
        "right": eye | {"position": [0.3, 0, 0], "look_at": [0.3, 0, -1]},
    }
    floor = sheet((0, -1, 20), (20, 0, 0), (0, 0, -40))  # one half: its edge shifts between eyes
    renderer = andon.Renderer(virtual(tmp_path, floor, rig=rig), engine)
    left, right = (renderer.render(view=name) for name in ("left", "right"))
    assert left.surface.valid.sum() != right.surface.valid.sum()
    for frame in (left, right):
        assert frame.luminance.cd_m2[frame.surface.valid].min() > 0


def test_both_engines_agree(tmp_path, gpu):
    room = block((6, 3, 8), (0, 0.5, -2), inwards=True)
    lamp = {"kind": "point", "position": [1.0, 1.0, -3.0], "intensity_cd": 300.0}
    scene = virtual(
        tmp_path, room, lamp=[lamp, SUN | {"shadow": False}],
        rig={"camera": {"width": 160, "height": 120, "hfov_degrees": 90,
                        "position": [0.13, 0.07, 0.9], "look_at": [0.3, 0.2, -4]}},
    )  # fmt: skip
    frames = [andon.render(scene, engine=name) for name in ("reference", "gpu")]
    codes = [frame.image.rgb.astype(int) for frame in frames]
    assert codes[0].mean() > 20
    difference = np.abs(codes[0] - codes[1]).max(axis=-1)
    assert (difference <= 5).mean() >= 0.999
    assert difference.mean() <= 0.5


REFUSED = {
    r"capture\.source: there is neither a photograph nor a mesh": {"surface": None},
    r"surface\.depth: belongs to a photograph": {"surface": {"depth": "depth.npy"}},
    r"surface\.normals: belongs to a photograph": {"surface": {"normals": "normals.png"}},
    r"ambient\.map: belongs to a photograph": {"ambient": {"map": "e0.exr"}},
    r"ambient\.source: belongs to a photograph": {
        "ambient": {"illuminance_lux": 1.0, "source": [SUN]}
    },
    r"rig\.camera\.width: the size is not known": {"rig": {"camera": {"fx": 30.0}}},
    r"rig\.camera: is missing": {"rig": None},
    r"lamp\[0\]\.position: the lamp .* is inside a wall": {
        "lamp": [{"kind": "point", "position": [0, 0.5, -30], "intensity_cd": 1.0}],
        "capture": {"luminance_per_unit": 1.0},
    },
}


@pytest.mark.parametrize("message", REFUSED)
def test_what_is_missing_is_said(tmp_path, message):
    tables = REFUSED[message]
    geometry = block((6, 3, 8), (0, 0.5, -2), inwards=True) if "wall" in message else None
    scene = virtual(tmp_path, geometry, **tables)
    nothing = {key: None for key, table in tables.items() if table is None}
    with pytest.raises(InputError, match=message):
        andon.render(scene.model_copy(update=nothing), engine="reference")


def test_a_photograph_is_still_one(tmp_path, engine):
    scene = scene_from_dict(write_scene_files(tmp_path), folder=tmp_path)
    assert scene.has_photograph
    frame = andon.render(scene, engine=engine)
    assert not frame.surface.is_object.any()
    assert frame.image.rgb.any()
