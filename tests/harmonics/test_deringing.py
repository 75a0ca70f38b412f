"""Windows and deringing: what is cured, what is left alone, and that less would not do."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from andon.errors import InputError
from andon.harmonics import (
    basis,
    convolved,
    deringed,
    heat_factors,
    smallest,
    smoothing,
    window_factors,
    windowed,
)
from andon.harmonics.minima import minimum

from .quadrature import units

SPHERE = units(20000, 99)


def delta(direction, order=2):
    """A light of irradiance 1 from one direction."""
    return basis(direction, order)[..., None] * np.ones(3)


def bright(count, order, seed):
    """Lights of random harmonics around a mean; most of them ring."""
    light = np.random.default_rng(seed).normal(size=(count, (order + 1) ** 2, 3))
    light[:, 0] = np.abs(light[:, 0]) + 1.5
    return light


# ── minima ──────────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize(
    ("order", "above"), [(0, 1e-12), (1, 1e-3), (2, 5e-3), (3, 1e-2), (4, 2e-2)]
)
def test_minimum_against_many_directions(order, above):
    """Never above the least of 20,000 directions, and below it by no more than their spacing."""
    series = np.random.default_rng(order).normal(size=(30, (order + 1) ** 2))
    sampled = (series @ basis(SPHERE, order).T).min(axis=1)
    excess = sampled - minimum(series)
    assert excess.min() >= -1e-12
    assert excess.max() < above


def test_minimum_of_closed_forms():
    """x: −1; x²: 0, all around; 3z² − 1 along and across; yz: −1/2. Both the exact way and the
    searching one, which a band of dust calls."""
    root_1, root_2 = np.sqrt(3 / (4 * np.pi)), np.sqrt(15 / (4 * np.pi))
    rows = np.zeros((4, 9))
    rows[0, 3] = 1 / root_1
    rows[1, [0, 6, 8]] = np.array(
        [
            np.sqrt(4 * np.pi) / 3,
            -np.sqrt(16 * np.pi / 5) / 6,
            np.sqrt(16 * np.pi / 15) / 2,
        ]
    )  # x² = 1/3 − (3z² − 1)/6 + (x² − y²)/2
    rows[2, 6] = 1 / np.sqrt(5 / (16 * np.pi))
    rows[3, 5] = 1 / root_2
    expected = [-1, 0, -1, -0.5]
    np.testing.assert_allclose(minimum(rows), expected, atol=1e-14)
    dusty = np.concatenate([rows, np.full((4, 7), 1e-13)], axis=1)
    np.testing.assert_allclose(minimum(dusty), expected, atol=1e-11)


# ── windows ─────────────────────────────────────────────────────────────────────────────────────


def test_window_factors():
    np.testing.assert_allclose(window_factors("hann", 3)[[0, 1, 4]], [1, 0.75, 0.25])
    np.testing.assert_allclose(
        window_factors("lanczos", 3)[[0, 1, 4]],
        [1, np.sin(np.pi / 3) / (np.pi / 3), np.sin(2 * np.pi / 3) / (2 * np.pi / 3)],
    )
    np.testing.assert_allclose(
        window_factors("gaussian", 3)[[0, 1, 4]], np.exp([0, -(np.pi**2) / 18, -4 * np.pi**2 / 18])
    )
    assert (window_factors("hann", 2, 4)[4:] == 0).all()
    assert (window_factors("lanczos", 2, 4)[4:] == 0).all()
    assert len(window_factors("gaussian", 2, 4)) == 25


def test_no_window():
    with pytest.raises(InputError, match="window width: must be > 0 bands, got 0"):
        windowed(np.ones((9, 3)), width=0)
    with pytest.raises(InputError, match="must be hann, lanczos or gaussian, got 'box'"):
        windowed(np.ones((9, 3)), "box")


# ── deringing ───────────────────────────────────────────────────────────────────────────────────


def test_a_fixed_window_is_no_cure():
    """The dips of a delta light: 0.25 + t/2 + 0.3125·(3t² − 1)/2, with and without Hann's
    factors 0.75 and 0.25."""
    light = delta(units(1, 3)[0])
    np.testing.assert_allclose(smallest(light), -19 / 480, atol=1e-12)
    np.testing.assert_allclose(smallest(windowed(light)), -0.046875, atol=1e-12)
    cured = deringed(light)
    np.testing.assert_allclose(smallest(cured), 0, atol=1e-12)
    assert convolved(cured)[:, 0] @ basis(units(1, 3)[0]) > 0.84  # its peak


def test_less_would_not_do():
    lights = bright(200, 2, 4)
    s = smoothing(lights)
    rings = s < 1
    assert 0.3 < rings.mean() < 1
    assert (smallest(deringed(lights)) >= -1e-12 * lights[:, 0]).all()
    less = lights * heat_factors(np.minimum(1, s * (1 + 1e-6)), 2)[..., None]
    assert (smallest(less).min(axis=-1)[rings] < 0).all()
    values = basis(SPHERE) @ convolved(deringed(lights))
    assert values.min() > -1e-12


@pytest.mark.parametrize("target", ["irradiance", "luminance"])
@pytest.mark.parametrize("order", range(5))
def test_orders_and_targets(order, target):
    lights = bright(40, order, 5 + order)
    cured = deringed(lights, target)
    mean = lights[:, 0]
    assert (smallest(cured, target) >= -1e-9 * mean).all()
    np.testing.assert_array_equal(cured[:, 0], mean)
    rings = (smallest(lights, target) < 0).any(axis=-1)
    assert rings.any() == (order > 0)
    np.testing.assert_array_equal(cured[~rings], lights[~rings])
    assert (smoothing(lights, target)[rings] < 1).all()


@given(st.integers(0, 10**6))
def test_what_needs_nothing_comes_back_bit_for_bit(seed):
    light = np.random.default_rng(seed).normal(size=(4, 9, 3))
    light[:, 0] = 12
    assert (smoothing(light) == 1).all()
    assert deringed(light).tobytes() == light.tobytes()


def test_channels_are_smoothed_alike():
    light = delta(units(1, 6)[0])
    light[1:, 1:] = 0  # only red rings
    cured = deringed(light)
    np.testing.assert_allclose(smallest(cured)[0], 0, atol=1e-12)
    light[1:, 1:] = 1e-3
    ratio = deringed(light)[1:] / light[1:]
    np.testing.assert_allclose(ratio, np.repeat(ratio[:, :1], 3, axis=1), rtol=1e-14)


@settings(max_examples=30, deadline=None)
@given(st.floats(0, 1), st.floats(0, 1), st.integers(0, 10**6))
def test_smoothing_never_lowers_the_minimum(one, two, seed):
    """The maximum principle, on which the halving rests."""
    light = bright(3, 4, seed)
    low, high = sorted((one, two))
    least = [smallest(light * heat_factors(s, 4)[:, None], "luminance") for s in (low, high)]
    assert (least[0] >= least[1] - 1e-9).all()


def test_darkness_and_a_light_without_mean():
    assert (deringed(np.zeros((2, 9, 3))) == 0).all()
    light = np.zeros((9, 3))
    light[2] = 1
    np.testing.assert_allclose(deringed(light), 0, atol=1e-12)


def test_shapes():
    lights = bright(6, 2, 7)
    together = deringed(lights.reshape(2, 3, 9, 3))
    np.testing.assert_array_equal(together.reshape(6, 9, 3), deringed(lights))
    assert smoothing(lights[0]).shape == ()


def test_no_light():
    light = delta(units(1, 8)[0])
    with pytest.raises(InputError, match="must be finite"):
        deringed(light * np.nan)
    with pytest.raises(InputError, match=r"mean \(band 0\) must be ≥ 0"):
        deringed(-light)
    with pytest.raises(InputError, match="must be irradiance or luminance, got 'radiance'"):
        deringed(light, "radiance")
