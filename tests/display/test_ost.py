"""Optical see-through: what is seen is what was wanted, wherever light can only be added."""

from dataclasses import replace

import numpy as np
import pytest

import andon
from andon.composite.reference import unlit_linear
from andon.display import ost, reference
from andon.display.model import Exposure, SeeThrough
from andon.display.ost_stage import OstStage
from andon.gpu.textures import make_texture
from andon.quantities import CameraFrame, Luminance
from andon.responses import SRGB, srgb_decode, srgb_encode
from andon.spaces import View
from comparison import assert_agree
from worlds import block, write_glb, write_relight_files

WHITE = 120.0  # cd/m² of the photograph's value 1
VIEW = View("pinhole", 64, 48, 60.0, 60.0, 31.5, 23.5)
SETTINGS = SeeThrough(peak_luminance_cd_m2=400.0, transmittance=0.6)


def pictures(seed=1):
    """A photograph, and one in which a quarter is lit, one darkened and one replaced."""
    generator = np.random.default_rng(seed)
    linear = half(generator.uniform(0.02, 0.9, (*VIEW.shape, 3)))
    wanted = linear.copy()
    wanted[:24, :32] += half(generator.uniform(0.3, 1.5, (24, 32, 3)))
    wanted[24:, :32] *= 0.2
    wanted[24:, 32:] = half(generator.uniform(0, 8, (24, 32, 3)))
    return CameraFrame(linear.astype(np.float32), VIEW, SRGB, WHITE), half(wanted)


def half(values):
    return np.asarray(values).astype(np.float16).astype(np.float64)


def shown(frame, wanted, settings, unlit=None):
    real = WHITE * ost.real_light(frame.linear, settings)
    unlit = real if unlit is None else WHITE * unlit
    return ost.display_codes(ost.shown_share(WHITE * wanted, real, settings, WHITE, unlit))


def test_seen_is_wanted_where_it_is_within_reach():
    """To the display's own step: between two codes lies at most 1.4 % of the peak."""
    frame, wanted = pictures()
    codes = shown(frame, wanted, SETTINGS)
    real = WHITE * frame.linear.astype(float)
    seen = ost.seen_light(codes, real, SETTINGS)
    within = (WHITE * wanted >= 0.6 * real) & (WHITE * wanted <= 400 + 0.6 * real)
    assert 0.6 < within.mean() < 0.95
    low, high = (SETTINGS.peak_luminance_cd_m2 * srgb_decode(np.clip(codes + d, 0, 255) / 255)
                 for d in (-0.5, 0.5))  # fmt: skip
    ideal = (WHITE * wanted - 0.6 * real)[within]
    assert (ideal >= low[within] - 1e-9).all()
    assert (ideal <= high[within] + 1e-9).all()
    # What is out of reach is as near as light can be added.
    too_dark, too_bright = WHITE * wanted < 0.6 * real, WHITE * wanted > 400 + 0.6 * real
    assert (codes[too_dark] == 0).all()
    assert (codes[too_bright] == 255).all()
    assert_agree(seen[too_dark], 0.6 * real[too_dark], rtol=1e-12, atol=0)


def test_without_real_light_it_is_a_video_display():
    """τ = 0, and white at the photograph's white: the codes of the video see-through picture."""
    frame, wanted = pictures()
    codes = shown(frame, wanted, SeeThrough(WHITE, transmittance=0.0))
    assert (codes == reference.encode(WHITE * wanted, Exposure(), SRGB, WHITE)).all()


def test_without_a_photograph_the_room_is_black():
    frame, wanted = pictures()
    settings = SeeThrough(WHITE, transmittance=1.0, has_real_light=False)
    for compensation in (True, False):
        codes = shown(frame, wanted, replace(settings, compensation=compensation))
        assert (codes == reference.encode(WHITE * wanted, Exposure(), SRGB, WHITE)).all()


def test_an_unchanged_room_is_black_on_a_display_that_lets_all_light_through():
    frame, _ = pictures()
    for compensation in (True, False):
        settings = SeeThrough(400.0, 1.0, compensation)
        assert shown(frame, frame.linear.astype(float), settings).max() == 0


def test_without_compensation_what_is_virtual_is_shown_as_it_is():
    frame, wanted = pictures()
    codes = shown(frame, wanted, replace(SETTINGS, compensation=False))
    assert (codes[:24, 32:] == 0).all()  # unchanged
    expected = np.clip(srgb_encode(np.minimum(wanted * WHITE / 400, 1)), 0, 1) * 255
    changed = np.ones(VIEW.shape, bool)
    changed[:24, 32:] = False
    assert np.abs(codes[changed] - expected[changed]).max() <= 0.5 + 1e-9
    # A dimmed room is not virtual: no such display dims it.
    dimmed = 0.2 * frame.linear.astype(float)
    codes = shown(frame, wanted, replace(SETTINGS, compensation=False), unlit=dimmed)
    assert (codes[24:, :32] == 0).all()


def test_shares_out_of_reach_are_counted():
    linear = np.full((10, 10, 3), 0.5)
    frame = CameraFrame(linear.astype(np.float32), VIEW, SRGB, WHITE)
    wanted = WHITE * linear.copy()
    wanted[:3] = 0.7 * 60 * 0.9  # 30 pixels darker than τ·real = 42
    wanted[9, :7] = [300.0, 42.0, 42.0]  # 7 that exceed 42 + 200 in one channel
    settings = SeeThrough(200.0, 0.7)
    real = WHITE * linear
    codes = ost.display_codes(ost.shown_share(wanted, real, settings, WHITE, real))
    exposure = Exposure(see_through=settings)
    seen = ost.seen_through(Luminance(wanted), frame, exposure, codes)
    assert seen.dark_share == pytest.approx(0.30)
    assert seen.bright_share == pytest.approx(0.07)
    # 30 pixels by 4.2 cd/m², 7 by 58 in red; steps of the display are below 2 cd/m² there.
    assert seen.mean_error_cd_m2 == pytest.approx(0.3 * 4.2 + 0.07 * 58 * 0.2126, abs=0.7)
    assert (seen.image.rgb == reference.encode(seen.luminance.cd_m2, Exposure(), SRGB, WHITE)).all()


def test_infinite_light_is_the_peak():
    frame, wanted = pictures()
    wanted[0, 0] = np.inf
    for compensation in (True, False):
        settings = replace(SETTINGS, compensation=compensation)
        codes = shown(frame, wanted, settings)
        assert (codes[0, 0] == 255).all()
        seen = ost.seen_through(
            Luminance(WHITE * wanted), frame, Exposure(see_through=settings), codes
        )
        assert np.isfinite(seen.luminance.cd_m2).all()
        assert np.isfinite(seen.mean_error_cd_m2)


@pytest.mark.parametrize("tone", ["none", "hue", "fusion"])
@pytest.mark.parametrize(
    "settings",
    [
        SETTINGS,
        replace(SETTINGS, compensation=False),
        replace(SETTINGS, transmittance=0.0),
        SeeThrough(40.0, 1.0),
        replace(SETTINGS, has_real_light=False),
    ],
)
def test_both_engines_agree(gpu, settings, tone):
    frame, wanted = pictures()
    exposure = Exposure(tone=tone, see_through=settings)
    unlit = half(0.2 * frame.linear)
    texture = make_texture(gpu, "rgba16float", *VIEW.shape[::-1])
    texture.write(np.dstack([wanted, np.ones(VIEW.shape)]))
    stage = OstStage(gpu, texture, frame, exposure, unlit)
    encoder = gpu.device.create_command_encoder()
    stage.encode(encoder)
    gpu.device.queue.submit([encoder.finish()])
    codes = stage.read().rgb
    expected = shown(frame, wanted, settings, unlit * settings.has_real_light)
    difference = np.abs(codes.astype(int) - expected)
    assert difference.max() <= 1
    assert (difference > 0).mean() < 0.01
    assert len(np.unique(expected)) > 60
    actual = stage.read_seen("absolute")
    seen = ost.seen_through(Luminance(WHITE * wanted), frame, exposure, codes)
    assert_agree(actual.luminance.cd_m2, seen.luminance.cd_m2, rtol=2e-4, atol=2e-3)
    assert np.abs(actual.image.rgb.astype(int) - seen.image.rgb).max() <= 1
    assert actual.dark_share == pytest.approx(seen.dark_share, abs=1e-3)
    assert actual.bright_share == pytest.approx(seen.bright_share, abs=1e-3)
    assert actual.mean_error_cd_m2 == pytest.approx(seen.mean_error_cd_m2, rel=1e-3)


@pytest.fixture
def scene(tmp_path):
    write_relight_files(tmp_path)
    write_glb(tmp_path / "block.glb", block(0.3, [0, 0, 0]))

    def of(**display):
        tables = {
            "rig": {"camera": {"file": "camera.toml"}},
            "capture": {"source": "photo.png"},
            "surface": {"depth": {"file": "depth.npy"}},
            "ambient": {"illuminance_lux": 200.0, "dimming": 0.5},
            "object": [{"mesh": "block.glb", "name": "block", "position": [0, 0, -1.2]}],
            "lamp": [{"name": "bulb", "kind": "point", "position": [0.5, 0.3, -1.2],
                      "flux_lm": 900.0}],
            "display": display,
        }  # fmt: skip
        return andon.scene_from_dict(tables, folder=tmp_path)

    return of


@pytest.mark.parametrize("compensation", [True, False])
def test_a_scene_on_either_engine(engine, scene, compensation):
    keys = {"mode": "ost", "peak_luminance_cd_m2": 300.0, "transmittance": 0.8}
    frame = andon.render(scene(**keys, compensation=compensation), engine=engine)
    video = andon.render(scene(), engine=engine)
    assert video.seen is None
    assert (frame.luminance.cd_m2 == video.luminance.cd_m2).all()
    real = frame.captured.luminance_per_unit * frame.captured.linear.astype(float)
    light = 300 * srgb_decode(frame.image.rgb / 255) + 0.8 * real
    assert_agree(frame.seen.luminance.cd_m2, light, rtol=1e-3, atol=1e-2)
    assert 0 < frame.seen.dark_share < 1
    error = np.abs(frame.seen.luminance.cd_m2 - frame.luminance.cd_m2).mean()
    other = andon.render(scene(**keys, compensation=not compensation), engine=engine)
    error_of_other = np.abs(other.seen.luminance.cd_m2 - other.luminance.cd_m2).mean()
    assert (error < error_of_other) == compensation
    assert frame.surface.is_object.any()
    assert unlit_linear(frame.captured, andon.Renderer(scene(**keys)).prepared.ambient).max() <= 0.5
