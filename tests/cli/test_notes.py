"""What is said after a frame that may not be what was meant: on stderr, and the frame is there."""

import numpy as np
import pytest

from andon.files.pictures import write_png
from worlds import block, write_glb, write_relight_files

from .command import run_andon

BULB = "kind=point,name=bulb,position=0,0,-1,intensity_cd=50"


@pytest.fixture
def said(capfd, tmp_path, monkeypatch):
    """The notes of `andon relight` with these options, and the row of the report named `depth`."""
    write_relight_files(tmp_path)
    monkeypatch.chdir(tmp_path)

    def run(*more, given=("--depth", "depth.npy", "--camera", "camera.toml")):
        outcome = run_andon(
            capfd, "relight", "photo.png", *given, *more,
            "--engine", "reference", "--ambient-lux", 200, "-o", "out.png",
        )  # fmt: skip
        assert outcome.code == 0, outcome.err
        assert outcome.out == "out.png\n"
        lines = outcome.err.splitlines()
        rows = [line.removeprefix("depth").strip() for line in lines if line.startswith("depth ")]
        return [line.removeprefix("andon: ") for line in lines if line[:7] == "andon: "], rows

    return run


def test_nothing_is_said_of_a_frame_that_is_well(said, tmp_path):
    write_glb(tmp_path / "box.glb", block((0.3, 0.3, 0.3), (0, 0, -1.8)))
    notes, rows = said("--lamp", BULB, "--object", "box.glb")
    assert notes == []
    assert rows == ["1.60 to 2.50 m, median 2.50 m"]


def test_millimetres_taken_for_metres(said):
    notes, rows = said("--depth-scale-to-m", 1000)
    assert rows == ["1600 to 2500 m, median 2500 m"]
    assert len(notes) == 1
    assert "the median depth is 2500 m: check the unit" in notes[0]
    assert "--depth-scale-to-m 0.001" in notes[0]
    notes, rows = said("--depth-scale-to-m", 0.001)
    assert rows == ["0.0016 to 0.0025 m, median 0.0025 m"]
    assert "the median depth is 0.0025 m" in notes[0]


@pytest.mark.parametrize(
    ("centre", "where"),
    [
        ((0, 0, 3.0), "it stands around (0.00, 0.00, 3.00), behind the camera"),
        ((9, 0, -2.0), "it stands around (9.00, 0.00, -2.00), beside the picture"),
        ((0, 0, -3.5), "it stands around (0.00, 0.00, -3.50), hidden by what is before it"),
    ],
)
def test_an_object_without_a_pixel(said, tmp_path, centre, where):
    """The one that is not seen, and not the one beside it that is."""
    write_glb(tmp_path / "seen.glb", block((0.3, 0.3, 0.3), (0, 0, -1.8)))
    write_glb(tmp_path / "gone.glb", block((0.3, 0.3, 0.3), centre))
    notes, _ = said("--object", "seen.glb", "--object", "gone.glb")
    assert len(notes) == 1
    assert f"the object 'gone' covers no pixel: {where}" in notes[0]
    assert "check position and scale" in notes[0]
    assert said("--object", "gone.glb")[0] == notes


@pytest.mark.parametrize(
    ("lamp", "why"),
    [
        ("kind=point,name=dark,position=0,0,-1,intensity_cd=0", "0 is stated of it"),
        ("kind=sky,name=dark,illuminance_lux=0", "0 is stated of it"),
        ("kind=point,name=dark,position=0,0,-9,flux_lm=800", "nothing that the camera sees faces"),
        (
            "kind=spot,name=dark,position=0,0,-1,direction=0,0,1,outer_degrees=20,flux_lm=800",
            "nothing that the camera sees faces it within its cone; move or turn it",
        ),
    ],
)
def test_a_lamp_that_adds_no_light(said, lamp, why):
    notes, _ = said("--lamp", BULB, "--lamp", lamp)
    assert len(notes) == 1
    assert f"the lamp 'dark' adds no light: {why}" in notes[0]


def test_a_lamp_in_a_box(said, tmp_path):
    write_glb(tmp_path / "box.glb", block((0.3, 0.3, 0.3), (0, 0.9, -1.2)))
    lamp = "kind=point,name=dark,position=0,0.9,-1.2,flux_lm=800"
    notes, _ = said("--lamp", lamp, "--object", "box.glb")
    assert any("all that faces it lies in shadow; move it, or state shadow = false" in n
               for n in notes)  # fmt: skip
    assert not any("adds no light" in n for n in said("--lamp", lamp)[0])


def test_a_lamp_that_lights_a_few_pixels_only(said):
    """One that is not among those that are looked at first: row 10, column 21 of the wall."""
    at = "position=0,0,-1,direction=-0.4557,0.5859,-1.5"
    assert said("--lamp", f"kind=spot,name=thin,{at},outer_degrees=0.9,intensity_cd=9")[0] == []


def test_a_large_lift_is_said(said, tmp_path):
    """A rough surface of few triangles: the shadows of small things are gone."""
    generator = np.random.default_rng(0)
    y, x = np.mgrid[:48, :64]
    depth = 2.5 + 0.1 * np.sin(x) * np.sin(y) + 0.02 * generator.normal(size=(48, 64))
    np.save(tmp_path / "rough.npy", depth)
    write_png(tmp_path / "photo.png", np.full((48, 64, 3), 99, np.uint8))
    (tmp_path / "scene.toml").write_text(
        '[rig.camera]\nfx = 57.6\n[capture]\nsource = "photo.png"\n[surface]\n'
        'depth = {file = "rough.npy", max_jump = 0.5}\noccluder_triangles = 200\n'
        "[ambient]\nilluminance_lux = 200.0\n"
    )
    notes, _ = said(given=("--scene", "scene.toml"))
    assert len(notes) == 1
    assert "mm are lost, since " in notes[0]
    assert "more in [surface] occluder_triangles keep them (0: all)" in notes[0]


def test_a_skinned_figure_stands_in_its_pose_of_rest(said, data_dir):
    notes, _ = said("--object", data_dir / "gltf_models" / "CesiumMan.glb")
    assert "CesiumMan.glb has skin and animation: it is drawn in its pose of rest" in notes[0]


RECTANGLE = "kind=rectangle,name=pane,position=0,0,-1,width_m=0.3,height_m=0.3,flux_lm=800"


@pytest.mark.parametrize(
    ("more", "said_of_it"),
    [
        ("direction=0,0,-1", "covers 11% of the picture: drawn = false hides it, two_sided = true"),
        ("direction=0,0,-1,drawn=false", None),
        ("direction=0,0,-1,two_sided=true", None),
        ("direction=0,0,1", None),
        ("direction=0,0,-1,width_m=0.07,height_m=0.07", None),
    ],
)
def test_an_unlit_back_that_covers_much(said, more, said_of_it):
    """0.3 m at 1 m are 18 × 18 of 64 × 48 px; 0.07 m: half a percent."""
    given = more.split(",")
    kept = [pair for pair in RECTANGLE.split(",") if pair.split("=")[0] + "=" not in more]
    notes, _ = said("--lamp", ",".join([*kept, *given]))
    backs = [note for note in notes if "unlit back" in note]
    assert len(backs) == (said_of_it is not None), notes
    if said_of_it:
        assert f"the unlit back of 'pane' {said_of_it}" in backs[0]


@pytest.mark.parametrize(
    ("lamp", "what"),
    [
        (f"{BULB.replace('0,0,-1', '0,0,-0.1')},shell.radius_m=0.5", "shell of 'bulb'"),
        (f"{BULB},shell.radius_m=0.5", None),
        ("kind=sphere,name=ball,position=0,0,0.1,radius_m=0.5,flux_lm=9", "body of 'ball'"),
        ("kind=disk,name=flat,position=0,0,-0.001,direction=0,0,1,radius_m=0.5,flux_lm=9", None),
    ],
)
def test_the_camera_inside_a_lantern(said, lamp, what):
    inside = [note for note in said("--lamp", lamp)[0] if "inside" in note]
    assert inside == ([f"the camera is inside the {what}: move it"] if what else [])


@pytest.mark.parametrize(
    ("time", "duration", "said_of_it"),
    [
        (-1, 0, "--time -1 is before 0"),
        (3, 2, "--time 3 is after its end, 2 s"),
        (3, 0, None),
        (2, 2, None),
    ],
)
def test_a_moment_outside_the_session(said, tmp_path, time, duration, said_of_it):
    (tmp_path / "scene.toml").write_text(
        f"[scene]\nduration_seconds = {duration}\n[rig.camera]\nfx = 57.6\n"
        "[surface]\ndepth = 'depth.npy'\n"
    )
    notes, _ = said("--time", time, given=("--scene", "scene.toml"))
    assert [note.split(":")[0] for note in notes] == ([said_of_it] if said_of_it else [])
