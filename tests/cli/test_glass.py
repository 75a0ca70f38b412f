"""`andon glass`: pictures, layers, notes, the paper's figure; refusals of one line."""

import numpy as np
import pytest

from andon.files.pictures import read_picture
from andon.verify.registry import NotShown
from gaze_files import looking_at, own_gaze
from glass_worlds import HEIGHT, WIDTH, write_glass_files
from requirements import required
from worlds import block, write_obj

from .command import run_andon, run_refused

SCENE = """
[rig]
kind = "stereo"
[rig.camera]
width = 128
height = 80
fx = 176.0
position = [0.0, 0.0, 0.4]
look_at = [0.0, 0.0, 0.0]
[capture]
source = { left = "left.png", right = "right.png" }
luminance_per_unit = 240.0
[surface]
mesh = "board.obj"
[ambient]
illuminance_lux = 500.0
[observer]
pupil_mm = 6.0
[[glass]]
GLASS
[glass.background]
kind = "texture"
file = "board.png"
position = [0.0, 0.0, -0.2]
width_m = 0.8
height_m = 0.6
"""
BALL = 'radius_m = 0.075\ntexture = "label.png"'


@pytest.fixture
def scene(tmp_path):
    return written(tmp_path)


def written(folder, glass=BALL):
    write_glass_files(folder, eyes=((-0.0315, "left"), (0.0315, "right")))
    path = folder / "scene.toml"
    path.write_text(SCENE.replace("GLASS", glass))
    return path


def drawn(capfd, scene, *words, out="out.png"):
    path = scene.parent / out
    outcome = run_andon(capfd, "glass", scene, "-o", path, "--engine", "reference", *words)
    assert outcome.code == 0, outcome.err
    return path, outcome.err + outcome.out


def pixels(path):
    return np.asarray(read_picture(path).values).astype(int)


def test_both_eyes_beside_each_other(scene, capfd):
    path, _ = drawn(capfd, scene)
    both = pixels(path)
    assert both.shape == (HEIGHT, 2 * WIDTH, 3)
    right, _ = drawn(capfd, scene, "--eye", "right", out="right-eye.png")
    np.testing.assert_array_equal(pixels(right), both[:, WIDTH:])


def test_options_change_the_picture_and_the_notes(scene, capfd):
    pictures, notes = {}, {}
    for name, words in {
        "surface": ("--gaze", "surface"),
        "background": ("--gaze", "background"),
        "paper": ("--gaze", "background", "--blur", "paper"),
        "one": ("--gaze", "surface", "--interfaces", "1"),
        "near": ("--gaze", "0.2"),
    }.items():
        path, notes[name] = drawn(capfd, scene, "--eye", "left", *words)
        pictures[name] = pixels(path)
    assert "the eyes look at the surface" in notes["surface"]
    assert "the eyes look at the backdrop" in notes["background"]
    assert "the eyes look at a distance, focused on 5.00 D (0.20 m)" in notes["near"]
    names = list(pictures)
    for index, one in enumerate(names):
        for other in names[:index]:
            assert (pictures[one] != pictures[other]).any(), (one, other)


def test_luminance_and_layers(scene, capfd):
    layers = scene.parent / "layers"
    path, _ = drawn(capfd, scene, "--layers", layers, out="out.exr")
    values = np.asarray(read_picture(path).values)
    assert values.shape == (HEIGHT, 2 * WIDTH, 3)
    assert 20 < np.median(values) < 240
    assert {one.name for one in layers.iterdir()} == {
        f"{image}{blur}-{eye}.png"
        for image in ("surface", "refracted", "reflected")
        for blur in ("", "-blur")
        for eye in ("left", "right")
    }
    assert pixels(layers / "surface-left.png").max() > 0


@pytest.mark.parametrize("bad", [[np.nan] * 3, [-1.0, 1.0, 1.0]], ids=["stops", "parts"])
def test_gaze_without_a_fixation_falls_back_and_says_so(scene, capfd, bad):
    """Rays that are not known, and rays that part: each eye's turned to the other side."""
    directions = looking_at([(0.0, 0.0, 0.6)] * 60)
    directions[30:] *= bad
    recording = scene.parent / "gaze.csv"
    recording.write_text(own_gaze(np.arange(60) / 30, directions))
    words = ("--eye", "left", "--gaze", recording, "--time")
    assert "the last one is held" in drawn(capfd, scene, *words, "1.2")[1]
    assert "no gaze is known, so it is the surface" in drawn(capfd, scene, *words, "1.9")[1]


def test_a_moving_picture_of_a_recording(scene, capfd):
    points = np.zeros((6, 3))
    points[:, 2] = 0.6
    recording = scene.parent / "gaze.csv"
    recording.write_text(own_gaze(np.arange(6) / 30, looking_at(points)))
    path, _ = drawn(capfd, scene, "--eye", "left", "--gaze", recording, out="out.webp")
    assert path.read_bytes()[8:12] == b"WEBP"


@pytest.mark.parametrize(
    ("glass", "words"),
    [
        ("radius_m = 0.075\nindex = 0.9", "glass[0].index"),
        ("radius_m = 0.075\ntexture_transmittance = 1.2", "glass[0].texture_transmittance"),
        ('radius_m = 0.075\ntexture = "none.png"', "none.png"),
        ('shape = "mesh"\nmesh = "open.obj"', "glass[0].mesh"),
        ('shape = "mesh"\nmesh = "inside-out.obj"', "glass[0].mesh"),
        ("radius_m = 0.45", "eye"),
    ],
)
def test_bad_glass_is_refused(tmp_path, capfd, glass, words):
    closed = block((0.1, 0.1, 0.1), (0, 0, 0))
    write_obj(tmp_path / "open.obj", type(closed)(closed.positions, closed.triangles[1:]))
    write_obj(tmp_path / "inside-out.obj", block((0.1, 0.1, 0.1), (0, 0, 0), inwards=True))
    path = written(tmp_path, glass)
    assert words in run_refused(capfd, tmp_path, "glass", path, "-o", tmp_path / "out.png")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--gaze", "sideways"), "--gaze"),
        (("--gaze", "nan"), "--gaze"),
        (("--gaze", "-1"), "--gaze"),
        (("--gaze", "missing.csv"), "missing.csv"),
        (("--blur", "soft"), "--blur"),
        (("--interfaces", "3"), "--interfaces"),
        (("--eye", "third"), "--eye"),
    ],
)
def test_bad_words_are_refused(scene, capfd, words, message):
    folder = scene.parent
    line = run_refused(capfd, folder, "glass", scene, "-o", folder / "out.png", *words)
    assert message in line


def test_the_figure_has_a_row_of_real_glass(scene, capfd):
    required("mitsuba")
    out = scene.parent / "figure"
    words = ("-o", out, "--scene", scene, "--engine", "reference", "--samples", "1")
    outcome = run_andon(capfd, "glass", "figure7", *words)
    assert outcome.code == 0, outcome.err
    assert len(list(out.iterdir())) == 13
    traced, ours = (pixels(out / f"{row}-surface-left.png") for row in ("path-traced", "andon"))
    assert traced.shape == ours.shape
    # One path a pixel is noise, but of the same light.
    np.testing.assert_allclose(traced.mean(axis=(0, 1)), ours.mean(axis=(0, 1)), atol=15)


def test_without_mitsuba_the_figure_has_two_rows(scene, capfd, monkeypatch):
    def missing():
        raise NotShown("mitsuba is not installed")

    monkeypatch.setattr("andon.verify.truths.mitsuba_glass.mitsuba", missing)
    out = scene.parent / "figure"
    outcome = run_andon(
        capfd, "glass", "figure7", "-o", out, "--scene", scene, "--engine", "reference"
    )
    assert outcome.code == 0, outcome.err
    assert "without the row of path-traced glass: mitsuba is not installed" in outcome.err
    names = {path.name for path in out.iterdir()}
    assert names == {"figure7.png"} | {
        f"{row}-{look}-{eye}.png"
        for row in ("environment-map", "andon")
        for look in ("surface", "background")
        for eye in ("left", "right")
    }
