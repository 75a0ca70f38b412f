"""The confidence in frames: by both engines the same, and only where it is asked for."""

from dataclasses import replace

import numpy as np
import pytest

from andon import InputError
from andon.composite.confidence import Cause
from andon.files.pictures import write_png
from andon.pipeline import Renderer
from worlds import ball, scene, write_glb

LAMP = {"name": "bulb", "kind": "point", "position": [0.3, 0.4, -1.2], "flux_lm": 4000.0}


def drawn(folder, engine, *, codes=(60, 180), **tables):
    """A smooth photograph, as codes from left to right."""
    made = scene(folder, **({"lamp": [LAMP]} | tables))
    ramp = np.linspace(*codes, 64)[None, :, None] * np.ones((48, 1, 3))
    write_png(folder / "photo.png", np.round(ramp).astype(np.uint8))
    return Renderer(made, engine).render()


def test_both_engines_trust_the_same(gpu, tmp_path):
    trusts = [drawn(tmp_path, engine).confidence for engine in ("gpu", "reference")]
    assert (trusts[0].cause == trusts[1].cause).mean() > 0.995
    both = np.isfinite(trusts[0].expected_error_codes) & np.isfinite(trusts[1].expected_error_codes)
    errors = [trust.expected_error_codes[both] for trust in trusts]
    assert errors[1].std() > 0.05
    # Shadows' edges lie a pixel apart here and there.
    assert np.percentile(np.abs(errors[0] - errors[1]), 99) < 0.03


def test_it_is_made_when_it_is_asked_for(tmp_path):
    frame = drawn(tmp_path, "reference")
    assert "confidence" not in vars(frame)
    assert frame.confidence is frame.confidence
    with pytest.raises(InputError, match="only what was drawn has it"):
        _ = replace(frame, prepared=None).confidence


def test_holes_are_not_known_where_light_is_added(engine, tmp_path):
    frame = drawn(tmp_path, engine)
    hole = ~frame.surface.valid
    assert hole.any()
    assert ((frame.confidence.cause == Cause.HOLE) == hole).all()
    without = drawn(tmp_path, engine, lamp=[])
    assert (without.confidence.cause == Cause.SOUND).all()
    assert (without.confidence.confidence > 0.5).all()


def test_what_is_virtual_has_no_error_of_the_photograph(engine, tmp_path):
    write_glb(tmp_path / "ball.glb", ball(0.3, (0, 0, -1.5)))
    bulb = LAMP | {"visible_radius_m": 0.1}
    frame = drawn(tmp_path, engine, object=[{"mesh": "ball.glb"}], lamp=[bulb])
    virtual = frame.confidence.cause == Cause.VIRTUAL
    assert (virtual | ~frame.surface.is_object).all()
    assert (virtual & ~frame.surface.is_object).any()  # the bulb
    assert (frame.confidence.confidence[virtual] == 1).all()


def test_glass_shows_what_is_elsewhere(engine, tmp_path):
    glass = {"name": "ball", "shape": "sphere", "radius_m": 0.25, "position": [0.0, 0.0, -1.2]}
    frame = drawn(tmp_path, engine, glass=[glass])
    assert frame.glass is not None
    behind = frame.confidence.cause == Cause.GLASS
    assert (behind == (frame.glass.layers.coverage > 0)).all()
    assert 0.02 < behind.mean() < 0.9
    assert (frame.confidence.confidence[behind] == 0).all()


def test_less_light_in_the_photograph_is_less_confidence(engine, tmp_path):
    """A photograph of 2 to 8 codes, 300 times as bright on the screen."""
    bright = drawn(tmp_path, engine)
    shown = {"exposure": 300 / bright.captured.luminance_per_unit}
    dark = drawn(tmp_path, engine, codes=(2, 8), display=shown).confidence
    known = np.isfinite(dark.expected_error_codes)
    assert (dark.confidence[known] < bright.confidence.confidence[known]).mean() > 0.8
    assert dark.share(Cause.AMPLIFIED) > 0.3


@pytest.mark.parametrize("display", [
    {"tone": "fusion"}, {"mode": "ost", "peak_luminance_cd_m2": 400.0}, {"dither": True},
], ids=["fusion", "ost", "dither"])  # fmt: skip
def test_every_display_has_it(tmp_path, display):
    found = drawn(tmp_path, "reference", display=display).confidence
    plain = drawn(tmp_path, "reference").confidence
    assert (found.cause == plain.cause).all()
    assert np.nanmedian(found.expected_error_codes) == pytest.approx(
        np.nanmedian(plain.expected_error_codes), rel=0.1
    )


def test_beyond_a_measured_curve_nothing_is_known(engine):
    """Curves to 400 lx; the lamp takes a strip of the wall beyond them."""
    from andon import PointLamp, SurfaceCurve, View, relight

    view = View("pinhole", 64, 48, 57.6, 57.6, 31.5, 23.5)
    lux = np.linspace(0, 400, 9)
    curve = SurfaceCurve(lux, (0.001 * lux[:, None]) ** 0.9 * np.ones(3))
    photo = np.full((48, 64, 3), 90, np.uint8)
    lamp = PointLamp("bulb", np.array([-0.8, 0.0, -1.7]), np.full(3, 60.0))
    frame = relight(
        photo, view, [lamp], depth_m=np.full(view.shape, 2.0), ambient_lux=100.0, engine=engine,
        curves=[(curve, np.ones(view.shape, bool))],
    )  # fmt: skip
    new = np.asarray(frame.luminance.cd_m2) / frame.captured.luminance_per_unit
    over = (new > curve.linear[-1]).any(axis=-1)
    assert 0.02 < over.mean() < 0.5
    assert ((frame.confidence.cause == Cause.BEYOND) == over).mean() > 0.999
