"""`andon relight` of one eye of a stereo rig."""

import numpy as np
import pytest

from andon.files.pictures import read_picture, write_png
from worlds import write_relight_files

from .command import run_andon, run_refused

SCENE = """
[rig]
kind = "stereo"
[rig.left]
fx = 57.6
[rig.right]
fx = 57.6
[capture]
source = { left = "left.png", right = "right.png" }
[surface]
depth = "depth.npy"
[ambient]
illuminance_lux = 200.0
"""
SOURCE = '[capture]\nsource = { left = "left.png", right = "right.png" }\n'


@pytest.fixture
def folder(tmp_path, monkeypatch):
    write_relight_files(tmp_path)
    rig = tmp_path / "rig"
    rig.mkdir()
    for name, code in (("left", 40), ("right", 90)):
        write_png(rig / f"{name}.png", np.full((48, 64, 3), code, np.uint8))
    (tmp_path / "depth.npy").rename(rig / "depth.npy")
    write_png(tmp_path / "right.png", np.full((48, 64, 3), 200, np.uint8))
    (rig / "stereo.toml").write_text(SCENE)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def words(*more):
    return ["relight", "photo.png", "--scene", "rig/stereo.toml", "-o", "out.png",
            "--engine", "reference", *more]  # fmt: skip


@pytest.mark.parametrize("view", ["left", "right", None])
def test_the_photograph_is_that_of_the_eye_that_is_named(capfd, folder, view):
    outcome = run_andon(capfd, *words(*(["--view", view] if view else [])))
    assert outcome.code == 0, outcome.err
    photo, out = (read_picture(folder / f"{name}.png").values for name in ("photo", "out"))
    assert (out == photo).all(), "without lamps nothing changes"


def test_the_other_eye_keeps_its_own_picture(folder):
    """Its name is looked up beside the scene, though a file of that name lies here too."""
    from andon.cli.options import RelightOptions
    from andon.cli.typed import scene_of
    from andon.pipeline import Renderer

    scene, photo = folder / "rig" / "stereo.toml", folder / "right.png"
    for typed in (photo, photo.relative_to(folder)):
        options = RelightOptions(folder / "out.png", typed, scene=scene, view="left")
        frames = Renderer(scene_of(options), "reference").prepared.frames
        codes = {name: float(frame.linear[20, 20, 0]) for name, frame in frames.items()}
        assert codes["left"] > 2 * codes["right"], codes
        own = read_picture(folder / "rig" / "right.png").values
        assert own[0, 0, 0] == 90


def test_an_eye_without_a_picture_is_refused(capfd, folder):
    scene = folder / "rig" / "stereo.toml"
    scene.write_text(SCENE.replace(SOURCE, ""))
    line = run_refused(capfd, folder, *words("--view", "right"))
    assert "stereo.toml: capture.source: the left eye has no picture" in line
    assert "'photo.png' is that of the right" in line
    assert "source = { left = …, right = … }" in line


def test_a_view_that_no_rig_has(capfd, folder):
    line = run_refused(capfd, folder, *words("--view", "middle"))
    assert "--view: there is no view 'middle', this rig has left and right" in line
