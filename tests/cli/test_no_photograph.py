"""`andon relight` and `andon clip` of scenes that name their picture, or have none."""

import numpy as np
import pytest

from andon.files.pictures import read_picture
from worlds import block, write_glb, write_relight_files

from .command import PHOTOGRAPHED, run_andon, run_refused

VIRTUAL = """
[scene]
duration_seconds = 1.0
[rig.camera]
width = 48
height = 32
hfov_degrees = 60.0
position = [0.0, 0.6, 2.0]
look_at = {look_at}
[surface]
mesh = "room.glb"
[[lamp]]
name = "sun"
kind = "directional"
direction = [-0.3, -1.0, -0.5]
illuminance_lux = 30000.0
[[lamp]]
name = "sky"
kind = "sky"
illuminance_lux = 1415.93
{more}
"""
PROBES = """
[probes]
volume = "room.probes.glb"
[[probes.place]]
position = [0.0, 1.5, 0.5]
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    write_glb(tmp_path / "room.glb", block((4, 0.4, 4), (0, -0.2, 0)))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def virtual(folder, more="", look_at=(0.0, 0.0, 0.0)):
    text = VIRTUAL.format(more=more, look_at=list(look_at))
    (folder / "scene.toml").write_text(text, encoding="utf-8")


def photographed(folder):
    write_relight_files(folder)
    (folder / "scene.toml").write_text(PHOTOGRAPHED, encoding="utf-8")
    return "scene.toml"


def relit(capfd, *more, command="relight", out="out.png"):
    outcome = run_andon(capfd, command, *more, "--engine", "reference", "-o", out)
    assert outcome.code == 0, outcome.err
    assert outcome.out == f"{out}\n"
    return " ".join(outcome.err.split())


def test_a_scene_without_a_photograph(capfd, folder):
    virtual(folder)
    said = relit(capfd, "--scene", "scene.toml", "--time", 0.5)
    assert "white 10000 cd/m², chosen: a white wall in 31420 lx, distant lamps and E0" in said
    assert "of the pixels show no surface" in said
    assert "depth 0.93 to 3.74 m, median 1.45 m" in said
    assert "shadows 12 triangles, all there are" in said
    assert "photograph" not in said
    assert "clipped" not in said
    assert "andon:" not in said, "nothing is to be noted"
    assert read_picture(folder / "out.png").values.std() > 10


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ("[display]\nexposure = 2e-4", "5000 cd/m², as the exposure states"),
        (
            "[capture]\nluminance_per_unit = 8000.0",
            "8000 cd/m², as capture.luminance_per_unit states",
        ),
        ('[display]\ntone = "hue"', "10000 cd/m², chosen"),
    ],
)
def test_white_says_where_it_comes_from(capfd, folder, table, words):
    virtual(folder, table)
    assert f"white {words}" in relit(capfd, "--scene", "scene.toml")
    clip = ("scene.toml", "--to", 0.1, "--fps", 10)
    assert f"andon: white is {words}" in relit(capfd, *clip, command="clip", out="frames")


def test_a_scene_that_names_its_photograph(capfd, folder):
    """The photograph that is typed and the one that the scene names give the same picture."""
    scene = photographed(folder)
    alone = relit(capfd, "--scene", scene, out="alone.png")
    assert "of the photograph is clipped" in alone
    assert "white" not in alone
    relit(capfd, "photo.png", "--scene", scene, out="both.png")
    pictures = [read_picture(folder / f"{name}.png").values for name in ("alone", "both")]
    np.testing.assert_array_equal(*pictures)


@pytest.mark.parametrize("command", ["relight", "clip"])
def test_the_photograph_of_a_scene_is_not_overwritten(capfd, folder, command):
    scene = photographed(folder)
    words = ["relight", "--scene", scene] if command == "relight" else ["clip", scene, "--to", 1]
    line = run_refused(capfd, folder, *words, "-o", "photo.png")
    assert "photo.png: --out: is also the scene's photograph" in line


def test_neither_photograph_nor_scene(capfd, folder):
    line = run_refused(capfd, folder, "relight", "-o", "out.png")
    assert "PHOTO: is missing" in line
    assert "--scene" in line


def test_a_depth_without_a_photograph(capfd, folder):
    virtual(folder)
    np.save("depth.npy", np.ones((32, 48)))
    words = ("relight", "--scene", "scene.toml", "--depth", "depth.npy", "-o", "out.png")
    assert "--depth: belongs to a photograph" in run_refused(capfd, folder, *words)


def test_a_mesh_that_is_not_seen(capfd, folder):
    virtual(folder, look_at=(0.0, 0.6, 9.0))
    said = relit(capfd, "--scene", "scene.toml")
    assert "the mesh of [surface] covers no pixel: it stands around (0.00, -0.20, 0.00)" in said
    assert "the object" not in said


def test_millimetres_taken_for_metres(capfd, folder):
    write_glb(folder / "room.glb", block((4000, 400, 4000), (0, -1000, 0)))
    virtual(folder)
    said = relit(capfd, "--scene", "scene.toml")
    assert "check the unit of the meshes, and the camera" in said
    assert "--depth-scale-to-m" not in said


def test_a_sky_that_probes_hold_adds_light(capfd, folder):
    """Its light arrives through the probes, not as a lamp's: no reason to say it adds none."""
    virtual(folder, PROBES)
    baked = run_andon(capfd, "probes", "bake", "scene.toml", "--engine", "reference")
    assert baked.code == 0, baked.err
    said = relit(capfd, "--scene", "scene.toml")
    assert "adds no light" not in said
