"""Curves of surfaces on both engines: by mask, by lamp, by dimming, by light that is taken away."""

from dataclasses import replace

import numpy as np
import pytest

import andon
from andon.composite.model import MeasuredSurface
from andon.engines.arrays import prepare_arrays
from andon.lamps import DirectionalLamp, PointLamp
from andon.lamps.sources import scaled
from andon.pipeline import Renderer
from andon.responses import SRGB, SurfaceCurve
from andon.spaces import View
from comparison import assert_agree, assert_same_picture
from worlds import ALL_CODES

VIEW = View("pinhole", 48, 16, 40.0, 40.0, 23.5, 7.5)
WALL = np.full(VIEW.shape, 2.0)
LUX = np.array([0.0, 10, 40, 100, 250, 600, 2000])
SHOULDER = SurfaceCurve(LUX, 0.001 + 1.2 * (LUX / (LUX + 500))[:, None] ** [0.8, 0.9, 1.0])
TOE = SurfaceCurve(LUX[2:], 0.01 + 1e-5 * LUX[2:, None] ** [1.5, 1.6, 1.7])
LEFT = np.broadcast_to(np.arange(48) < 20, VIEW.shape)
RIGHT = np.broadcast_to(np.arange(48) >= 30, VIEW.shape)
BOTH = [(SHOULDER, LEFT), (TOE, RIGHT)]
LAMP = PointLamp("lamp", np.array([0.3, 0.2, -1.2]), np.array([90.0, 60, 20]))
SUN = DirectionalLamp("sun", np.array([0.0, 0, -1]), np.array([150.0, 120, 90]))
E0 = np.random.default_rng(7).uniform(20, 900, (*VIEW.shape, 3))


def drawn(engine, lamps=(), e0=250.0, **more):
    return andon.relight(
        ALL_CODES, VIEW, lamps, depth_m=WALL, ambient_lux=e0, engine=engine,
        **({"curves": BOTH} | more),
    )  # fmt: skip


@pytest.mark.parametrize("curves", [SHOULDER, TOE, BOTH], ids=["shoulder", "toe", "both"])
@pytest.mark.parametrize("e0", [250.0, E0], ids=["constant E0", "map of E0"])
def test_without_lamps_every_byte_stays(engine, curves, e0):
    assert (drawn(engine, curves=curves, e0=e0).image.rgb == ALL_CODES).all()


def test_a_dense_curve_keeps_every_byte_too(engine):
    """Of thousands of knots in steps, of which the shader keeps the first in each of its cells."""
    rng = np.random.default_rng(3)
    lux = np.linspace(0, 1000, 5000)
    steps = SurfaceCurve(
        lux, 1e-5 + np.cumsum(0.1 + rng.exponential(1, (5000, 3)) ** 3, axis=0) / 3e4
    )
    assert (drawn(engine, curves=steps).image.rgb == ALL_CODES).all()


@pytest.mark.parametrize("e0", [250.0, E0], ids=["constant E0", "map of E0"])
@pytest.mark.parametrize(
    "more",
    [
        {"lamps": (LAMP, SUN)},
        {"lamps": (LAMP,), "dimming": (0.2, 0.5, 0.9)},
        {"dimming": 0.05},
        {"lamps": (SUN,), "reflectance_map": np.full((*VIEW.shape, 3), 0.4)},
        {"lamps": (LAMP, SUN), "curves": ()},
    ],
    ids=["lamps", "lamp and dimming", "dimming", "reflectance", "no curve"],
)
def test_both_engines_draw_the_same(gpu, tmp_path, e0, more):
    expected, actual = (drawn(name, e0=e0, **more) for name in ("reference", "gpu"))
    assert_same_picture(actual.image.rgb, expected.image.rgb, tmp_path, share=0)
    assert_agree(actual.luminance.cd_m2, expected.luminance.cd_m2, rtol=2e-3, atol=0.02, share=0)
    shares = [frame.report.beyond_curve_share for frame in (actual, expected)]
    assert shares[0] == pytest.approx(shares[1], abs=0.01)


@pytest.mark.parametrize("share", [0.4, 1.5])
def test_both_engines_take_a_source_away(gpu, tmp_path, share):
    """Of E0 a part, or more than there is: negative ΔE."""
    gone = scaled(SUN, np.full(3, -share))
    settings = {
        "depth_m": WALL, "ambient_lux": SUN.illuminance_lux, "dimming": 1.0, "response": SRGB,
        "photometry": "absolute", "curves": BOTH,
    }  # fmt: skip
    prepared = replace(prepare_arrays(ALL_CODES, VIEW, (SUN,), **settings), lamps=lambda _: (gone,))
    expected, actual = (Renderer(prepared, name).render() for name in ("reference", "gpu"))
    assert_same_picture(actual.image.rgb, expected.image.rgb, tmp_path, share=0)
    assert_agree(actual.luminance.cd_m2, expected.luminance.cd_m2, rtol=2e-3, atol=0.02, share=0)
    dark = SHOULDER.linear_of(np.zeros(3))
    if share > 1:
        lit = expected.captured.linear[:, :20] > dark
        left = expected.luminance.cd_m2[:, :20] / expected.captured.luminance_per_unit
        assert left[lit] == pytest.approx(np.broadcast_to(dark, left.shape)[lit], rel=1e-6)


def test_a_straight_curve_draws_the_picture_of_none(engine):
    straight = SurfaceCurve(LUX, LUX[:, None] * [0.002, 0.003, 0.001])
    settings = {"lamps": (LAMP, SUN), "dimming": (0.3, 0.6, 1.0), "e0": E0}
    plain, by_curve = (drawn(engine, curves=c, **settings) for c in ((), straight))
    assert np.abs(by_curve.image.rgb.astype(int) - plain.image.rgb).max() <= 1
    assert_agree(by_curve.luminance.cd_m2, plain.luminance.cd_m2, rtol=2e-3, atol=0.02, share=0)


def test_the_sun_on_a_surface_that_was_measured_in_it(engine):
    """Lux that no half float holds."""
    lux = np.array([0.0, 1e3, 2e4, 1.2e5])
    curve = SurfaceCurve(lux, np.array([0.001, 0.05, 0.4, 1.0])[:, None] * np.ones(3))
    sun = DirectionalLamp("sun", np.array([0.0, 0, -1]), np.full(3, 1e5))
    frame = drawn(engine, (sun,), e0=2e4, curves=curve)
    captured = np.asarray(frame.captured.linear, float)
    expected = curve.linear_of(np.maximum(curve.lux_of(captured), 0) * 6)
    found = frame.luminance.cd_m2 / frame.captured.luminance_per_unit
    lit = captured >= 0.001
    assert found[lit] == pytest.approx(expected[lit], rel=2e-3)


def test_later_masks_win_and_the_rest_has_no_curve():
    prepared = prepare_arrays(
        ALL_CODES, VIEW, (), depth_m=WALL, ambient_lux=9.0, dimming=1.0, response=SRGB,
        photometry="absolute", curves=[*BOTH, (SHOULDER, np.eye(16, 48, 31) > 0)],
    )  # fmt: skip
    found: MeasuredSurface = prepared.measured["mono"]
    assert found.curve_of[0].tolist() == [0] * 20 + [-1] * 10 + [1, 2] + [1] * 16
