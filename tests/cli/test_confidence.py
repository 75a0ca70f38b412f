"""``andon relight --confidence``: pictures, numbers and notes."""

import numpy as np
import pytest

from andon.files.pictures import read_picture
from andon.files.pictures.exr import read_exr_part
from worlds import write_relight_files

from .command import PHOTOGRAPHED, run_andon, run_refused

LAMP = '\n[[lamp]]\nname = "bulb"\nkind = "point"\nposition = [0.3, 0.4, -1.2]\nflux_lm = 4000\n'


@pytest.fixture
def folder(tmp_path, monkeypatch):
    write_relight_files(tmp_path)
    (tmp_path / "scene.toml").write_text(PHOTOGRAPHED + LAMP)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def relit(capfd, *words):
    words = ("relight", "--scene", "scene.toml", "-o", "out.png", *words, "--engine", "reference")
    outcome = run_andon(capfd, *words)
    assert outcome.code == 0, outcome.err
    return outcome


def test_a_picture_with_a_scale_and_a_legend(capfd, folder):
    outcome = relit(capfd, "--confidence", "trust.png")
    picture = read_picture(folder / "trust.png").values
    assert picture.shape[0] > 48
    assert picture.shape[1] > 64
    assert (picture[:3, :5] == (60, 60, 60)).all()  # the hole
    assert "confidence: of the pixels 0.5% hole, no light added" in outcome.err


def test_numbers_with_names_and_units(capfd, folder):
    relit(capfd, "--confidence", "trust.exr")
    part = read_exr_part(folder / "trust.exr")
    assert set(part.channels) == {"expected_error", "relative_error", "confidence", "cause"}
    assert part.attributes["andon:unit"].startswith("expected_error [codes], relative_error [1]")
    assert "4 hole" in part.attributes["andon:causes"]
    hole = part.channels["cause"] == 4
    assert hole.sum() == 15
    assert np.isnan(part.channels["expected_error"][hole]).all()
    assert (part.channels["confidence"][hole] == 0).all()
    error = part.channels["expected_error"][~hole]
    expected = 1 / (1 + (error / (255 * 10 ** (-38 / 20))) ** 2)
    np.testing.assert_allclose(part.channels["confidence"][~hole], expected, rtol=1e-5)


def test_bad_outputs_are_refused(capfd, folder):
    words = ("relight", "--scene", "scene.toml", "-o", "out.png", "--engine", "reference")
    line = run_refused(capfd, folder, *words, "--confidence", "trust.txt")
    assert "--confidence: must end in .png, .exr" in line
    line = run_refused(capfd, folder, *words, "--confidence", "out.png")
    assert "is also an input or another output" in line
    line = run_refused(capfd, folder, *words, "--confidence", "photo.png")
    assert "would be overwritten" in line


def test_a_scene_without_a_photograph_has_none(capfd, folder):
    text = "[rig.camera]\nfx = 57.6\nwidth = 64\nheight = 48\n[ambient]\nilluminance_lux = 9.0\n"
    (folder / "scene.toml").write_text(text + LAMP)
    words = ("relight", "--scene", "scene.toml", "-o", "out.png", "--engine", "reference")
    line = run_refused(capfd, folder, *words, "--confidence", "trust.png")
    assert "--confidence: shows what a photograph's errors become" in line
