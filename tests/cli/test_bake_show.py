"""`andon bake show`: baked illuminance maps as one picture."""

from dataclasses import replace

import numpy as np
import pytest

from andon.display.false_colour import BAR_WIDTH_PX, CAPTION_PX, GAP_PX, false_colour
from andon.files.illuminance_maps import light_bytes, map_file, read_manifest, write_manifest
from andon.files.pictures import read_picture
from map_files import CAMERAS, map_lux, write_maps

from .command import run_andon, run_refused

SCENE = """
[rig.camera]
width = 32
height = 24
hfov_degrees = 60.0
[surface]
mesh = "room.obj"
[ambient]
illuminance_lux = 100.0
[baked]
folder = "maps"
lamps = ["lantern"]
[[lamp]]
name = "lantern"
kind = "point"
position = [0, 1, 0]
intensity_cd = 60
transport = "baked"
"""
# 9 and 7 pixels are enlarged to 320 or more.
DOOR_PX, CEILING_PX = 36, 46


@pytest.fixture
def folder(tmp_path, monkeypatch):
    (tmp_path / "maps").mkdir()
    write_maps(tmp_path / "maps")
    (tmp_path / "room.toml").write_text(SCENE)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "200")
    return tmp_path


def shown(capfd, *words):
    """The picture, and what was said."""
    outcome = run_andon(capfd, "bake", "show", *words, "-o", "maps.png")
    assert outcome.code == 0, outcome.err
    assert outcome.out == "maps.png\n"
    return read_picture("maps.png").values, outcome.err


def test_the_first_camera_is_in_the_picture_as_it_is(folder, capfd):
    """One lamp: each of its pixels has the colour of its illuminance."""
    picture, said = shown(capfd, "maps", "--lamp", "lantern")
    lux = map_lux(0, 0, 0).astype(np.float64) @ [0.2126, 0.7152, 0.0722]
    valid = np.ones(lux.shape, bool)
    valid[2, 3] = False
    tops = [top for top in (1e2, 2e2, 5e2, 1e3, 2e3, 5e3, 1e4) if _agree(picture, lux, valid, top)]
    assert tops == [1e4]  # that of both cameras; the door's own alone would be the same or less
    assert said == "andon: lantern (all light); normal, 4 bounces; at 0 s\n"


def _agree(picture, lux, valid, top):
    expected = false_colour(lux, "lx", valid=valid, top=top)[:, :-BAR_WIDTH_PX]
    rows = CAPTION_PX + DOOR_PX // 2 + DOOR_PX * np.arange(lux.shape[0])
    columns = DOOR_PX // 2 + DOOR_PX * np.arange(lux.shape[1])
    found = picture[rows[:, None], columns].astype(int)
    return np.abs(found - expected).max() <= 1  # photometric values are summed in float32


def test_all_cameras_share_a_scale(folder, capfd):
    """A second camera that is a thousand times darker is black, not as bright as the first."""
    manifest = read_manifest("maps")
    dark = light_bytes(map_lux(0, 1, 0) * 1e-3)
    (folder / "maps" / "dark.exr").write_bytes(dark)
    light = {**manifest.light, ("lantern", 1, 0): map_file("dark.exr", dark)}
    write_manifest("maps", replace(manifest, light=light))
    picture, _ = shown(capfd, "maps", "--lamp", "lantern")
    height, width = 6 * DOOR_PX, 9 * DOOR_PX + BAR_WIDTH_PX
    # The square map and its bar are scaled to the first one's height and stand in the middle.
    left = width + GAP_PX + (width - round((1 + BAR_WIDTH_PX / (7 * CEILING_PX)) * height)) // 2
    second = picture[CAPTION_PX + 3 : -3, left + 3 : left + height - 3]
    holes = (second.max(axis=-1) - second.min(axis=-1)) < 3
    assert holes.mean() < 0.05
    assert second[~holes].max() < 60
    assert picture[CAPTION_PX:, :width].max() > 200


def test_all_lamps_are_a_sum(folder, capfd):
    one, _ = shown(capfd, "maps", "--lamp", "lantern")
    both, said = shown(capfd, "maps")
    assert "lantern (all light), lamp at the window (reflected light)" in said
    assert (one != both).mean() > 0.1


def test_the_nearest_moment(folder, capfd):
    first, said = shown(capfd, "maps", "--time", "-7")
    assert "at 0 s" in said
    later, said = shown(capfd, "maps", "--time", "0.3")
    assert "at 0.5 s" in said
    assert (first != later).any()


def test_geometry_beside(folder, capfd):
    picture, _ = shown(capfd, "maps", "--geometry")
    tile = 9 * DOOR_PX + BAR_WIDTH_PX
    assert picture.shape[1] == 3 * tile + 2 * GAP_PX
    assert picture.shape[0] == 2 * (CAPTION_PX + 6 * DOOR_PX)


def test_a_scene_shows_its_folder(folder, capfd):
    by_folder, _ = shown(capfd, "maps")
    by_scene, _ = shown(capfd, "room.toml")
    np.testing.assert_array_equal(by_scene, by_folder)


def test_small_maps_are_enlarged(folder, capfd):
    picture, _ = shown(capfd, "maps")
    assert picture.shape[:2] == (
        CAPTION_PX + 6 * DOOR_PX,
        2 * (9 * DOOR_PX + BAR_WIDTH_PX) + GAP_PX,
    )
    assert CAMERAS[1].width * CEILING_PX >= 320


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["nowhere"], "andon bake"),
        (["maps", "--lamp", "lanterm"], "did you mean 'lantern'"),
        (["maps", "--time", "nan"], "finite"),
        (["maps", "-o", "maps.jpg"], ".png"),
        (["maps", "-o", "no/maps.png"], "does not exist"),
        (["unbaked.toml"], "needs a [baked] table"),
        (["missing.toml"], "No such file"),
    ],
)
def test_refusals(words, expected, folder, capfd):
    (folder / "unbaked.toml").write_text(SCENE[: SCENE.index("[baked]")])
    assert expected in run_refused(capfd, folder, "bake", "show", *words)


def test_a_damaged_map_is_named(folder, capfd):
    (folder / "maps" / "light-0-1-0.exr").write_bytes(b"x")
    assert "light-0-1-0.exr: bytes: must have" in run_refused(capfd, folder, "bake", "show", "maps")
