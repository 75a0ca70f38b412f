"""``andon calibrate ambient``: what it writes, what it says, and what it refuses."""

import json

import numpy as np
import pytest

from andon import Renderer, load_scene
from andon.cli import _run
from andon.files.pictures import read_picture, write_png
from worlds import write_relight_files


@pytest.fixture
def room(tmp_path, monkeypatch):
    write_relight_files(tmp_path, width=96, height=72)
    monkeypatch.chdir(tmp_path)
    return tmp_path


TYPED = ["calibrate", "ambient", "photo.png", "--depth", "depth.npy", "--camera", "camera.toml"]


def test_it_writes_e0_a_sheet_and_numbers(room, capsys):
    more = ["--lux", "150", "--temperature", "2700", "--figure", "e0.png", "--json", "e0.json"]
    assert _run([*TYPED, "-o", "e0.exr", *more], False) == 0
    shown = capsys.readouterr()
    assert shown.out.split() == ["e0.exr", "e0.png", "e0.json"]
    assert "absolute, scale by lux" in shown.err
    picture = read_picture("e0.exr")
    assert picture.shape == (72, 96)
    lux = np.asarray(picture.values, float)
    assert (lux > 0).all()
    facts = json.loads((room / "e0.json").read_text())
    assert facts["photometry"] == "absolute"
    red, green, blue = facts["mean_rgb_lux"]
    assert 0.2126 * red + 0.7152 * green + 0.0722 * blue == pytest.approx(150, rel=1e-3)
    assert red > green > blue
    assert 0.1 < facts["stated_median_error"] < 1
    assert read_picture("e0.png").shape[0] > 72


def test_without_a_scale_it_is_relative_and_says_so(room, capsys):
    assert _run([*TYPED, "-o", "e0.exr", "--json", "e0.json"], False) == 0
    assert "its mean is 1 (relative); --lux states it" in capsys.readouterr().err
    facts = json.loads((room / "e0.json").read_text())
    assert (facts["photometry"], facts["scale_by"]) == ("relative", "nothing")
    assert facts["mean_rgb_relative"] == pytest.approx([1, 1, 1], abs=1e-3)


SCENE = """
[scene]
photometry = "absolute"
[rig.camera]
fx = 86.4
[capture]
source = "photo.png"
[surface]
depth = "depth.npy"
[ambient]
{ambient}
[[ambient.source]]
kind = "point"
name = "floor lamp"
position = [-0.5, 0.4, -1.2]
intensity_cd = 90.0
"""


def test_a_scene_gives_its_sources_and_takes_what_was_found(room, capsys):
    (room / "scene.toml").write_text(SCENE.format(ambient="rest_lux = 100.0"))
    typed = ["calibrate", "ambient", "--scene", "scene.toml", "-o", "e0.exr", "--lux", "80"]
    assert _run(typed, False) == 0
    assert "'floor lamp' gives" in capsys.readouterr().err
    (room / "again.toml").write_text(SCENE.format(ambient='map = "e0.exr"'))
    prepared = Renderer(load_scene(room / "again.toml"), "reference").prepared
    found = np.asarray(read_picture("e0.exr").values, float)
    np.testing.assert_allclose(prepared.ambient.illuminance_lux, found)


def _half_size(folder):
    write_png(folder / "photo.png", np.full((36, 48, 3), 99, np.uint8))


def _clipped(folder):
    write_png(folder / "photo.png", np.full((72, 96, 3), 255, np.uint8))


def _no_depth(folder):
    np.save(folder / "depth.npy", np.full((72, 96), np.nan))


@pytest.mark.parametrize(
    ("options", "change", "message"),
    [
        (["--lux", "-3"], None, "--lux: must be > 0 lx, got -3"),
        (["--lux", "9", "--reflectance", "0.3"], None, "one of --lux and --reflectance"),
        (["--reflectance", "1.2"], None, "--reflectance: must be > 0 and ≤ 1"),
        (["--reflectance", "0.4"], None, "--reflectance: needs a photograph in cd/m²"),
        (["--temperature", "5"], None, "--temperature"),
        (["--figure", "e0.exr"], None, "must end in .png"),
        ([], _half_size, "is for 96×72 px, the picture has 48×36"),
        ([], _clipped, "0 are neither clipped nor black"),
        ([], _no_depth, "depth"),
    ],
)
def test_what_does_not_fit_is_refused_before_anything_is_written(
    room, capsys, options, change, message
):
    if change is not None:
        change(room)
    assert _run([*TYPED, "-o", "e0.exr", *options], False) == 2
    assert message in capsys.readouterr().err
    assert not (room / "e0.exr").exists()


def test_geometry_has_to_be_there(room, capsys):
    typed = ["calibrate", "ambient", "photo.png", "--camera", "camera.toml", "-o", "e0.exr"]
    assert _run(typed, False) == 2
    assert "--depth: is missing" in capsys.readouterr().err
