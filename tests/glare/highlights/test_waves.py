"""Ripples: their steepness, their speed, what pixels blur of them, and their seed."""

import numpy as np
import pytest

from andon.glare.highlights.waves import make_waves, slopes_at

SETTINGS = {"slope": 0.06, "wavelength_m": (0.1, 1.5), "wind_degrees": 30.0, "count": 32}
POINTS = np.random.default_rng(0).uniform(-50, 50, (20_000, 3))
STILL = np.zeros_like(POINTS)


def test_mean_square_slope_is_the_stated_one():
    slopes, lost = slopes_at(make_waves(**SETTINGS, seed=3), POINTS, STILL, STILL, 0.0)
    assert np.sqrt((slopes**2).sum(axis=1).mean()) == pytest.approx(0.06, rel=0.02)
    assert lost.max() == 0


def test_what_a_pixel_blurs_is_not_lost():
    waves = make_waves(**SETTINGS, seed=3)
    across, down = STILL + np.array([0.2, 0, 0]), STILL + np.array([0, 0, 0.5])
    slopes, lost = slopes_at(waves, POINTS, across, down, 1.0)
    together = (slopes**2).sum(axis=1).mean() + lost.mean()
    assert together == pytest.approx(0.06**2, rel=0.03)
    assert 0.2 * 0.06**2 < lost.mean() < 0.9 * 0.06**2
    far, gone = slopes_at(waves, POINTS, 1000 * across, 1000 * down, 1.0)
    assert np.abs(far).max() < 1e-9
    assert gone == pytest.approx(0.06**2)


def test_a_long_wave_is_as_fast_as_gravity_makes_it():
    waves = make_waves(slope=0.1, wavelength_m=(1.0, 1.0), wind_degrees=0.0, count=1, seed=1)
    k = np.linalg.norm(waves.number[0])
    assert k == pytest.approx(2 * np.pi)
    # Deep water: √(g/k); surface tension adds 0.01 %.
    assert waves.frequency[0] / k == pytest.approx(np.sqrt(9.81 / k), rel=1e-3)
    period = 2 * np.pi / waves.frequency[0]
    now, _ = slopes_at(waves, POINTS[:5], STILL[:5], STILL[:5], 0.3)
    later, _ = slopes_at(waves, POINTS[:5], STILL[:5], STILL[:5], 0.3 + period)
    assert later == pytest.approx(now, abs=1e-12)


def test_a_seed_is_a_pattern():
    first, again, other = (make_waves(**SETTINGS, seed=seed) for seed in (5, 5, 6))
    np.testing.assert_array_equal(first.number, again.number)
    np.testing.assert_array_equal(first.phase, again.phase)
    assert np.abs(first.phase - other.phase).max() > 0.1
