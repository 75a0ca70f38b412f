"""Two eyes of one camera: the rig states the point between them."""

import numpy as np
import pytest

import andon
from andon.errors import InputError
from andon.scene import scene_from_dict
from worlds import sheet, write_glb

CAMERA = {"width": 40, "height": 30, "fx": 30.0}
SUN = {"kind": "directional", "direction": [0.0, 0.0, -1.0], "illuminance_lux": 1000.0}


def room(folder, camera=CAMERA, **tables):
    write_glb(folder / "wall.glb", sheet((-5, -5, -2), (10, 0, 0), (0, 10, 0)))
    base = {
        "rig": {"kind": "stereo", "camera": camera},
        "surface": {"mesh": "wall.glb"},
        "lamp": [SUN],
    }
    return scene_from_dict(base | tables, folder=folder)


def poses(scene):
    prepared = andon.Renderer(scene, "reference").prepared
    return {name: frame.view.world_from_camera for name, frame in prepared.frames.items()}


def test_eyes_stand_apart_along_the_camera_s_right(tmp_path):
    # Looks along +x with y up, so that its right is +z.
    pose = [[0, 0, 1, 0.5], [0, -1, 0, 0.25], [1, 0, 0, 1.0], [0, 0, 0, 1]]
    scene = room(
        tmp_path, CAMERA | {"world_from_camera": pose}, observer={"interpupillary_mm": 70.0}
    )
    found = poses(scene)
    assert list(found) == ["left", "right"]
    np.testing.assert_allclose(found["left"][:3, 3], [0.5, 0.25, 1.0 - 0.035])
    np.testing.assert_allclose(found["right"][:3, 3], [0.5, 0.25, 1.0 + 0.035])
    for name in found:
        np.testing.assert_array_equal(found[name][:3, :3], np.array(pose, float)[:3, :3])


def test_they_are_63_mm_apart_unless_stated(tmp_path):
    found = poses(room(tmp_path))
    np.testing.assert_allclose(found["right"][:3, 3] - found["left"][:3, 3], [0.063, 0, 0])


def test_what_is_near_shifts_by_parallax(tmp_path, engine):
    write_glb(tmp_path / "bar.glb", sheet((-0.05, -1, -1), (0.1, 0, 0), (0, 2, 0)))
    scene = room(tmp_path, object=[{"mesh": "bar.glb"}], observer={"interpupillary_mm": 100.0})
    renderer = andon.Renderer(scene, engine)
    rows = {}
    for name in renderer.view_names:
        surface = renderer.render(view=name).surface
        rows[name] = np.nonzero((surface.depth[15] < 1.5) & surface.valid[15])[0].mean()
    # 0.1 m apart, 1 m away, 30 px a metre there.
    assert rows["left"] - rows["right"] == pytest.approx(3.0, abs=0.6)


def test_one_camera_or_two_eyes(tmp_path):
    with pytest.raises(InputError, match=r"rig\.left: left and camera exclude each other"):
        scene_from_dict(
            {"rig": {"kind": "stereo", "camera": CAMERA, "left": CAMERA}}, folder=tmp_path
        )
