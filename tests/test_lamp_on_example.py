"""examples/lamp_on: a shaded lamp is switched on in a photograph, and judged by another one."""

import runpy
from pathlib import Path

import numpy as np
import pytest

import andon
from andon.verify.lamp_on_room import DATA, photographs

EXAMPLE = Path(__file__).parent.parent / "examples" / "lamp_on"


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    folder = tmp_path_factory.mktemp("lamp_on")
    runpy.run_path(str(EXAMPLE / "room.py"))["main"](str(folder))
    return andon.load_scene(folder / "lamp_on.toml")


def test_the_written_scene_is_that_of_the_room(scene):
    (lamp,) = scene.lamp
    assert lamp.shell.real
    assert lamp.shell.drum.height_m == 0.22
    folder = scene.path("off.png", "capture.source").parent
    for name in ("off.png", "on.png", "depth.png"):
        assert (folder / name).read_bytes() == (DATA / name).read_bytes()


def test_the_lamp_lights_its_shade_and_the_wall_above_it(scene):
    """Of the light that is missing in the first photograph, it goes where the second has it."""
    frame = andon.render(scene, engine="reference")
    off, on = (codes.astype(float) for codes in photographs())
    shade = frame.surface.shell_id >= 0
    assert 0.01 < shade.mean() < 0.06
    gained = (on - off).mean(axis=-1)
    assert gained[shade].mean() > 5 * gained[~shade].mean()
    lit = np.asarray(frame.illuminance.lux).mean(axis=-1)
    rest = frame.surface.valid & ~shade
    # Brightness added against codes gained, rank by rank: the same places are bright.
    ranks = [np.argsort(np.argsort(values[rest])) for values in (lit, gained)]
    assert np.corrcoef(*ranks)[0, 1] > 0.6
