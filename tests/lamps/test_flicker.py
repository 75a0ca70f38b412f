"""Flicker: the map, its density and spectrum, times in any order."""

import numpy as np
import pytest

from andon.errors import InputError
from andon.lamps.flicker import Flicker, invariant_density
from andon.lamps.flicker.intermittency import iterate, uniform
from requirements import required


def test_the_map_is_that_of_the_paper():
    states = np.array([0.0, 1e-9, 1e-3, 0.1, 0.3, 0.5, 0.618, 0.7, 0.9, 0.999])
    for z in (1.2, 1.6, 1.95):
        after = iterate(states, z, np.zeros((1, len(states))))[0]
        assert np.allclose(after, (states + states**z) % 1, atol=2e-5, rtol=0)
        assert ((after >= 0) & (after < 1)).all()


def test_noise_frees_what_would_stay_at_zero_for_ever():
    assert not iterate(np.zeros(1), 1.8, np.zeros((50, 1))).any()
    orbit = Flicker(1, 1.8, 1.0).open_share(np.arange(3000.0))
    assert orbit.max() > 0.5


def test_uniform_numbers_are_uniform_and_unlike():
    drawn = uniform(7, np.arange(200, dtype=np.uint64), np.arange(500, dtype=np.uint64))
    assert drawn.min() >= 0
    assert drawn.max() < 1
    assert abs(drawn.mean() - 0.5) < 4 / np.sqrt(12 * drawn.size)
    assert abs(np.corrcoef(drawn[:-1].ravel(), drawn[1:].ravel())[0, 1]) < 0.013
    assert abs(np.corrcoef(drawn[:, :-1].ravel(), drawn[:, 1:].ravel())[0, 1]) < 0.013
    assert len(np.unique(drawn)) == drawn.size


@pytest.mark.parametrize(("z", "tolerance"), [(1.2, 0.002), (1.5, 0.003), (1.8, 0.006)])
def test_the_invariant_density_is_how_often_orbits_are_where(z, tolerance):
    density = invariant_density(z)
    orbits = Flicker(5, z, 1.0, 2000).open_share(np.arange(0.0, 2000, 5))
    raw = Flicker(5, z, 1.0, 2000)
    states = raw.states(np.arange(0, 2000, 5))
    assert abs(states.mean() - density.mean) < tolerance
    assert abs(orbits.mean() - density.mean) < tolerance
    for state in (0.01, 0.1, 0.5, 0.9):
        share = float(np.interp(state, density.states, density.below))
        assert abs((states < state).mean() - share) < 3 * tolerance


def test_the_density_of_z_2s_limit_still_rises():
    for z in (1.01, 1.99):
        density = invariant_density(z)
        assert (np.diff(density.below) >= 0).all()
        assert density.below[0] == 0
        assert density.below[-1] == 1
        assert 0 < density.mean < 1


def test_mean_1_without_a_clamp():
    swing = Flicker(2, 1.6, 10.0, 1000).at(np.linspace(0, 60, 301))
    assert swing.shape == (1000, 301)
    assert abs(swing.mean() - 1) < 0.02
    assert swing.min() >= 0
    assert swing.max() > 2.5
    assert len(np.unique(swing)) == swing.size


def test_any_time_in_any_order():
    times = np.array([3.3, 0.0, 911.7, -4.4, 3.3, 2000.0])
    together = Flicker(9, 1.8, 12.0, 3).at(times)
    for index in (3, 5, 0, 2, 1):
        alone = Flicker(9, 1.8, 12.0, 3).at(times[index])
        assert np.array_equal(alone, together[:, index])
    assert np.array_equal(together[:, 0], together[:, 4])


def test_a_stream_does_not_depend_on_how_many_there_are():
    times = np.linspace(0, 5, 40)
    assert np.array_equal(Flicker(1, streams=2).at(times), Flicker(1, streams=50).at(times)[:2])


def test_streams_and_seeds_are_independent():
    times = np.arange(4000.0)
    first = Flicker(1, 1.6, 1.0, 3).at(times)
    other = Flicker(2, 1.6, 1.0, 1).at(times)
    correlation = np.corrcoef(np.concatenate([first, other]))
    # Slowly decaying correlations make 1/√4000 several times larger.
    assert np.abs(correlation - np.eye(4)).max() < 0.12


def test_smooth_between_iterations():
    """The spline bends without steps: frames of 8 iterations a second change by little."""
    swing = Flicker(3, 1.8, 8.0, 100).at(np.arange(0, 20, 1e-3))
    slope = np.diff(swing, axis=1) / 1e-3
    # A cubic B-spline's slope is at most the largest difference of states per iteration.
    most = 8.0 / Flicker(3, 1.8).mean
    assert np.abs(slope).max() <= most * 1.0001
    assert np.abs(np.diff(slope, axis=1)).max() < most * 8 * 1e-3 * 4.1


def test_an_exposure_is_the_mean_over_it():
    flicker = Flicker(4, 1.8, 30.0, 4)
    for exposure in (0.004, 1 / 30, 0.37):
        fine = 2.0 + (np.arange(4000) + 0.5) / 4000 * exposure - exposure / 2
        expected = flicker.at(fine).mean(axis=1)
        assert np.allclose(flicker.at(2.0, exposure_seconds=exposure), expected, rtol=1e-6)


def test_exposures_of_a_frame_take_what_would_alias():
    """Of 240 iterations a second frames at 24 would see noise; their means vary far less."""
    flicker = Flicker(6, 1.3, 240.0, 60)
    frames = np.arange(200) / 24
    instants = flicker.at(frames).std()
    means = flicker.at(frames, exposure_seconds=1 / 24).std()
    # Of ten independent values the mean would have 0.32 of their deviation; these are correlated.
    assert means < 0.7 * instants


def test_the_light_of_a_seed_is_the_same_on_every_machine():
    """Kept figures: arithmetic that differs in the last bit would make another orbit."""
    found = Flicker(2026, 1.8, 8.0, 2).at(np.array([0.0, 1.0, 10.0, 100.0]))
    assert np.allclose(found, KEPT, atol=1e-7)


KEPT = [
    [0.02171663, 0.0242707, 0.21482098, 2.84333133],
    [0.08831612, 0.12741676, 0.06851337, 2.8267874],
]


def test_the_slope_is_that_of_z():
    signal = required("scipy.signal")
    for z, slope in ((1.6, -0.50), (1.8, -0.72)):
        orbits = Flicker(1, z, 1.0, 24).states(np.arange(2**15))
        frequency, power = signal.welch(orbits, nperseg=2**13, axis=1)
        band = (frequency >= 4e-4) & (frequency <= 1e-2)
        found = np.polyfit(np.log(frequency[band]), np.log(power.mean(0)[band]), 1)[0]
        assert abs(found - slope) < 0.15


def test_no_period_below_a_hundred_thousand():
    """A state that came again would bring its successors: there is none."""
    orbit = Flicker(8, 1.8, 1.0).states(np.arange(120_000))[0]
    assert len(np.unique(orbit)) == len(orbit)


@pytest.mark.parametrize(
    ("wrong", "field"),
    [
        ({"z": 1.0}, "flicker.z"),
        ({"z": 2.0}, "flicker.z"),
        ({"z": float("nan")}, "flicker.z"),
        ({"iterations_per_second": 0}, "flicker.iterations_per_second"),
        ({"iterations_per_second": float("inf")}, "flicker.iterations_per_second"),
        ({"streams": 0}, "flicker.streams"),
    ],
)
def test_impossible_settings_are_refused(wrong, field):
    with pytest.raises(InputError) as caught:
        Flicker(**wrong)
    assert caught.value.field == field


def test_impossible_times_are_refused():
    flicker = Flicker()
    for times in (float("nan"), float("inf"), 1e13):
        with pytest.raises(InputError, match="iterations from 0"):
            flicker.at(times)
    for exposure in (-1.0, float("nan"), 1e6):
        with pytest.raises(InputError, match="exposure_seconds"):
            flicker.at(0.0, exposure_seconds=exposure)
    assert flicker.at(np.zeros((0, 3))).shape == (1, 0, 3)
