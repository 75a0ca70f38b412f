"""Real recordings: rays of two eyes with blinks and losses, and pupils with known blinks."""

import numpy as np
import pytest

from andon.files import read_gaze
from andon.files.gaze import read_eyelink
from andon.observer.gaze import FILTERS, blink_intervals, fixations, make_filter, smoothed
from andon.observer.gaze.measures import jitter_dioptres, lag_seconds, rests, thinned


@pytest.fixture(scope="module")
def core(data_dir):
    return read_gaze(data_dir / "gaze_pupil_core" / "rec1_gaze_positions.csv")


@pytest.fixture(scope="module")
def eyelink(data_dir):
    folder = data_dir / "pupil_eyelink_binocular"
    return tuple(
        read_eyelink(folder / f"002_rlmw_{part}_short.asc") for part in ("samples", "events")
    )


def test_the_numbers_that_its_publishers_state(core):
    assert len(core.times_seconds) == 9302
    both = np.isfinite(core.directions).all(axis=(1, 2))
    between = np.linalg.norm(core.origins_m[both, 1] - core.origins_m[both, 0], axis=-1)
    assert np.median(between) == pytest.approx(0.0596, abs=5e-4)
    assert np.median(1 / np.diff(core.times_seconds)) == pytest.approx(250, rel=0.01)
    angle = np.degrees(np.arccos(np.einsum("ni,ni->n", *core.directions[both].transpose(1, 0, 2))))
    assert np.percentile(angle, [2, 98])[0] > 0.5


def test_it_agrees_with_the_trackers_own_depth(core, data_dir):
    """Pupil Labs' own 3-D point: the same where both rays are level with each other."""
    import csv

    path = data_dir / "gaze_pupil_core" / "rec1_gaze_positions.csv"
    with path.open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    points = np.array(
        [[float(row[f"gaze_point_3d_{axis}"] or "nan") for axis in "xyz"] for row in rows]
    )
    found = fixations(core, minimum_confidence=0.0)
    middle = core.origins_m.mean(axis=1)
    theirs = 1 / np.linalg.norm(points * 1e-3 - middle, axis=-1)
    known = found.good & np.isfinite(theirs)
    level = known & (found.gap_degrees < 0.2)
    assert level.sum() > 300
    assert np.median(np.abs(found.dioptres - theirs)[level]) < 0.005
    # They level both rays before they meet, which skew rays do nearer to the eyes than level ones:
    # θy²/(θx·b) for an angle θy above each other and θx across.
    skew = known & (found.gap_degrees > 1.0)
    assert np.median((found.dioptres - theirs)[skew]) > 0.02


def test_every_sample_is_good_or_has_a_reason(core):
    found = fixations(core)
    assert found.good.sum() + sum(found.rejected.values()) == len(core.times_seconds)
    assert set(found.rejected) == {
        "blink", "both eyes missing", "one eye missing", "diverging", "gap"
    }  # fmt: skip
    assert np.isfinite(found.dioptres).sum() == found.good.sum()
    assert 0.5 < found.good.mean() < 0.8


@pytest.mark.parametrize("name", FILTERS)
def test_no_filter_gives_a_nan(core, name):
    found = fixations(core)
    out = smoothed(found.times_seconds, found.dioptres, make_filter(name))
    assert np.isfinite(out.dioptres).all()
    states = {out.at(time)[1] for time in np.linspace(-1, 45, 500)}
    assert states == {"seen", "held", "fallback"}


def test_every_filter_is_stiller_than_none_and_the_paper_is_the_latest(core):
    slow = thinned(core, 30.0)
    found = fixations(slow)
    spans = rests(slow, found.good)
    assert len(spans) >= 10
    jitter, lag = {}, {}
    for name in FILTERS:
        out = smoothed(found.times_seconds, found.dioptres, make_filter(name)).dioptres
        jitter[name] = jitter_dioptres(found.times_seconds, out, spans)
        lag[name] = lag_seconds(found.times_seconds, found.dioptres, out)
    assert jitter["none"] > 1.5 * max(jitter["paper"], jitter["one-euro"])
    assert lag["none"] == pytest.approx(0, abs=1e-9)
    assert lag["one-euro"] < 0.1 < 0.3 < lag["paper"]


def test_blinks_as_the_tracker_found_them(eyelink):
    """Both eyes: 10 blinks of its own list; the shortest, of 42 and 30 ms, is below our 50."""
    samples, events = eyelink
    shut = (np.nan_to_num(samples.pupils) == 0) | np.isnan(samples.gaze_px).any(axis=-1)
    for eye, name in enumerate(("left", "right")):
        ours = blink_intervals(samples.times_seconds, shut[:, eye])
        theirs = np.array(
            [(start, end) for side, start, end in events.blinks if side == name and end > start]
        )
        theirs = theirs[theirs[:, 1] - theirs[:, 0] + 0.002 >= 0.05]
        assert len(ours) == len(theirs) >= 8
        np.testing.assert_allclose(ours, theirs, atol=0.0021)  # a sample of 500 Hz


# ── the measures themselves ─────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("late_seconds", [0.0, 0.1, 0.317])
def test_lag_of_a_series_that_is_late_by_as_much(late_seconds):
    times = np.arange(0, 20, 0.02)
    raw = 1.5 + np.sin(1.3 * times) + 0.3 * np.sin(3.1 * times)
    late = times - late_seconds
    smooth = 1.5 + np.sin(1.3 * late) + 0.3 * np.sin(3.1 * late)
    raw[200:230] = np.nan
    assert lag_seconds(times, raw, smooth) == pytest.approx(late_seconds, abs=1e-3)


def test_lag_of_nothing_is_unknown():
    times = np.arange(100) / 30
    assert np.isnan(lag_seconds(times, np.full(100, np.nan), np.ones(100)))


def test_jitter_is_the_rms_within_spans():
    times = np.arange(200) / 100
    values = np.where(np.arange(200) % 2, 1.1, 0.9) + np.where(times < 1, 0.0, 5.0)
    spans = np.array([[0.0, 0.99], [1.0, 1.99]])
    assert jitter_dioptres(times, values, spans) == pytest.approx(0.1)
    assert np.isnan(jitter_dioptres(times, values, np.zeros((0, 2))))
