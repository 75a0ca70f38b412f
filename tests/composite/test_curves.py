"""Surfaces with a curve of their own: RGB' = f(f⁻¹(RGB)·(dimming·E0 + ΔE)/E0)."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from andon.composite.curve_table import CELL_SHIFT, curve_table, thinned
from andon.composite.curves import beyond_curves, light_of, linear_of
from andon.composite.model import Ambient, MeasuredSurface
from andon.composite.reference import relit_linear, unlit_linear
from andon.errors import InputError
from andon.quantities import CameraFrame
from andon.responses import SurfaceCurve
from andon.spaces import View
from comparison import assert_agree

VIEW = View("pinhole", 6, 4, 5.0, 5.0, 2.5, 1.5)
E0 = np.array([200.0, 150.0, 100.0])
# A black level, and a shoulder as of a tone curve: each channel another.
LUX = np.array([0.0, 20, 80, 200, 500, 1200])
SHAPE = 0.002 + np.array([0.9, 0.7, 0.5]) * (LUX / (LUX + 400))[:, None] ** [0.9, 1.0, 1.1]
CURVE = SurfaceCurve(LUX, SHAPE)
ZEROS = np.zeros((*VIEW.shape, 3))


def frame_of(linear):
    return CameraFrame(np.broadcast_to(linear, ZEROS.shape).astype(np.float32), VIEW)


def everywhere(*curves, rho=None):
    return MeasuredSurface(rho, curves, np.zeros(VIEW.shape, np.int16))


rising = arrays(np.float64, st.integers(2, 12), elements=st.floats(1e-3, 1e3)).map(np.cumsum)


@st.composite
def curves(draw):
    lux = draw(rising)
    steps = draw(arrays(np.float64, (len(lux), 3), elements=st.floats(1e-3, 1.0)))
    return SurfaceCurve(lux - lux[0] * draw(st.booleans()), np.cumsum(steps, axis=0))


@settings(max_examples=60, deadline=None)
@given(curves(), arrays(np.float64, (5, 3), elements=st.floats(-10, 30)))
def test_the_inverse_undoes_the_curve_everywhere(curve, linear):
    assert curve.linear_of(curve.lux_of(linear)) == pytest.approx(linear, rel=1e-9, abs=1e-6)


@settings(max_examples=30, deadline=None)
@given(curves())
def test_a_curve_goes_through_what_was_measured(curve):
    lux = np.repeat(curve.illuminance_lux[:, None], 3, axis=1)
    assert curve.linear_of(lux) == pytest.approx(curve.linear, rel=1e-9)


def test_a_surface_is_brought_to_what_was_measured_of_it():
    """Photographed at one of the measured illuminances, lit to another of them."""
    for before, after in [(1, 4), (4, 2), (3, 5)]:
        ambient = Ambient(np.full(3, LUX[before]))
        added = ZEROS + LUX[after] - LUX[before]
        relit = relit_linear(frame_of(SHAPE[before]), ambient, added, everywhere(CURVE))
        assert_agree(relit, ZEROS + SHAPE[after], rtol=1e-6, atol=0, share=0)


def test_the_texture_of_a_pixel_is_a_factor_on_its_light():
    """Half as reflecting as what was measured: half of its lux, before and after."""
    ambient, added = Ambient(E0, (0.5, 0.75, 1.0)), ZEROS + np.array([30.0, 20, 10])
    half = CURVE.linear_of(0.5 * E0)
    relit = relit_linear(frame_of(half), ambient, added, everywhere(CURVE))
    expected = CURVE.linear_of(0.5 * ([0.5, 0.75, 1.0] * E0 + added))
    assert_agree(relit, expected, rtol=1e-6, atol=1e-7, share=0)


def test_dimming_alone_and_light_taken_away():
    measured, captured = everywhere(CURVE), frame_of(CURVE.linear_of(E0))
    dimmed = unlit_linear(captured, Ambient(E0, (0.1,) * 3), measured)
    assert_agree(dimmed, ZEROS + CURVE.linear_of(0.1 * E0), rtol=1e-6, atol=1e-7, share=0)
    dark = relit_linear(captured, Ambient(E0), ZEROS - 2 * E0, measured)
    assert_agree(dark, ZEROS + SHAPE[0], rtol=1e-6, atol=1e-9, share=0)  # f(0), no less


def test_what_is_darker_than_the_surface_in_the_dark_stays():
    """Captured below f(0): there is no light in it that could be scaled."""
    measured, captured = everywhere(CURVE), frame_of(0.25 * SHAPE[0])
    for dimming in (1.0, 0.2):
        for added in (0.0, 500.0, -500.0):
            relit = relit_linear(captured, Ambient(E0, (dimming,) * 3), ZEROS + added, measured)
            assert_agree(relit, captured.linear, rtol=1e-6, atol=0, share=0)


@settings(max_examples=30, deadline=None)
@given(
    slope=arrays(np.float64, 3, elements=st.floats(1e-4, 10)),
    linear=arrays(np.float32, ZEROS.shape, elements=st.floats(0, 4, width=32)),
    added=arrays(np.float64, ZEROS.shape, elements=st.floats(-300, 1e4)),
    dimming=st.floats(0, 2),
)
def test_a_straight_curve_is_no_curve(slope, linear, added, dimming):
    straight = SurfaceCurve(LUX[[0, 2, 5]], LUX[[0, 2, 5], None] * slope)
    frame, ambient = CameraFrame(linear, VIEW), Ambient(E0, (dimming,) * 3)
    plain, by_curve = (relit_linear(frame, ambient, added, m) for m in (None, everywhere(straight)))
    assert by_curve == pytest.approx(plain, rel=1e-9, abs=1e-9 * max(1.0, plain.max()))


def test_pixels_without_a_curve_are_as_ever():
    rng = np.random.default_rng(2)
    frame = CameraFrame(rng.uniform(0, 1, ZEROS.shape).astype(np.float32), VIEW)
    curve_of = np.full(VIEW.shape, -1, np.int16)
    curve_of[:, 3:] = 1
    straight = SurfaceCurve(LUX[[0, 5]], LUX[[0, 5], None] * np.ones(3))
    measured = MeasuredSurface(None, (straight, CURVE), curve_of)
    ambient, added = Ambient(E0, (0.4, 0.5, 0.6)), rng.uniform(-99, 300, ZEROS.shape)
    found, plain = (relit_linear(frame, ambient, added, m) for m in (measured, None))
    assert_agree(found[:, :3], plain[:, :3], rtol=1e-12, atol=1e-15, share=0)
    whole = relit_linear(frame, ambient, added, everywhere(CURVE))
    assert (found[:, 3:] == whole[:, 3:]).all()


def test_in_the_dark_reflectance_is_told_in_the_lux_of_the_curve():
    """ρ that the surface of the curve has: added light falls on it as if it had been measured."""
    unit = 250 / np.pi
    rho = CURVE.linear_of(E0) * np.pi * unit / E0  # what shows CURVE in the mean of E0
    dark = np.full(ZEROS.shape, 1e-4)
    ambient = Ambient(np.where(np.arange(6)[:, None] < 1, 6 * E0 - 5e-4, dark))
    frame = CameraFrame((ZEROS + SHAPE[0]).astype(np.float32), VIEW, luminance_per_unit=unit)
    relit = relit_linear(frame, ambient, ZEROS + E0, everywhere(CURVE, rho=rho + ZEROS))
    assert_agree(relit[:, 1:], CURVE.linear_of(E0) + ZEROS[:, 1:], rtol=1e-4, atol=0, share=0)


def test_pixels_beyond_what_was_measured_are_told():
    captured, relit = ZEROS + SHAPE[2], ZEROS + SHAPE[3]
    captured[0, 0], relit[1, 1] = SHAPE[0] - 1e-3, [0.2, SHAPE[-1, 1] + 1e-3, 0.2]
    captured[2, 2] = SHAPE[-1] * (1 + 1e-6)  # float32
    captured[3, 3] = relit[3, 3] = 2 * SHAPE[-1]  # not changed
    measured = everywhere(CURVE)
    assert np.argwhere(beyond_curves(captured, relit, measured)).tolist() == [[0, 0], [1, 1]]
    measured.curve_of[0, 0] = -1
    assert np.argwhere(beyond_curves(captured, relit, measured)).tolist() == [[1, 1]]
    assert beyond_curves(captured, relit, None) is None


# ── the shader's table ────────────────────────────────────────────────────────────────────────


def looked_up(table, first, light, row):
    """As `curve_linear` of curves.wgsl does it."""
    light = np.float32(light)
    cell = int(np.maximum(light, np.float32(0)).view(np.uint32) >> CELL_SHIFT) - first
    knot, value, below, above = table[row, np.clip(cell, 0, table.shape[1] - 1)]
    return value + (light - knot) * (below if light < knot else above)


@settings(max_examples=60, deadline=None)
@given(curves(), arrays(np.float32, 8, elements=st.floats(-50, 2e4, width=32)))
def test_the_table_is_the_thinned_curve_itself(curve, light):
    whole = thinned(curve)
    table, first = curve_table([CURVE, whole])
    for channel in range(3):
        found = [looked_up(table, first, value, 3 + channel) for value in light]
        expected = whole.linear_of(np.repeat(light[:, None].astype(float), 3, axis=1))[:, channel]
        scale = np.abs(expected) + np.abs(curve.linear).max()
        assert (np.abs(found - expected) <= 2e-5 * scale).all()


def test_few_knots_are_all_kept():
    assert (thinned(CURVE).illuminance_lux == LUX).all()
    assert (thinned(CURVE).linear == SHAPE).all()


@pytest.mark.parametrize("power", [0.5, 0.8, 1.5, 2.0])
def test_thinning_a_dense_curve_errs_little_even_in_the_dark(power):
    lux = np.geomspace(1e-3, 1e5, 20_000)
    curve = SurfaceCurve(lux, lux[:, None] ** power * np.ones(3))
    thin = thinned(curve)
    assert len(thin.illuminance_lux) < 2000
    between = np.repeat(np.sqrt(lux[1:] * lux[:-1])[:, None], 3, axis=1)
    error = np.abs(thin.linear_of(between) / curve.linear_of(between) - 1).max()
    assert error < power * abs(power - 1) / 8 * 2**-10 * 1.5 + 2e-7
    assert error < 4e-4


def test_light_and_its_picture_are_copies():
    linear = ZEROS + 0.3
    assert (linear_of(light_of(linear, everywhere(CURVE)), everywhere(CURVE)) == linear).all()
    assert (linear == 0.3).all()


@pytest.mark.parametrize(
    ("lux", "linear", "message"),
    [
        ([0.0], SHAPE[:1], r"at least 2 illuminances"),
        (LUX, SHAPE[:, :2], r"as many rows of 3 channels, got \(6,\) and \(6, 2\)"),
        ([0, 1, 1], SHAPE[:3], r"illuminance_lux: must rise strictly .* rows 2 and 3 do not"),
        ([0, 1, 2], SHAPE[[0, 1, 1]], r"linear: must rise strictly from row to row, rows 2 and 3"),
        ([-1, 1], SHAPE[:2], r"illuminance_lux: must be finite and ≥ 0"),
        ([0, np.nan], SHAPE[:2], r"illuminance_lux: must be finite"),
    ],
)
def test_what_is_no_curve(lux, linear, message):
    with pytest.raises(InputError, match=message):
        SurfaceCurve(np.array(lux, float), linear)
