"""Filters: steps, ramps, gaps, rates, clocks; what holds and what falls back."""

import math

import numpy as np
import pytest

from andon.errors import InputError
from andon.observer.gaze.filters import (
    FILTERS,
    RESTING_DIOPTRES,
    MovingMean,
    OneEuro,
    filter_of,
    make_filter,
)
from andon.observer.gaze.smoother import Smoother, smoothed
from andon.scene.eye import Gaze

NAN = float("nan")


def run(name, times, values, **options):
    return smoothed(
        np.asarray(times, float), np.asarray(values, float), make_filter(name), **options
    )


@pytest.mark.parametrize("name", FILTERS)
@pytest.mark.parametrize("rate_hz", [7.0, 30.0, 200.0, 1000.0])
def test_a_constant_stays(name, rate_hz):
    out = run(name, np.arange(50) / rate_hz, np.full(50, 1.7))
    np.testing.assert_allclose(out.dioptres, 1.7, rtol=1e-12)


@pytest.mark.parametrize("name", FILTERS)
def test_one_by_one_is_the_same_as_all_at_once(name):
    generator = np.random.default_rng(6)
    times = np.cumsum(generator.uniform(0.002, 0.1, 400))
    values = generator.uniform(0.2, 3, 400)
    values[generator.random(400) < 0.3] = NAN
    series = smoothed(times, values, make_filter(name))
    one = Smoother(make_filter(name))
    for index, (time, value) in enumerate(zip(times, values, strict=True)):
        assert one.push(time, value) == series.dioptres[index]
        for later in (0.0, 0.3, 0.7):
            if index + 1 == len(times) or time + later < times[index + 1]:
                assert one.at(time + later) == series.at(time + later)


def test_the_paper_is_the_mean_of_twenty_metres():
    generator = np.random.default_rng(7)
    metres = generator.uniform(0.3, 2, 60)
    out = run("paper", np.arange(60) / 30, 1 / metres)
    for index in (19, 20, 59):
        assert 1 / out.dioptres[index] == pytest.approx(metres[index - 19 : index + 1].mean())
    assert 1 / out.dioptres[4] == pytest.approx(metres[:5].mean())


def test_a_mean_of_twenty_lags_nineteen_halves_of_a_sample():
    times = np.arange(100) / 30
    out = run("mean", times, 0.5 + 0.2 * times)
    np.testing.assert_allclose(out.dioptres[19:], 0.5 + 0.2 * (times[19:] - 19 / 2 / 30))
    assert round(19 / 2 / 30, 3) == 0.317


def test_a_step_through_the_mean_is_a_ramp():
    out = run("mean", np.arange(-40, 40) / 30, [1.0] * 40 + [2.0] * 40)
    np.testing.assert_allclose(out.dioptres[40:60], 1 + np.arange(1, 21) / 20)


def test_one_sample_at_infinity_is_twenty_of_the_papers():
    values = np.full(60, 1.0)
    values[30] = 0.0
    paper = run("paper", np.arange(60) / 30, values).dioptres
    mean = run("mean", np.arange(60) / 30, values).dioptres
    assert (paper[30:50] == 0).all()
    assert paper[50] == 1
    assert mean.min() == pytest.approx(0.95)


def test_one_euro_without_speed_is_a_low_pass():
    """x(t) of a step is 1 − Π(1 − α) and its limit for short samples 1 − exp(−2π·f·t)."""
    form = OneEuro(1.0, 0.0)
    form.update(0.0, 0.0)
    values = [form.update(k / 30, 1.0) for k in range(1, 31)]
    share = 1 / (1 + 30 / (2 * math.pi))
    np.testing.assert_allclose(values, 1 - (1 - share) ** np.arange(1, 31))
    form = OneEuro(1.0, 0.0)
    form.update(0.0, 0.0)
    fine = [form.update(k / 10000, 1.0) for k in range(1, 10001)]
    np.testing.assert_allclose(fine[1590], 1 - math.exp(-2 * math.pi * 0.1591), atol=1e-3)


def test_one_euro_opens_with_speed():
    """One step by hand: Casiez et al. 2012, algorithm 1."""
    form = OneEuro(1.0, 0.5)
    form.update(0.0, 1.0)
    dt = 1 / 30
    share = 1 / (1 + 1 / (2 * math.pi * dt))
    speed = share * (1.5 / dt)
    opened = 1 / (1 + 1 / (2 * math.pi * (1 + 0.5 * speed) * dt))
    assert form.update(dt, 2.5) == pytest.approx(1 + opened * 1.5, abs=1e-12)


@pytest.mark.parametrize("rate_hz", [7.0, 30.0, 200.0, 1000.0])
def test_one_euro_takes_as_long_at_every_rate(rate_hz):
    times = np.arange(0, 3, 1 / rate_hz)
    out = run("one-euro", times, np.where(times < 1, 2.5, 1.5)).dioptres
    crossed = times[np.argmax(out < 2.5 - 0.9)] - 1
    assert crossed <= 0.12 + 1 / rate_hz


@pytest.mark.parametrize("name", FILTERS)
def test_never_a_nan_out(name):
    generator = np.random.default_rng(8)
    for rate_hz in (7.0, 30.0, 200.0, 1000.0):
        times = np.arange(300) / rate_hz
        values = generator.uniform(0, 4, 300)
        values[generator.random(300) < 0.5] = NAN
        values[:20] = NAN
        values[100:200] = [NAN, np.inf, -np.inf, 0.0, 1e-320] * 20
        out = run(name, times, values)
        assert np.isfinite(out.dioptres).all()
        for time in times:
            dioptres, state = out.at(time)
            assert (dioptres is None) == (state == "fallback")


@pytest.mark.parametrize("name", FILTERS)
def test_before_anything_was_seen(name):
    out = run(name, [0.0, 0.1, 0.2], [NAN, NAN, 2.0])
    assert out.dioptres[:2].tolist() == [RESTING_DIOPTRES] * 2
    assert out.at(-1.0) == (None, "fallback")
    assert out.at(0.15) == (None, "fallback")
    assert out.at(0.2) == (2.0, "seen")


@pytest.mark.parametrize("name", FILTERS)
def test_seen_then_held_then_fallback(name):
    out = run(name, [0.0, 0.1, 0.2, 0.3], [1.5, 1.5, NAN, NAN], hold_seconds=0.5)
    states = [out.at(time) for time in (0.1, 0.2, 0.59, 0.61, 100.0)]
    assert [state for _, state in states] == ["seen", "held", "held", "fallback", "fallback"]
    assert [value for value, _ in states[:3]] == pytest.approx([1.5] * 3)
    assert states[3][0] is None


def test_a_stream_that_stops_is_held_soon():
    out = run("none", [0.0, 0.1], [1.0, 2.0], hold_seconds=0.5)
    assert [out.at(0.1 + age)[1] for age in (0.19, 0.21, 0.51)] == ["seen", "held", "fallback"]


@pytest.mark.parametrize("name", FILTERS)
def test_after_ten_seconds_the_past_is_forgotten(name):
    times = np.concatenate([np.arange(30) / 30, 10 + np.arange(3) / 30])
    out = run(name, times, [0.5] * 30 + [2.5] * 3)
    np.testing.assert_allclose(out.dioptres[30:], 2.5)
    assert out.at(5.0) == (None, "fallback")
    assert out.at(10.0)[1] == "seen"


def test_a_clock_that_stutters_or_is_set_back():
    one = Smoother(make_filter("mean"))
    for time, value in [(5.0, 1.0), (5.0, 9.0), (4.9, 9.0), (NAN, 9.0)]:
        one.push(time, value)
    assert one.ignored == 3
    assert one.at(5.0) == (1.0, "seen")
    one.push(0.0, 2.0)  # more than a second: the clock was set anew
    assert one.restarts == 1
    assert one.at(0.0) == (2.0, "seen")
    one.push(0.1, 4.0)
    assert one.at(0.1) == (3.0, "seen")


def test_filters_of_a_scene():
    euro = filter_of(Gaze(filter="one-euro", minimum_cutoff_hz=2.0, speed_coefficient=0.0))
    euro.update(0.0, 0.0)
    assert euro.update(1 / 30, 1.0) == pytest.approx(1 / (1 + 30 / (4 * math.pi)))
    paper = filter_of(Gaze(filter="paper", samples=2))
    paper.update(0.0, 1.0)
    paper.update(0.1, 1.0)
    assert paper.update(0.2, 0.5) == pytest.approx(1 / 1.5)
    none = filter_of(Gaze(filter="none"))
    none.update(0.0, 3.0)
    assert none.update(0.1, NAN) == 3.0


@pytest.mark.parametrize(
    "wrong",
    [
        lambda: make_filter("median"),
        lambda: MovingMean(0),
        lambda: OneEuro(0.0),
        lambda: OneEuro(1.0, -1.0),
        lambda: OneEuro(NAN),
    ],
)
def test_impossible_filters_are_refused(wrong):
    with pytest.raises(InputError):
        wrong()
