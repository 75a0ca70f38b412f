"""Where E0 is too weak for the photograph to tell what a surface reflects, a picture of ρ does."""

import numpy as np
import pytest

import andon
from andon.composite.model import Ambient
from andon.composite.per_lux import (
    MAP_ERROR,
    MID_GREY,
    NOISE_FLOOR,
    map_scale,
    noise_floor,
    photograph_weight,
)
from andon.engines.prepared import prepare
from andon.errors import InputError
from andon.files.pictures import write_exr, write_png
from andon.lamps import DirectionalLamp
from andon.quantities import CameraFrame
from andon.responses import LINEAR, SRGB
from andon.spaces import View
from comparison import assert_agree, assert_same_picture
from worlds import ALL_CODES, scene

VIEW = View("pinhole", 48, 16, 40.0, 40.0, 23.5, 7.5)
WALL = np.full(VIEW.shape, 2.0)
SUN = DirectionalLamp("sun", np.array([0.0, 0, -1]), np.array([300.0, 200, 100]))
UNIT = 250 / np.pi  # cd/m² of the white of 250 lx


def relit(engine, photo, e0, rho, lamps=(SUN,), **more):
    return andon.relight(
        photo, VIEW, lamps, depth_m=WALL, ambient_lux=e0, engine=engine, reflectance_map=rho, **more
    )


def pictures(seed=5):
    """ρ, and E0 from a thousandth of its mean to ten times it."""
    random = np.random.default_rng(seed)
    e0 = 250 * 10 ** random.uniform(-3, 1, (*VIEW.shape, 3))
    return random.uniform(0, 1, (*VIEW.shape, 3)), e0


def test_the_weight_is_that_of_two_measurements():
    """Both are right within r where the floor is r of what a mid-grey shows: half of each."""
    equal = np.pi * UNIT * NOISE_FLOOR / (MAP_ERROR * MID_GREY)
    assert photograph_weight(np.array(equal), UNIT) == pytest.approx(0.5)
    assert equal / 250 == pytest.approx(0.01686, rel=1e-3)
    lux = equal * np.array([1e-6, 0.5, 1, 2, 1e6])
    w = photograph_weight(lux, UNIT)
    error_of_photograph = NOISE_FLOOR / (MID_GREY * lux / (np.pi * UNIT))
    parts = error_of_photograph**-2, np.full(5, MAP_ERROR**-2)
    assert w == pytest.approx(parts[0] / (parts[0] + parts[1]))
    assert (np.diff(w) > 0).all()
    assert w[0] < 1e-11
    assert w[-1] > 1 - 1e-11


@pytest.mark.parametrize(
    ("response", "step", "floor"),
    [
        (SRGB, 1 / 255, NOISE_FLOOR),
        (LINEAR, 1 / 255, 1 / 255),
        (LINEAR, 1 / 65535, NOISE_FLOOR),  # the sensor's noise is coarser
        (LINEAR, 0.0, NOISE_FLOOR),
    ],
)
def test_the_floor_is_the_first_code_of_the_photograph(response, step, floor):
    dark = np.zeros((*VIEW.shape, 3), np.float32)
    frame = CameraFrame(dark, VIEW, response, code_step=step)
    assert noise_floor(frame) == pytest.approx(floor, rel=1e-12)


def test_in_strong_light_the_photograph_is_right(engine):
    rho, _ = pictures()
    plain, mapped = (relit(engine, ALL_CODES, 250.0, m) for m in (None, rho))
    assert_agree(mapped.luminance.cd_m2, plain.luminance.cd_m2, rtol=2e-3, atol=0.05, share=0)


def test_the_map_takes_the_scale_of_the_photograph():
    """Exposed four times darker, and warm, than the map says; clipped pixels do not count."""
    rho, e0 = pictures()
    tint = np.array([0.5, 0.25, 0.125])
    linear = (tint * rho * e0 / np.pi / UNIT).astype(np.float32)
    clipped = np.zeros(VIEW.shape, bool)
    clipped[:, :20] = True
    frame = CameraFrame(linear + 9 * clipped[..., None], VIEW, SRGB, UNIT, clipped=clipped)
    assert map_scale(rho, frame, Ambient(e0)) == pytest.approx(tint, rel=1e-5)
    assert (map_scale(rho, frame, Ambient(e0 / 1000)) == 1).all()  # nothing is lit


def test_in_the_dark_the_map_is_right(engine):
    """Every code stands for a thousandth of a lux: ΔE falls on ρ, as ρ·ΔE/π."""
    rho, _ = pictures()
    black = np.zeros((*VIEW.shape, 3), np.uint8)
    e0 = np.full((*VIEW.shape, 3), 1e-3)
    e0[:, 0] = 20 * 250  # some of it is lit, and is what the picture is exposed for
    frame = relit(engine, black, e0, rho)
    unit = frame.captured.luminance_per_unit
    w = photograph_weight(np.array(1e-3), unit)
    expected = (1 - w) * rho * frame.illuminance.lux / np.pi
    assert w < 1e-3
    assert_agree(frame.luminance.cd_m2[:, 1:], expected[:, 1:], rtol=1e-3, atol=1e-3, share=0)
    assert (relit(engine, black, e0, None).luminance.cd_m2 == 0).all()


@pytest.mark.parametrize("constant", [True, False], ids=["constant E0", "map of E0"])
def test_without_lamps_every_byte_stays(engine, constant):
    rho, e0 = pictures()
    frame = relit(engine, ALL_CODES, 250.0 if constant else e0, rho, lamps=())
    assert (frame.image.rgb == ALL_CODES).all()


@pytest.mark.parametrize("constant", [True, False], ids=["constant E0", "map of E0"])
def test_both_engines_draw_the_same(gpu, tmp_path, constant):
    rho, e0 = pictures()
    lux = 250.0 if constant else e0
    expected, actual = (
        relit(engine, ALL_CODES, lux, rho, dimming=(0.3, 0.6, 0.9))
        for engine in ("reference", "gpu")
    )
    assert_same_picture(actual.image.rgb, expected.image.rgb, tmp_path, share=0)
    assert_agree(actual.luminance.cd_m2, expected.luminance.cd_m2, rtol=2e-3, atol=0.01, share=0)


def test_a_photograph_of_a_known_surface_comes_out_right(engine):
    """Coded in 8 bits under a light that falls to a thousandth, then lit evenly."""
    rho, e0 = pictures()
    e0 = e0[..., :1] * np.ones(3)
    unit = 2500 / np.pi
    photo = np.rint(255 * np.clip(SRGB.encode(rho * e0 / np.pi / unit), 0, 1)).astype(np.uint8)
    known = np.clip(rho * np.random.default_rng(1).normal(1, 0.1, rho.shape), 0, 1)
    truth = rho * (e0 + SUN.illuminance_lux) / np.pi

    def error(given):
        frame = relit(engine, photo, e0, given)
        white = frame.captured.luminance_per_unit / unit  # E0 has another mean than its white
        return np.abs(frame.luminance.cd_m2 / white - truth).mean()

    assert error(known) < 0.5 * error(None)


# ── through files ─────────────────────────────────────────────────────────────────────────────


def mapped(folder, name, **tables):
    return scene(folder, surface={"depth": "depth.npy", "reflectance_map": name}, **tables)


def write_map(path, rho):
    write_exr(path, np.asarray(rho, np.float32), unit="reflectance")


def test_codes_and_floats_say_the_same(tmp_path):
    rho = np.array([1.0, 0.21586050, 0.5]) * np.ones((48, 64, 1))
    rho[:, 40:] = 0
    codes = np.rint(255 * SRGB.encode(rho)).astype(np.uint8)
    write_png(tmp_path / "rho.png", codes)
    write_map(tmp_path / "rho.exr", SRGB.decode(codes / 255))
    by_codes, by_floats = (
        prepare(mapped(tmp_path, name)).measured["mono"].reflectance
        for name in ("rho.png", "rho.exr")
    )
    assert codes[0, 0, 1] == 128
    assert (by_codes[:, :40] > 0.1).all()
    assert np.abs(by_codes - by_floats).max() < 1e-6


def test_the_map_loses_its_distortion_with_the_photograph(tmp_path):
    ramp = np.linspace(0, 1, 64)
    write_map(tmp_path / "rho.exr", ramp[:, None] * np.ones((48, 1, 3)))
    camera = {"fx": 57.6, "distortion": [-0.2, 0.0, 0.0, 0.0]}
    found = prepare(mapped(tmp_path, "rho.exr", rig={"camera": camera}))
    rho = found.measured["mono"].reflectance[24, :, 0]
    moved = 0.5 * rho / rho[31:33].mean() - ramp
    assert np.ptp(moved[8:-8]) > 0.02
    assert np.abs(moved + moved[::-1])[8:-8].max() < 5e-3  # evenly to both sides


def test_a_frame_says_nothing_of_the_map_as_if_it_came_later(tmp_path):
    write_png(tmp_path / "rho.png", np.full((48, 64, 3), 99, np.uint8))
    assert prepare(mapped(tmp_path, "rho.png")).ignored == ()


def test_what_does_not_fit(tmp_path):
    write_png(tmp_path / "small.png", np.zeros((4, 5, 3), np.uint8))
    size = r"small\.png: surface\.reflectance_map: is 5×4 px but the camera is 64×48"
    with pytest.raises(InputError, match=size):
        prepare(mapped(tmp_path, "small.png"))
    write_map(tmp_path / "light.exr", np.full((48, 64, 3), 7))
    with pytest.raises(InputError, match=r"light\.exr: surface\.reflectance_map: ρ must be in"):
        prepare(mapped(tmp_path, "light.exr"))
    eyes = {"kind": "stereo", "camera": {"fx": 57.6}}
    both = {"source": {"left": "photo.png", "right": "photo.png"}}
    with pytest.raises(InputError, match=r"reflectance_map: is one picture for two eyes"):
        prepare(mapped(tmp_path, "small.png", rig=eyes, capture=both))


@pytest.mark.parametrize("bad", [-0.01, 1.5, np.nan])
def test_what_is_no_reflectance(bad):
    rho = np.full((*VIEW.shape, 3), 0.5)
    rho[3, 4, 1] = bad
    with pytest.raises(
        InputError, match=r"reflectance_map: ρ must be in \[0, 1\] everywhere, 1 of"
    ):
        relit("reference", ALL_CODES, 250.0, rho)


def test_a_map_of_another_size():
    with pytest.raises(InputError, match=r"reflectance_map: must be an array \(16, 48, 3\)"):
        relit("reference", ALL_CODES, 250.0, np.ones((4, 4, 3)))
