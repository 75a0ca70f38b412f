"""What a bake of maps will do, and what it refuses before it does anything."""

import numpy as np
import pytest

from andon.bake.maps import plan_maps
from andon.bake.maps.moments import moments_of, moving_things
from andon.errors import InputError
from map_scenes import CAMERAS, camera, room_scene, room_tables, write_room
from worlds import ball, write_glb, write_relight_files


def box_object(**changes):
    return {"name": "box", "mesh": "ball.glb"} | changes


KEYS = [{"time_seconds": 0.0, "position": [0, 0, 0]}, {"time_seconds": 1.0, "position": [1, 0, 0]}]


def moving_scene(folder, *, duration=1.0, rate=None, **entry):
    write_glb(folder / "ball.glb", ball(0.2, (0, 0, 0), 2))
    about = {"duration_seconds": duration, "frames_per_second": 4.0}
    baked = {} if rate is None else {"frames_per_second": rate}
    return room_scene(
        folder, scene=about, baked=baked, object=[box_object(**({"key": KEYS} | entry))]
    )


def test_a_still_scene_has_one_moment(tmp_path):
    assert moments_of(room_scene(tmp_path)) == (0.0,)
    assert moments_of(room_scene(tmp_path, scene={"duration_seconds": 5.0})) == (0.0,)


@pytest.mark.parametrize(
    ("duration", "rate", "times"),
    [
        (1.0, None, [0, 0.25, 0.5, 0.75, 1]),
        (1.0, 2.0, [0, 0.5, 1]),
        (1.1, 2.0, [0, 0.5, 1, 1.1]),
        (0.3, 2.0, [0, 0.3]),
        (0.7, 10.0, np.arange(8) / 10),
    ],
)
def test_moments_reach_from_the_start_to_the_end(tmp_path, duration, rate, times):
    moments = moments_of(moving_scene(tmp_path, duration=duration, rate=rate))
    np.testing.assert_allclose(moments, times)


def test_too_many_moments_are_refused(tmp_path):
    with pytest.raises(InputError, match=r"baked\.frames_per_second: .*7200 moments; light betwe"):
        moments_of(moving_scene(tmp_path, duration=86400.0))


@pytest.mark.parametrize(
    ("changes", "moving"),
    [
        ({}, ("object[0]",)),
        ({"casts_shadow": False}, ("object[0]",)),
        ({"casts_shadow": False, "lit_by_lamps": False}, ()),
        ({"key": []}, ()),
    ],
)
def test_objects_that_matter_move(tmp_path, changes, moving):
    assert moving_things(moving_scene(tmp_path, **changes)) == moving


LAMP_KEYS = [{"time_seconds": 0.0, "intensity_cd": 1.0}, {"time_seconds": 1.0, "intensity_cd": 2.0}]


@pytest.mark.parametrize(
    ("name", "more", "moving"),
    [
        ("left", {"transport": "baked"}, ("lamp[0]",)),
        ("other", {}, ()),
        ("other", {"shell": {"radius_m": 0.1, "transmittance": 0.5}}, ("lamp[0]",)),
    ],
)
def test_lamps_that_matter_move(tmp_path, name, more, moving):
    lamp = {"name": name, "kind": "point", "position": [0, 0, 0], "intensity_cd": 1.0}
    lamps = [lamp | {"key": LAMP_KEYS} | more, room_tables()["lamp"][1]]
    baked = {"lamps": ["right"] + (["left"] if name == "left" else [])}
    assert moving_things(room_scene(tmp_path, lamp=lamps, baked=baked)) == moving


def test_a_plan_counts_maps_points_and_time(tmp_path):
    plan = plan_maps(room_scene(tmp_path))
    assert [view.name for view in plan.views] == ["camera-1", "camera-2"]
    assert (plan.seen, plan.coverage, plan.moments) == ((1.0, 1.0), None, (0.0,))
    assert plan.parts == {"left": "all", "right": "bounce"}
    assert (plan.light_tasks, plan.points) == (4, 4 * 48 * 36)
    each = plan.quality.seconds_per_100k_points / 1e5
    assert plan.estimated_seconds == pytest.approx(each * 4 * 48 * 36)
    assert not (tmp_path / "maps").exists()


def test_a_plan_finds_cameras(tmp_path):
    scene = room_scene(tmp_path, baked={"camera": [], "map_size_px": 64, "coverage": 0.9})
    plan = plan_maps(scene)
    assert plan.coverage is not None
    assert plan.coverage >= 0.9
    assert [view.name for view in plan.views] == [
        f"camera-{number}" for number in range(1, len(plan.views) + 1)
    ]
    assert max(max(view.shape) for view in plan.views) == 64
    again = plan_maps(scene)
    for view, other in zip(plan.views, again.views, strict=True):
        np.testing.assert_array_equal(view.world_from_camera, other.world_from_camera)


def test_a_camera_file_of_a_map(tmp_path):
    write_room(tmp_path)
    (tmp_path / "c.toml").write_text(
        "[camera]\nwidth = 20\nheight = 10\nfx = 10.0\ndistortion = [0.1, 0, 0, 0]\n"
    )
    stated = {"file": "c.toml", "position": [0, 0, 2], "look_at": [0, 0, 0]}
    (view,) = plan_maps(room_scene(tmp_path, baked={"camera": [stated]})).views
    assert (view.name, view.shape, view.distortion) == ("camera-1", (10, 20), ())
    np.testing.assert_allclose(view.position, [0, 0, 2])


REFUSED = {
    "no table": ({"baked": None}, "baked: is missing: nothing says what to bake; add"),
    "no lamps": ({"lamp": [], "baked": {"lamps": []}}, r"baked\.lamps: names no lamp"),
    "a lamp twice": (
        {"baked": {"lamps": ["left", "right", "left"]}},
        r"baked\.lamps\[2\]: names 'left' twice",
    ),
    "a folder that is a file": ({"baked": {"folder": "room.glb"}}, r"baked\.folder: must be a fo"),
    "no folder for the folder": ({"baked": {"folder": "a/b"}}, r"baked\.folder: .*; make it"),
    "a folder elsewhere": ({"baked": {"folder": "../maps"}}, r"baked\.folder: .*must stay inside"),
    "a camera without a focal length": (
        {"baked": {"camera": [{"width": 8, "height": 8}]}},
        r"baked\.camera\[0\]\.fx: has no focal length",
    ),
    "a camera that sees nothing": (
        {"baked": {"camera": [CAMERAS[0], camera((9, 0, 0), (20, 0, 0))]}},
        r"baked\.camera\[1\]: sees no surface; look_at",
    ),
    "a huge camera": (
        {"baked": {"camera": [CAMERAS[0] | {"width": 60000, "height": 60000}]}},
        r"baked\.camera\[0\]\.width: has 60000×60000 pixels",
    ),
    "an include that is not there": (
        {"baked": {"include": ["desk.rad"]}},
        r"desk\.rad.*: must exist",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_a_plan_refuses(tmp_path, case):
    changes, words = REFUSED[case]
    if changes.get("baked", 0) is None:
        lamp = {"name": "a", "kind": "point", "position": [0, 0, 0], "intensity_cd": 1.0}
        scene = room_scene(tmp_path, lamp=[lamp], baked={"lamps": []})
        scene = scene.model_copy(update={"baked": None})
    else:
        scene = room_scene(tmp_path, **changes)
    with pytest.raises(InputError, match=words):
        plan_maps(scene)
    assert not (tmp_path / "maps").exists()


def test_programs_in_an_include_are_refused_unless_trusted(tmp_path):
    (tmp_path / "desk.rad").write_text("!genbox wood desk 1 1 1\n")
    with pytest.raises(InputError, match=r"desk\.rad"):
        plan_maps(room_scene(tmp_path, baked={"include": ["desk.rad"]}))


def test_normals_have_no_places(tmp_path):
    write_room(tmp_path)
    write_relight_files(tmp_path)
    from andon.files.pictures import write_png

    write_png(tmp_path / "n.png", np.full((48, 64, 3), [128, 128, 255], np.uint8))
    tables = room_tables(
        surface={"normals": "n.png"},
        capture={"source": "photo.png"},
        rig={"camera": {"fx": 57.6}},
        ambient={"illuminance_lux": 100.0},
        lamp=[
            {
                "name": "left", "kind": "directional", "direction": [0, -1, -1],
                "illuminance_lux": 10.0, "transport": "baked",
            }
        ],
        baked={"lamps": ["left"]},
    )  # fmt: skip
    from andon.scene import scene_from_dict

    with pytest.raises(InputError, match=r"surface\.normals: has no positions.*give a depth"):
        plan_maps(scene_from_dict(tables, folder=tmp_path))
