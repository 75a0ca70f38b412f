"""``display.dither`` in frames: the same grain by both engines, in every tone and display."""

from dataclasses import replace

import numpy as np
import pytest

from andon.capture.dither import dithered
from andon.engines.prepared import prepare
from andon.files.pictures import write_exr, write_png
from andon.pipeline import Renderer
from worlds import ball, scene, write_glb

# 16 times the light of the photograph, from far behind the camera.
DAY = {"name": "day", "kind": "directional", "direction": [0, 0, -1], "illuminance_lux": 3000.0}
OST = {"mode": "ost", "peak_luminance_cd_m2": 400.0, "transmittance": 0.7}


def dark(folder, **tables):
    """A scene whose photograph is a slow, dark gradient, and depth with holes."""
    made = scene(folder, **tables)
    columns = np.linspace(2, 9, 64)[None, :, None] * np.ones((48, 1, 3))
    write_png(folder / "photo.png", np.round(columns).astype(np.uint8))
    return made


def drawn(folder, engine, **tables):
    return Renderer(dark(folder, **tables), engine).render()


def test_a_photograph_without_lamps_is_itself(engine, tmp_path):
    frame = drawn(tmp_path, engine, display={"dither": True})
    plain = drawn(tmp_path, engine)
    assert (frame.image.rgb == plain.image.rgb).all()
    assert (frame.captured.linear == plain.captured.linear).all()
    assert (np.asarray(frame.luminance.cd_m2) != np.asarray(plain.luminance.cd_m2)).mean() > 0.5


def test_brightened_bands_become_grain(engine, tmp_path):
    frames = [drawn(tmp_path, engine, lamp=[DAY], display={"dither": d}) for d in (False, True)]
    plain, noisy = (frame.image.rgb[4:, :24] for frame in frames)  # beside the ball
    assert len(np.unique(plain[..., 0])) <= 4
    assert len(np.unique(noisy[..., 0])) >= 12
    # Where nothing is known of the geometry nothing was added, and nothing is changed.
    hole = ~frames[1].surface.valid
    assert hole.any()
    assert (frames[0].image.rgb[hole] == frames[1].image.rgb[hole]).all()


# Share of values that are a code apart; fusion's pyramids start from the GPU's half floats.
APART = {"none": 0.02, "hue": 0.02, "reinhard": 0.02, "fusion": 0.15, "ost": 0.02}


@pytest.mark.parametrize("name", APART)
def test_both_engines_draw_the_same_grain(gpu, tmp_path, name):
    display = OST if name == "ost" else {"tone": name}
    tables = {"lamp": [DAY], "display": {"dither": True, **display}}
    codes = [drawn(tmp_path, own, **tables).image.rgb.astype(int) for own in ("gpu", "reference")]
    difference = np.abs(codes[0] - codes[1])
    assert difference.max() <= 1
    assert (difference > 0).mean() < APART[name]
    without = drawn(tmp_path, "reference", lamp=[DAY], display=display).image.rgb.astype(int)
    assert np.abs(codes[1] - without).mean() > 0.4


def test_what_is_virtual_has_no_grain(engine, tmp_path):
    write_glb(tmp_path / "ball.glb", ball(0.3, (0, 0, -1.5)))
    tables = {"lamp": [DAY], "object": [{"mesh": "ball.glb"}]}
    noisy, plain = (drawn(tmp_path, engine, **tables, display={"dither": d}) for d in (True, False))
    own = noisy.surface.is_object
    assert own.mean() > 0.05
    assert (noisy.image.rgb[own] == plain.image.rgb[own]).all()
    assert (noisy.image.rgb[~own] != plain.image.rgb[~own]).mean() > 0.3


def test_light_in_floats_is_left_and_said_so(tmp_path):
    own = dark(tmp_path, capture={"source": "photo.exr"}, display={"dither": True})
    write_exr(tmp_path / "photo.exr", np.full((48, 64, 3), 0.2, np.float32), unit="cd/m2")
    prepared = prepare(own)
    assert any("display.dither changes nothing" in note for note in prepared.surface.notes)
    assert (prepared.frames["mono"].linear == prepared.captured("mono").linear).all()


def test_the_pattern_is_of_the_photograph_not_of_the_renderer(tmp_path):
    prepared = prepare(dark(tmp_path, display={"dither": True}))
    assert prepared.undithered
    again = replace(prepared.captured("mono"))
    assert (dithered(again).linear == prepared.frames["mono"].linear).all()
