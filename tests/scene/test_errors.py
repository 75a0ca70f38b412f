"""Every refusal is one line that names file, field, rule and remedy."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from andon.errors import InputError
from andon.scene import load_scene, parse_scene, scene_from_dict

POINT = '[[lamp]]\nkind = "point"\nposition = [0, 1, 2]\n'
SPOT = '[[lamp]]\nkind = "spot"\nposition = [0, 0, 0]\ndirection = [0, 0, 1]\nflux_lm = 1\n'

CASES = [
    # unknown names, with the nearest known one
    ("lamps = 1", "lamps: unknown key 'lamps'; did you mean 'lamp'?"),
    (POINT + "intensty_cd = 3", "lamp[0].intensty_cd: unknown key 'intensty_cd'; did you mean"),
    ('[[lamp]]\nkind = "pont"', "lamp[0].kind: must be one of 'point', "),
    ('[[lamp]]\nkind = "pont"', "got 'pont'; did you mean 'point'?"),
    (POINT + "flux_lm = 1\nradius_m = 3", "kind 'point' has no key 'radius_m'; only sphere, "),
    ('[capture]\nresponse = "gama"', "capture.response.kind: must be one of 'linear'"),
    ("[atmosphere]\nqqqqq = 1", "unknown key 'qqqqq'; known keys: mist"),
    ('[[lamp]]\nkind = "bulb"', 'lamp[0].kind: bulb is a preset; write preset = "bulb"'),
    (POINT + "flux_lm = 1\nwidth_m = 3", "only rectangle has width_m"),
    (
        POINT.replace("point", "sphere") + "shell.radius_m = 1",
        "only point, spot and ies have a shel",
    ),
    # missing
    ("[[lamp]]\nposition = [1, 1, 1]", "lamp[0].kind: is required"),
    ('[[lamp]]\nkind = "point"\nflux_lm = 1', "lamp[0].position: is required; add 'position = …'"),
    ("[baked]", "baked.folder: is required"),
    (POINT, "lamp[0]: intensity_cd or flux_lm is required"),
    ('[[lamp]]\nkind = "sky"', "lamp[0]: illuminance_lux is required"),
    ('[rig]\nkind = "stereo"\n[rig.left]', "rig.right: a stereo rig needs both eyes; add [rig.ri"),
    ("[surface]", "surface: exactly one of mesh, depth, normals is allowed, got none"),
    (
        "[ambient]",
        "ambient: exactly one of illuminance_lux, map, probes, harmonics, rest_lux is allowed, "
        "got none",
    ),
    ('[surface.depth]\nfile = "d"\nkind = "disparity"', "surface.depth.baseline_m: kind 'dispari"),
    ("[[glass]]", "glass[0].radius_m: shape 'sphere' needs radius_m"),
    ('[display]\nmode = "ost"', "display.peak_luminance_cd_m2: mode 'ost' needs it; state the"),
    # too many
    (POINT + "intensity_cd = 1\nflux_lm = 1", "exactly one of intensity_cd, flux_lm is allowed, g"),
    (
        POINT + "flux_lm = 1\nrgb = [1, 1, 1]\ntemperature_k = 3000",
        "at most one of chromaticity_xy",
    ),
    ('[surface]\nmesh = "a"\ndepth = "b"', "got mesh and depth"),
    ('[surface]\nmesh = "a"\nnormals = "b"', "got mesh and normals"),
    ('[ambient]\nmap = "a"\nilluminance_lux = 3', "got illuminance_lux and map"),
    ("[observer]\npupil_mm = 3\npupil_model = 'moon-spencer'", "pupil_mm and pupil_model exclude"),
    # ranges, with the unit
    (POINT + "intensity_cd = -5", "lamp[0].intensity_cd: must be ≥ 0 cd, got -5"),
    (POINT + "flux_lm = nan", "lamp[0].flux_lm: must be finite, got nan"),
    (POINT + "flux_lm = inf", "lamp[0].flux_lm: must be finite, got inf"),
    (POINT + "flux_lm = 1\ntemperature_k = 999", "temperature_k: must be ≥ 1000 K, got 999"),
    (POINT + "flux_lm = 1\ntemperature_k = 40001", "temperature_k: must be ≤ 40000 K, got 40001"),
    (POINT + "flux_lm = 1\nrgb = [0, 0, 0]", "lamp[0].rgb: at least one channel must be > 0"),
    (POINT + "flux_lm = 1\nchromaticity_xy = [0.6, 0.5]", "chromaticity_xy: x + y must be ≤ 1"),
    (POINT + "flux_lm = 1\ndaylight = true", "lamp[0].daylight: daylight needs temperature_k"),
    (POINT + "flux_lm = 1\ndaylight = true\ntemperature_k = 2000", "daylight needs 4000…25000 K"),
    (SPOT + "inner_degrees = 45", "lamp[0].inner_degrees: must be < outer_degrees, 45, got 45"),
    (SPOT + "outer_degrees = 90.5", "lamp[0].outer_degrees: must be ≤ 90 °, got 90.5"),
    ("[ambient]\nilluminance_lux = 0", "ambient.illuminance_lux: must be > 0 lx, got 0"),
    ("[ambient]\nilluminance_lux = [1, 0, 1]", "ambient.illuminance_lux[1]: must be > 0 lx, got"),
    ("[ambient]\nilluminance_lux = 1\ndimming = -1", "ambient.dimming: must be ≥ 0, got -1"),
    ("[glare]\nminimum_angle_degrees = 11", "glare.minimum_angle_degrees: must be ≤ 10 °, got 11"),
    ("[observer]\nage = 121", "observer.age: must be ≤ 120, got 121"),
    ("[rig.camera]\nwidth = 0", "rig.camera.width: must be ≥ 1, got 0"),
    ("[rig.camera]\nhfov_degrees = 180", "rig.camera.hfov_degrees: must be < 180° for pinhole"),
    ("[rig.camera]\ndistortion = [1, 2, 3]", "a pinhole camera has 0 or 4 or 5"),
    # types
    ("[scene]\nseed = 1.5", "scene.seed: must be an integer, got 1.5"),
    ('[scene]\nseed = "1"', "scene.seed: must be an integer, got '1'"),
    (POINT + 'flux_lm = "800"', "lamp[0].flux_lm: must be a number, got '800'"),
    (POINT + "flux_lm = true", "lamp[0].flux_lm: must be a number, got True"),
    (POINT + "flux_lm = 1979-05-27", "lamp[0].flux_lm: must be a number, got datetime.date"),
    ("scene = 3", "scene: must be a table, got 3"),
    ("lamp = 3", "lamp: must be a list, got 3"),
    ("lamp = [3]", "lamp[0]: must be a table with a kind, got 3"),
    ('[lamp]\nkind = "point"', "lamp: must be a list of tables; write [[lamp]], not [lamp]"),
    ("[capture]\nsource = 3", "capture.source: must be a text, got 3"),
    ('[capture]\nsource = ""', "capture.source: must have at least 1 characters"),
    ('[capture]\nresponse = "gamma:x"', "must be like 'gamma:2.2', got 'gamma:x'"),
    ('[capture]\nresponse = "gamma"', "capture.response.gamma: kind 'gamma' needs gamma"),
    ('[capture]\nsource = { left = "a" }', "capture.source.right: is required"),
    ('[[lamp]]\nkind = "point"\nposition = [0, 1]', "lamp[0].position: has too few entries: numb"),
    ('[[lamp]]\nkind = "point"\nposition = [0, 1, 2, 3]', "lamp[0].position: must have at most 3"),
    # vectors and matrices
    (SPOT.replace("[0, 0, 1]", "[0, 0, 0]"), "lamp[0].direction: must not be the zero vector"),
    ("[rig.camera]\nposition = [0, 0, 0]\nlook_at = [0, 1, 0]", "rig.camera.look_at: eye, target"),
    ("[rig.camera]\nposition = [0, 0, 0]", "position and look_at belong together"),
    (
        "[rig.camera]\nworld_from_camera = [[2,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]",
        "rig.camera.world_from_camera: must be rigid",
    ),
    (
        "[[object]]\nmesh = 'a'\ntransform = [[0,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]",
        "object[0].transform: must be an invertible affine matrix",
    ),
    ("[[object]]\nmesh = 'a'\nrotation_xyzw = [0, 0, 0, 2]", "must be a unit quaternion"),
    # between tables
    ((POINT + 'flux_lm = 1\nname = "a"\n') * 2, "lamp[1].name: the name 'a' is taken by lamp[0]"),
    ("[ambient]\nprobes = true", "ambient.probes: needs a [probes] table"),
    ('[ambient]\nmap = "a"\nremoved = ["x"]', "ambient.removed[0]: there is no source 'x'"),
    ('[baked]\nfolder = "a"\nlamps = ["x"]', "baked.lamps[0]: there is no lamp 'x'"),
    (
        POINT + 'flux_lm = 1\n[baked]\nfolder = "a"\nlamps = ["point-1"]',
        "would count twice; give it",
    ),
    (POINT + 'flux_lm = 1\ntransport = "baked"', "lamp[0].transport: 'baked' needs 'point-1' in b"),
    # shells
    (
        POINT + "flux_lm = 1\nvisible_radius_m = 0.1\nshell.radius_m = 0.1",
        "lamp[0].visible_radius_m: must be < shell.radius_m, 0.1 m, got 0.1; the bulb is inside",
    ),
    # keyframes
    (
        POINT + "flux_lm = 1\n[[lamp.key]]\ntime_seconds = 1\n[[lamp.key]]\ntime_seconds = 0",
        "lamp[0].key[1].time_seconds: must be later than the key before, 1 s, got 0 s",
    ),
    (POINT + "flux_lm = 1\n[[lamp.key]]\ntime_seconds = 0", "lamp[0].key[0]: the key sets nothing"),
    (
        POINT + "flux_lm = 1\n[[lamp.key]]\ntime_seconds = 0\nintensity_cd = 1",
        "lamp[0].key[0].intensity_cd: this lamp does not state intensity_cd",
    ),
    (
        POINT + "flux_lm = 1\n" + "[[lamp.key]]\ntime_seconds = 1\nflux_lm = 1\n" * 2,
        "lamp[0].key[1].time_seconds: must be later than the key before, 1 s, got 1 s",
    ),
    # TOML itself
    ("[scene]\nname = ", "scene.toml: line 2, column 8: is not TOML: Invalid value"),
    ("[scene", "is not TOML"),
    ("a = 1\na = 2", "scene.toml: line 2, column 6: is not TOML: Cannot overwrite a value"),
    ("x = " + "1" * 5000, "is not TOML: a number has too many digits"),
    ("x = " + "[" * 5000, "is nested too deeply"),
    ("\n" + ".".join("a" * 500_000) + " = 1", "line 2: a key has at most 32 dotted parts"),
    ("[" + " . ".join(["'a.b'"] * 5000) + "]", "line 1: a key has at most 32 dotted parts"),
    ("x = " + "{a = " * 40 + "1" + "}" * 40, "nested more than 32 deep"),
]


@pytest.mark.parametrize(("text", "expected"), CASES)
def test_refusals(text, expected, tmp_path):
    with pytest.raises(InputError) as caught:
        parse_scene(text, folder=tmp_path)
    message = str(caught.value)
    assert expected in message
    assert message.startswith("scene.toml: ")
    assert "\n" not in message
    assert len(message) < 600


def test_more_faults_are_counted():
    with pytest.raises(InputError, match=r"got -1 \(and 2 more\)$"):
        parse_scene("[scene]\nseed = -1\nframes_per_second = 0\n[observer]\nage = -1")
    with pytest.raises(InputError, match=r"did you mean 'seed'\? \(and 1 more\)$"):
        parse_scene("[scene]\nsed = 1\n[observer]\nage = -1")


def test_one_number_for_three_channels_is_one_fault():
    with pytest.raises(InputError, match=r"got 0$"):
        parse_scene("[ambient]\nilluminance_lux = 0")


def test_values_of_a_stranger_are_cut_and_quoted():
    with pytest.raises(InputError) as caught:
        scene_from_dict({"scene": {"unit": "\n\x1b[31m" + "x" * 10_000}})
    assert "\n" not in str(caught.value)
    assert "\x1b" not in str(caught.value)
    assert len(str(caught.value)) < 300
    with pytest.raises(InputError) as caught:
        scene_from_dict({"a\nb\x1b" + "c" * 1000: 1})
    assert "\n" not in str(caught.value)
    assert "\x1b" not in str(caught.value)
    assert len(str(caught.value)) < 500


@pytest.mark.parametrize(
    ("data", "expected"),
    [
        (b"[scene]\nname = '\xff'", "line 2: must be UTF-8 text"),
        (b"#" * (1 << 20) + b"#", "at most 1048576 bytes"),
        (b"\x00", "is not TOML"),
    ],
)
def test_bad_files(data, expected, tmp_path):
    path = tmp_path / "s.toml"
    path.write_bytes(data)
    with pytest.raises(InputError) as caught:
        load_scene(path)
    assert expected in str(caught.value)
    assert str(caught.value).startswith(str(path))


@pytest.mark.parametrize("name", ["none.toml", ".", "x\x00y"])
def test_files_that_cannot_be_read(name, tmp_path):
    with pytest.raises(InputError, match=r"cannot be read|regular file"):
        load_scene(f"{tmp_path}/{name}")


def test_a_file_cut_anywhere_is_a_scene_or_an_error():
    text = POINT + 'flux_lm = 800.0\nname = "β"\n[ambient]\nilluminance_lux = [1, 2, 3]\n'
    outcomes = set()
    for end in range(len(text)):
        try:
            parse_scene(text[:end])
        except InputError:
            outcomes.add("error")
        else:
            outcomes.add("scene")
    assert outcomes == {"error", "scene"}


VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(st.sampled_from(["kind", "name", "position", "file", "key", "x"]), inner)
    ),
    max_leaves=8,
)


@given(
    st.dictionaries(
        st.sampled_from(["scene", "rig", "capture", "surface", "ambient", "lamp", "glass", "gaze"]),
        VALUES
        | st.dictionaries(
            st.sampled_from(["kind", "camera", "source", "depth", "response"]), VALUES
        )
        | st.lists(st.dictionaries(st.sampled_from(["kind", "position", "ends", "key"]), VALUES)),
    )
)
def test_any_tables_give_a_scene_or_an_error(tables):
    try:
        scene_from_dict(tables)
    except InputError as error:
        assert "\n" not in str(error)  # noqa: PT017
