"""Reading, writing and meaning of scenes."""

import math
import subprocess
import sys
import types

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from andon.errors import InputError
from andon.scene import dump_scene, load_scene, parse_scene, scene_from_dict
from andon.scene.dump import toml_text
from andon.scene.reference import EXAMPLE


def test_an_empty_scene_has_defaults_and_no_stages():
    scene = parse_scene("")
    assert scene.photometry == "absolute"
    assert scene.scene.metres_per_unit == 1
    assert (scene.surface, scene.ambient, scene.glare, scene.lamp) == (None, None, None, ())
    assert scene.display.exposure is None
    assert scene.display.tone == "none"


def test_the_example(tmp_path):
    path = tmp_path / "desk.toml"
    path.write_text(EXAMPLE, encoding="utf-8")
    scene = load_scene(path)
    assert scene.folder == tmp_path
    assert scene.file == str(path)
    assert scene.lamp[0].flux_lm == 800
    assert scene.ambient.illuminance_lux == (120, 120, 120)
    assert scene.ambient.dimming == (0.3, 0.3, 0.3)
    assert scene.surface.depth.file == "depth.npy"
    assert scene.surface.depth.kind == "z"
    assert scene.surface.depth.max_jump == 0.05
    assert scene.surface.occluder_triangles == 30000


def test_a_byte_order_mark_is_no_syntax_error(tmp_path):
    path = tmp_path / "s.toml"
    path.write_bytes(b"\xef\xbb\xbf[scene]\nname = 'a'\r\n")
    assert load_scene(path).scene.name == "a"


def test_scenes_are_frozen():
    scene = parse_scene(EXAMPLE)
    with pytest.raises(ValidationError, match="frozen"):
        scene.lamp = ()
    with pytest.raises(ValidationError, match="frozen"):
        scene.lamp[0].flux_lm = 3


def test_arrays_and_tuples_serve_as_lists():
    scene = scene_from_dict(
        {
            "lamp": [
                {"kind": "point", "position": np.array([1, 2, 3]), "flux_lm": np.float32(8)},
                {"kind": "point", "position": (1, 2, 3), "flux_lm": np.int64(8)},
            ],
            "rig": {"camera": {"world_from_camera": np.eye(4)}},
        }
    )
    assert scene.lamp[0].position == scene.lamp[1].position == (1, 2, 3)
    assert np.array_equal(scene.rig.camera.pose(), np.eye(4))


def test_shorthands():
    def capture(response):
        return parse_scene(f"[capture]\nresponse = {response}").capture.response

    assert capture('"srgb"').kind == "srgb"
    assert capture('"gamma:2.2"').gamma == 2.2
    assert capture('{ kind = "curve", file = "r.csv" }').file == "r.csv"
    sources = parse_scene('[capture]\nsource = { left = "a", right = "b" }').capture.source
    assert (sources.left, sources.right) == ("a", "b")
    assert parse_scene('[capture]\nsource = "a"').capture.source == "a"


def test_unnamed_lamps_get_free_names():
    point = {"kind": "point", "position": [0, 0, 0], "flux_lm": 1}
    scene = scene_from_dict({"lamp": [point, point | {"name": "point-1"}, point]})
    assert [lamp.name for lamp in scene.lamp] == ["point-2", "point-1", "point-3"]


def test_holes_of_depth_may_be_infinite_and_nan_is_always_one():
    depth = parse_scene('[surface.depth]\nfile = "d"\ninvalid = [0, inf, -inf, nan]').surface.depth
    assert depth.invalid == (0, math.inf, -math.inf)


def test_normals_alone_or_with_depth():
    assert parse_scene('[surface]\nnormals = "n.png"').surface.depth is None
    assert (
        parse_scene('[surface]\nnormals = "n.png"\ndepth = "d.npy"').surface.depth.file == "d.npy"
    )


def test_camera_views():
    scene = parse_scene(
        "[rig.camera]\nhfov_degrees = 90\nposition = [0, 1, 2]\nlook_at = [0, 1, 0]"
    )
    ((name, camera),) = scene.rig.cameras
    view = camera.view(name, width=200, height=100)
    assert (view.width, view.height, view.cx, view.cy) == (200, 100, 99.5, 49.5)
    assert view.fx == view.fy == pytest.approx(100)
    assert view.position.tolist() == [0, 1, 2]
    assert np.allclose(view.world_from_camera[:3, 2], [0, 0, -1])
    default = parse_scene("[rig.camera]\nfx = 50").rig.camera
    assert np.allclose(default.view("mono", width=4, height=4).world_from_camera[:3, 2], [0, 0, -1])
    assert not default.has_pose


def test_fisheye_and_latlong_views():
    fisheye = parse_scene('[rig.camera]\nprojection = "fisheye"\nhfov_degrees = 180').rig.camera
    assert fisheye.view("mono", width=100, height=100).fx == pytest.approx(100 / np.pi)
    latlong = parse_scene('[rig.camera]\nprojection = "latlong"').rig.camera
    assert latlong.view("mono", width=64, height=32).projection == "latlong"


@pytest.mark.parametrize(
    ("camera", "size", "expected"),
    [
        ({"fx": 1}, (None, None), "rig.camera.width: the size is not known"),
        ({"fx": 1, "width": 5, "height": 5}, (6, 5), "rig.camera.width: is 5 px, but the picture"),
        ({}, (5, 5), "rig.camera.fx: has no focal length; state fx or hfov_degrees"),
        ({"file": "c.yml"}, (5, 5), "rig.camera.file: the intrinsics are in a file"),
    ],
)
def test_views_that_cannot_be_made(camera, size, expected):
    made = scene_from_dict({"rig": {"camera": camera}}).rig.camera
    with pytest.raises(InputError) as caught:
        made.view("mono", width=size[0], height=size[1])
    assert expected in str(caught.value)


def test_stereo_cameras():
    scene = parse_scene('[rig]\nkind = "stereo"\n[rig.left]\nfx = 9\n[rig.right]\nfx = 8')
    assert [(name, camera.fx) for name, camera in scene.rig.cameras] == [("left", 9), ("right", 8)]


def test_paths_are_resolved_against_the_folder_and_errors_name_the_field(monkeypatch, tmp_path):
    def confined(reference, folder):
        if ".." in reference:
            raise InputError("must stay inside", field="reference", remedy="use a relative path")
        return folder / reference

    stand_in = types.SimpleNamespace(confined=confined)
    monkeypatch.setitem(sys.modules, "andon.files.paths", stand_in)
    scene = parse_scene('[surface]\nmesh = "../room.obj"', folder=tmp_path)
    assert scene.path("a.png", "capture.source") == tmp_path / "a.png"
    with pytest.raises(InputError) as caught:
        scene.path(scene.surface.mesh, "surface.mesh")
    line = "scene.toml: surface.mesh: must stay inside; use a relative path"
    assert str(caught.value) == line


LAMP_TABLES = [
    {"kind": "point", "position": [1, 2, 3], "intensity_cd": 0.1, "shell": {"radius_m": 0.1}},
    {"kind": "spot", "position": [1, 2, 3], "direction": [0, 1, 0], "flux_lm": 1e-30},
    {"kind": "ies", "position": [1, 2, 3], "file": "a b.ies"},
    {"kind": "sphere", "position": [1, 2, 3], "radius_m": 1, "luminance_cd_m2": 5, "flicker": {}},
    {"kind": "disk", "position": [1, 2, 3], "direction": [1, 0, 0], "radius_m": 1, "flux_lm": 1},
    {"kind": "tube", "ends": [[0, 0, 0], [1, 0, 0]], "radius_m": 0.02, "flux_lm": 3000},
    {"kind": "polygon", "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "intensity_cd": 9},
    {"kind": "mesh", "mesh": "m.glb", "luminance_cd_m2": 7},
    {"kind": "directional", "direction": [0, -1, 0], "illuminance_lux": 1e5},
    {"kind": "sky", "illuminance_lux": 0, "rgb": [0.1, 0.2, 0.3]},
    {"kind": "hemisphere", "illuminance_lux": 3, "ground_illuminance_lux": 4},
    {
        "kind": "rectangle",
        "position": [1, 2, 3],
        "direction": [0, 0, 1],
        "width_m": 1,
        "height_m": 2,
        "flux_lm": 1,
    },
]
EVERYTHING = {
    "scene": {"name": 'a "quoted"\\ name\n\x7f 行灯', "photometry": "relative", "unit": "cm"},
    "rig": {"kind": "stereo", "left": {"fx": 9}, "right": {"file": "r.yml"}}
    | {"trajectory": {"file": "t.txt"}},
    "capture": {"source": {"left": "l", "right": "r"}, "response": "gamma:1.8", "pose": {}},
    "surface": {
        "depth": {"file": "d", "kind": "disparity", "baseline_m": 0.1, "invalid": [float("inf")]},
        "response": [{"illuminance_lux": [0, 1], "rgb": [[0, 0, 0], [1, 1, 1]]}],
    },
    "ambient": {"probes": True, "source": [LAMP_TABLES[0] | {"name": "window"}]}
    | {"removed": ["window"], "dimming_mode": "paper"},
    "lamp": LAMP_TABLES,
    "baked": {"folder": "maps"},
    "probes": {
        "volume": "v",
        "placement": {"kind": "lattice", "spacing_m": 1},
        "place": [{"position": [0, 0, 0]}],
    },
    "object": [{"mesh": "m", "scale": 2, "key": [{"time_seconds": 0, "position": [1, 1, 1]}]}],
    "glass": [
        {"radius_m": 0.075, "background": {"kind": "texture", "file": "b.png"}},
        {"shape": "lens", "radius_m": 1, "curvature_m": [1, -2], "thickness_m": 0.1},
    ],
    "observer": {"age": 70, "pupil_mm": 4},
    "gaze": {"source": "fixed", "distance_m": 0.6},
    "atmosphere": {"mist": 0.1},
    "glare": {},
    "display": {"mode": "ost", "peak_luminance_cd_m2": 500},
}


def test_everything_comes_back_from_toml():
    scene = scene_from_dict(EVERYTHING, folder="f", file="scene.toml")
    again = parse_scene(scene.to_toml(), folder="f")
    assert again == scene
    assert again.glare is not None  # an empty table is not an absent one
    assert [lamp.kind for lamp in again.lamp] == [table["kind"] for table in LAMP_TABLES]


def test_a_dumped_file_is_the_text(tmp_path):
    scene = parse_scene(EXAMPLE)
    text = dump_scene(scene, tmp_path / "out.toml")
    assert (tmp_path / "out.toml").read_text(encoding="utf-8") == text == scene.to_toml()


HOSTILE = (
    None,
    True,
    -1,
    0,
    1e308,
    -math.inf,
    math.nan,
    10**400,
    "",
    "../\0\n",
    [],
    [[]],
    {},
    [{}],
)


def variants(value):
    """The value with each of its parts replaced by each hostile value, one at a time."""
    yield from HOSTILE
    if isinstance(value, dict):
        for key, part in value.items():
            yield from ({**value, key: variant} for variant in variants(part))
    if isinstance(value, list):
        for index, part in enumerate(value):
            for variant in variants(part):
                yield [*value[:index], variant, *value[index + 1 :]]


def test_every_part_replaced_by_hostile_values_is_a_scene_or_one_line():
    accepted = refused = 0
    for tables in variants(EVERYTHING):
        try:
            scene = scene_from_dict(tables if isinstance(tables, dict) else {"x": tables})
        except InputError as error:
            assert "\n" not in str(error)  # noqa: PT017
            assert len(str(error)) < 600  # noqa: PT017
            refused += 1
            continue
        accepted += 1
        if accepted % 3 == 0:
            assert parse_scene(scene.to_toml(), file="scene") == scene
            scene.at(0)
    assert accepted > 200
    assert refused > 2000


NUMBERS = st.floats(-1e12, 1e12) | st.integers(-(10**6), 10**6)
TEXTS = st.text(st.characters(exclude_categories=["Cs"]), min_size=1, max_size=20)


@given(
    name=TEXTS,
    mesh=TEXTS,
    position=st.tuples(NUMBERS, NUMBERS, NUMBERS),
    flux_lm=st.floats(0, 1e300),
    times=st.lists(st.floats(-1e9, 1e9), max_size=4, unique=True),
    dimming=st.tuples(*[st.floats(0, 10)] * 3),
)
def test_round_trip(name, mesh, position, flux_lm, times, dimming):
    keys = [{"time_seconds": time, "flux_lm": flux_lm} for time in sorted(times)]
    lamp = {"kind": "point", "name": name, "position": position, "flux_lm": flux_lm, "key": keys}
    tables = {
        "lamp": [lamp],
        "surface": {"mesh": mesh},
        "ambient": {"illuminance_lux": 5, "dimming": dimming},
    }
    scene = scene_from_dict(tables, file="scene.toml")
    assert parse_scene(scene.to_toml()) == scene


def test_toml_of_odd_keys_and_empty_tables():
    tables = {"a b": {"": 1, "é": True}, "c": {}, "d": [{}, {"x": -0.0}], "e": [], "f": None}
    import tomllib

    again = tomllib.loads(toml_text(tables))
    assert again == {key: value for key, value in tables.items() if value is not None}
    assert math.copysign(1, again["d"][1]["x"]) == -1


def test_importing_andon_does_not_import_pydantic():
    code = "import sys, andon; sys.exit('pydantic' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_lamps_and_sources_without_names_do_not_collide():
    sky = {"kind": "sky", "illuminance_lux": 9.0}
    point = {"kind": "point", "position": (0, 0, 0), "flux_lm": 9.0}
    scene = scene_from_dict(
        {
            "lamp": [sky, point, point | {"name": "sky-2"}],
            "ambient": {"illuminance_lux": 1.0, "source": [sky, point]},
        }
    )
    assert [lamp.name for lamp in scene.lamp] == ["sky-1", "point-1", "sky-2"]
    assert scene.ambient is not None
    assert [lamp.name for lamp in scene.ambient.source] == ["sky-3", "point-2"]
