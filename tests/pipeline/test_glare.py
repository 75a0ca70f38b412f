"""Glare in the frame, on both engines."""

import numpy as np
import pytest
from PIL import Image

from andon.engines.prepared import prepare
from andon.errors import InputError
from andon.pipeline import Renderer
from comparison import assert_agree, assert_same_picture
from worlds import scene

# A bulb and a paper ball two metres and less before the camera, in a dim room.
BULB = {
    "kind": "point", "name": "bulb", "position": [0.2, 0.1, -1.5], "flux_lm": 60.0,
    "temperature_k": 2700.0, "visible_radius_m": 0.02,
}  # fmt: skip
BALL = {
    "kind": "point", "name": "ball", "position": [-0.3, 0.1, -1.3], "flux_lm": 20.0,
    "shell": {"radius_m": 0.08, "transmittance": 0.6},
}  # fmt: skip
DIM = {"illuminance_lux": 2.0}
SCATTERED = {"model": "cie135", "needles": False, "halo": False}


def room(tmp_path, **tables):
    return scene(tmp_path, **({"lamp": [BULB, BALL], "ambient": DIM, "glare": SCATTERED} | tables))


def test_both_engines_scatter_alike(gpu, tmp_path):
    lit = room(tmp_path, glare={"model": "cie135", "adaptation": "mesopic"})
    expected, actual = (Renderer(lit, name).render() for name in ("reference", "gpu"))
    assert_same_picture(actual.image.rgb, expected.image.rgb, tmp_path, share=0.02, mean=1.0)
    peak = float(np.asarray(expected.glare.cd_m2).max())
    assert_agree(
        actual.glare.cd_m2, expected.glare.cd_m2,
        rtol=1e-2, atol=2e-3 * peak, share=0.01, what="glare",
    )  # fmt: skip


def test_light_is_moved_not_made(engine, tmp_path):
    """What the eye scatters out of the picture is lost, and nothing is added."""
    with_glare = Renderer(room(tmp_path), engine).render()
    without = Renderer(room(tmp_path, glare=None), engine).render()
    solid = with_glare.captured.view.solid_angles()[..., None]
    sent, seen = (
        float((np.asarray(frame.luminance.cd_m2, float) * solid).sum())
        for frame in (without, with_glare)
    )
    assert 0.6 * sent < seen < 1.001 * sent


def test_an_older_eye_has_more_veil(engine, tmp_path):
    young, old = (
        np.asarray(
            Renderer(room(tmp_path, observer={"age": age}), engine).render().glare.cd_m2
        ).mean()
        for age in (20, 70)
    )
    assert old > 1.15 * young


def test_glow_stands_for_glare(engine, tmp_path):
    frame = Renderer(room(tmp_path, glare={"model": "glow"}), engine).render()
    assert frame.glow is not None
    assert frame.glare is None
    frame = Renderer(room(tmp_path), engine).render()
    assert frame.glow is None
    assert frame.glare is not None


def test_needles_are_of_one_eye(engine, tmp_path):
    """Other eyes have other needles and the same bloom; all of it is light of the bulb."""
    observer = {"pupil_mm": 6.0}
    bulb = BULB | {"flux_lm": 100.0, "visible_radius_m": 0.01}
    tables = {"lamp": [bulb], "observer": observer}

    def glare(**settings):
        lit = room(tmp_path, **tables, glare={"model": "cie135", "halo": False, **settings})
        return np.asarray(Renderer(lit, engine).render().glare.cd_m2, float)

    bloom, one, other = glare(needles=False), glare(), glare(seed=5)
    assert bloom.sum() < one.sum() < 1.3 * bloom.sum()
    assert (one / bloom).max() > 1.04
    assert np.abs(one / other - 1).max() > 0.04


def test_needles_of_a_relative_scene_do_not_know_its_unit(engine, tmp_path):
    def glare(unit, needles):
        lit = room(
            tmp_path,
            scene={"photometry": "relative"},
            observer={"pupil_mm": 6.0},
            lamp=[BULB | {"flux_lm": 60.0 * unit}],
            ambient={"illuminance_lux": 2.0 * unit},
            glare={"model": "cie135", "halo": False, "needles": needles},
        )
        return np.asarray(Renderer(lit, engine).render().glare.cd_m2, float).sum() / unit

    dim, bright = (glare(unit, True) - glare(unit, False) for unit in (0.1, 10.0))
    assert dim > 0
    assert bright == pytest.approx(dim, rel=0.02)


def test_what_the_sensor_clipped_glares_as_brightly_as_it_is_stated(engine, tmp_path):
    def veil(**capture):
        lit = room(tmp_path, lamp=[], capture={"source": "photo.png", **capture})
        codes = np.array(Image.open(tmp_path / "photo.png"))
        codes[5:8, 5:8] = 255
        Image.fromarray(codes).save(tmp_path / "photo.png")
        return float(np.asarray(Renderer(lit, engine).render().glare.cd_m2).sum())

    assert veil(clipped_luminance_cd_m2=5000.0) > 3 * veil()


def test_see_through_displays_scatter_virtual_light_alone(engine, tmp_path):
    shown = {"mode": "ost", "peak_luminance_cd_m2": 50.0}
    dark = Renderer(room(tmp_path, lamp=[], display=shown), engine).render()
    assert np.asarray(dark.glare.cd_m2).max() < 1e-3
    lit = Renderer(room(tmp_path, display=shown), engine).render()
    assert np.asarray(lit.glare.cd_m2).max() > 1.0


def test_a_model_that_scatters_more_than_there_is_names_the_scene(tmp_path):
    lit = room(tmp_path, glare={"model": "paper"}, atmosphere={"mist": 100.0})
    with pytest.raises(InputError, match="more than there is") as refused:
        prepare(lit)
    assert refused.value.field == "glare.model"


def test_keys_of_glare_count_where_there_is_glare(tmp_path):
    stated = {"observer": {"glasses": "spectacles"}, "atmosphere": {"mist": 0.1}}
    assert prepare(room(tmp_path, **stated)).ignored == ()
    ignored = prepare(room(tmp_path, glare=None, **stated)).ignored
    assert set(ignored) == {"observer.glasses", "atmosphere.mist"}


def test_highlights_have_needles_unless_they_are_not_to(engine, tmp_path):
    """A lamp behind the camera, mirrored in a metal panel before it."""
    from worlds import block, write_obj

    write_obj(tmp_path / "panel.obj", block((0.5, 0.4, 0.02), (0, 0, -1.2)))
    panel = {"mesh": "panel.obj", "highlights": "cook-torrance", "metallic": 1, "roughness": 0.1}
    lamp = {
        "kind": "sphere", "position": [0.0, 0.0, 0.6], "radius_m": 0.02,
        "luminance_cd_m2": 2e6,
    }  # fmt: skip
    tables = {"lamp": [lamp], "object": [panel], "observer": {"pupil_mm": 6.0}}

    def glare(**settings):
        lit = room(tmp_path, **tables, glare={"model": "cie135", "halo": False, **settings})
        return np.asarray(Renderer(lit, engine).render().glare.cd_m2, float)

    seen, bloom = glare(), glare(needles=False)
    without = glare(highlights=False)
    assert (seen / bloom).max() > 1.04
    np.testing.assert_allclose(without, bloom, rtol=1e-3, atol=1e-3 * bloom.max())
