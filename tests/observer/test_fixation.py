"""Where rays meet, why samples are rejected, blinks: closed forms."""

import numpy as np
import pytest

from andon.observer.gaze.blinks import blink_intervals, inside
from andon.observer.gaze.fixation import REASONS, fixations, meeting
from andon.observer.model import DistanceRecording, GazeRecording
from gaze_files import EYES_M, looking_at


def recording(directions, confidence=1.0, rate_hz=30.0):
    count = len(directions)
    return GazeRecording(
        np.arange(count) / rate_hz,
        np.broadcast_to(EYES_M, (count, 2, 3)).copy(),
        np.array(directions, float),
        np.broadcast_to(np.asarray(confidence, float), count).copy(),
    )


def turned(degrees):
    """(2, 3): eyes that look at 1 m, the angle between their rays wider by `degrees`."""
    half = np.arctan(0.0315) + np.radians(degrees) / 2
    return np.array([[np.sin(half), 0, np.cos(half)], [-np.sin(half), 0, np.cos(half)]])


def test_rays_that_cross_meet_there():
    points = np.random.default_rng(3).uniform([-2, -2, 0.2], [2, 2, 20], (500, 3))
    found = meeting(np.broadcast_to(EYES_M, (500, 2, 3)), looking_at(points))
    np.testing.assert_allclose(found.points_m, points, rtol=1e-11, atol=1e-11)
    assert found.gap_m.max() < 1e-11
    fixed = fixations(recording(looking_at(points)))
    assert fixed.good.all()
    np.testing.assert_allclose(fixed.dioptres, 1 / np.linalg.norm(points, axis=1), rtol=1e-11)


def test_skew_rays_meet_in_the_middle_of_their_gap():
    origins = np.array([[[-1.0, 0.1, 0.0], [1.0, -0.1, 0.0]]])
    aimed = np.array([[[1.0, 0.0, 3.0], [-1.0, 0.0, 3.0]]]) / np.sqrt(10)
    found = meeting(origins, aimed)
    np.testing.assert_allclose(found.points_m, [[0, 0, 3]], atol=1e-12)
    assert found.gap_m[0] == pytest.approx(0.2)
    np.testing.assert_allclose(found.along_m, [[np.sqrt(10)] * 2])


def test_the_gap_is_an_angle_at_the_eyes():
    directions = looking_at([(0.0, 0.0, 0.5)])
    origins = np.array([EYES_M])
    origins[0, 1, 1] += 0.5 * np.tan(np.radians(2.0))  # the right ray passes 2° above
    one = GazeRecording(np.zeros(1), origins, directions, np.ones(1))
    found = fixations(one, maximum_gap_degrees=2.5)
    # The point between the eyes has risen with one of them, by half of it.
    assert found.gap_degrees[0] == pytest.approx(2.0, abs=2e-3)
    assert found.good.all()
    assert fixations(one, maximum_gap_degrees=1.9).rejected == {"gap": 1}


def test_half_a_degree_at_one_metre_is_skewed_in_metres_and_even_in_dioptres():
    fixed = fixations(recording([turned(0.5), turned(0.0), turned(-0.5)]))
    near, middle, far = 1 / fixed.dioptres
    assert middle == pytest.approx(1.0, abs=1e-12)
    assert round(near, 2) == 0.88
    assert round(far, 2) == 1.16
    nearer, farther = fixed.dioptres[0] - 1, 1 - fixed.dioptres[2]
    assert nearer == pytest.approx(farther, rel=2e-3)
    assert nearer == pytest.approx(np.radians(0.5) / 0.063, rel=2e-3)


def test_each_reason_is_counted_once():
    good, gone = looking_at([(0.0, 0.0, 1.0)])[0], np.full(3, np.nan)
    left, right = good
    apart = turned(-5.0)
    high = np.array([0, np.sin(np.radians(8)), np.cos(np.radians(8))])
    ahead = np.array([0.0, 0.0, 1.0])
    near = looking_at([(0.0, 0.0, 0.04)])[0]
    samples = [good, [gone, right], [left, gone], [gone, gone], apart, [ahead, ahead],
               [left, right + high], near, good]  # fmt: skip
    samples = np.array(samples)
    samples /= np.linalg.norm(samples, axis=-1, keepdims=True)
    confidence = np.array([0.5, 1, 1, 1, 1, 1, 1, 1, 1])
    found = fixations(recording(samples, confidence, rate_hz=10.0))
    assert found.rejected == {
        "blink": 2,  # one sample at 10 Hz lasts 0.1 s: the first, and the one without eyes
        "one eye missing": 2,
        "diverging": 2,
        "gap": 1,
        "too near": 1,
    }
    assert found.good.tolist() == [False] * 8 + [True]
    assert np.isnan(found.dioptres).tolist() == [True] * 8 + [False]
    assert list(found.rejected) == [r for r in REASONS if r in found.rejected]


def test_a_longer_loss_is_no_blink():
    directions = looking_at([(0.0, 0.0, 1.0)] * 60)
    directions[10:40] = np.nan
    found = fixations(recording(directions))
    assert found.rejected == {"both eyes missing": 30}
    low = np.ones(60)
    low[10:40] = 0.59
    found = fixations(recording(looking_at([(0.0, 0.0, 1.0)] * 60), low))
    assert found.rejected == {"low confidence": 30}
    same = recording(looking_at([(0.0, 0.0, 1.0)] * 60), low)
    assert fixations(same, minimum_confidence=0.59).good.all()


def test_parallel_rays_are_no_fixation_and_no_warning():
    directions = np.tile([0.0, 0.0, 1.0], (5, 2, 1))
    with np.errstate(all="raise"):
        found = fixations(recording(directions))
    assert found.rejected == {"diverging": 5}
    assert np.isnan(found.dioptres).all()


def test_vergence_does_not_depend_on_the_frame():
    points = np.random.default_rng(4).uniform([-1, -1, 0.3], [1, 1, 3], (50, 3))
    plain = recording(looking_at(points))
    turn, _ = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))
    moved = GazeRecording(
        plain.times_seconds,
        plain.origins_m @ turn.T + [1.0, 2.0, -3.0],
        plain.directions @ turn.T,
        plain.confidence,
    )
    np.testing.assert_allclose(fixations(moved).dioptres, fixations(plain).dioptres, rtol=1e-9)


def test_distances_are_fixations_too():
    one = DistanceRecording(
        np.arange(4) / 10, np.array([1.0, np.nan, 30.0, 2.0]), np.array([1, 1, 1, 0.1])
    )
    found = fixations(one)
    # A run of one sample at the end of a recording lasts no time: no blink.
    assert found.rejected == {"blink": 1, "low confidence": 1, "too near": 1}
    assert found.good.tolist() == [True, False, False, False]
    assert np.isnan(found.gap_degrees).all()


# ── blinks ──────────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize(
    ("first", "last", "found"),
    [
        (0, 3, False),
        (0, 5, True),
        (20, 70, True),
        (20, 71, False),
        (95, 100, False),
        (93, 100, True),
    ],
)
def test_a_blink_lasts_50_to_500_milliseconds(first, last, found):
    times = np.arange(100) / 100
    shut = np.zeros(100, bool)
    shut[first:last] = True
    blinks = blink_intervals(times, shut)
    assert len(blinks) == found
    if found:
        np.testing.assert_allclose(blinks[0], [times[first], times[last - 1]])
        assert inside(times, blinks).tolist() == shut.tolist()


def test_no_samples_no_blinks():
    assert blink_intervals(np.zeros(0), np.zeros(0, bool)).shape == (0, 2)
    assert not inside(np.arange(3.0), np.zeros((0, 2))).any()
