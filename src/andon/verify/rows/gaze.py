"""Gaze: lag, noise and faults of each filter, on eyes that are made up and on a real recording.

Noise is 0.5° of standard deviation in the angle between the rays, at 30 Hz, the rate of the paper's
tracker. *Jitter* is the RMS of the output about its mean, *bias* its mean minus the truth. The bias
is not that of the filter alone: rays that miss each other above or below meet too near to the eyes,
by θy²/(θx·b) for angles θx across and θy above, b between the eyes. The mean in metres is too far
by about as much, and hides it.

A *step* is a look from 0.4 m to 0.6 m, the paper's ball and background, in dioptres; the time is
that from the first sample of the new fixation. It is 0 where that sample is enough.
"""

from __future__ import annotations

import csv
import os
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from andon.files.gaze import GazeRecording, read_eyelink, read_gaze
from andon.observer.gaze import (
    FILTERS,
    REASONS,
    blink_intervals,
    fixations,
    make_filter,
    smoothed,
)
from andon.observer.gaze.measures import jitter_dioptres, lag_seconds, rests, thinned
from andon.observer.model import Fixation
from andon.verify.gaze_trials import (
    RATE_HZ,
    eyes_on,
    faulty_outputs,
    ramp_lag,
    rest_figures,
    step_seconds,
)
from andon.verify.registry import NotShown, Row

__all__ = ["ROWS"]

Float = NDArray[np.float64]

DISTANCES_M = (0.4, 1.0, 2.0)


# ── made up ─────────────────────────────────────────────────────────────────────────────────────


def _crossing() -> float:
    points = np.random.default_rng(3).uniform([-2, -2, 0.2], [2, 2, 20], (2000, 3))
    found = fixations(eyes_on(np.arange(2000) / RATE_HZ, points))
    return float(np.abs(found.dioptres * np.linalg.norm(points, axis=1) - 1).max())


def _skewed_fixation(sign: float) -> float:
    """Distance in metres of eyes on 1 m whose vergence is `sign`·0.5° too large."""
    half = np.arctan(0.0315) + sign * np.radians(0.25)
    aimed = np.array([[[np.sin(half), 0, np.cos(half)], [-np.sin(half), 0, np.cos(half)]]])
    eyes = eyes_on(np.zeros(1), np.array([[0.0, 0.0, 1.0]]))
    one = GazeRecording(np.zeros(1), eyes.origins_m, aimed, np.ones(1))
    return float(1 / fixations(one).dioptres[0])


def _span() -> float:
    """Largest difference from the 0.88 m and 1.16 m that the specification names."""
    return max(abs(_skewed_fixation(1) - 0.88), abs(_skewed_fixation(-1) - 1.16))


def _not_finite() -> float:
    return float(sum((~np.isfinite(out)).sum() for out in faulty_outputs()))


# ── a real recording ────────────────────────────────────────────────────────────────────────────


def _data(*parts: str) -> Path:
    path = Path(os.environ.get("ANDON_DATA", "")).joinpath(*parts)
    if not os.environ.get("ANDON_DATA") or not path.exists():
        raise NotShown(f"needs {'/'.join(parts)} in the folder that ANDON_DATA names")
    return path


@cache
def _core(rate_hz: float | None) -> tuple[GazeRecording, Fixation, Float]:
    """The recording, its fixations, and the spans in which the eyes rest."""
    recording = read_gaze(_data("gaze_pupil_core", "rec1_gaze_positions.csv"))
    assert isinstance(recording, GazeRecording)
    if rate_hz is not None:
        recording = thinned(recording, rate_hz)
    found = fixations(recording)
    return recording, found, rests(recording, found.good)


def _rejected(reason: str) -> float:
    found = _core(None)[1]
    return 100 * found.rejected.get(reason, 0) / len(found.good)


def _series(name: str, rate_hz: float | None) -> Float:
    found = _core(rate_hz)[1]
    return smoothed(found.times_seconds, found.dioptres, make_filter(name)).dioptres


def _jitter(name: str, rate_hz: float | None) -> float:
    _, found, spans = _core(rate_hz)
    return jitter_dioptres(found.times_seconds, _series(name, rate_hz), spans)


def _lag(name: str, rate_hz: float | None) -> float:
    found = _core(rate_hz)[1]
    return lag_seconds(found.times_seconds, found.dioptres, _series(name, rate_hz))


def _recorded_not_finite() -> float:
    return float(sum((~np.isfinite(_series(n, r))).sum() for n in FILTERS for r in (None, RATE_HZ)))


def _against_tracker(low_degrees: float, high_degrees: float) -> float:
    """Median difference of our vergence from the tracker's own 3-D point, by gap of the rays."""
    recording, found, _ = _core(None)
    path = _data("gaze_pupil_core", "rec1_gaze_positions.csv")
    with path.open(encoding="utf-8", newline="") as stream:
        rows = [
            [row[f"gaze_point_3d_{a}"] or "nan" for a in "xyz"] for row in csv.DictReader(stream)
        ]
    points = np.array(rows, np.float64) * 1e-3
    theirs = 1 / np.linalg.norm(points - recording.origins_m.mean(axis=1), axis=-1)
    fits = found.good & (found.gap_degrees >= low_degrees) & (found.gap_degrees < high_degrees)
    return float(np.nanmedian((found.dioptres - theirs)[fits]))


def _blinks_missed() -> float:
    """Blinks of the tracker's own list, ≥ 50 ms, that are not found to within a sample, and ours
    that are not on it.
    """
    folder = "pupil_eyelink_binocular"
    samples = read_eyelink(_data(folder, "002_rlmw_samples_short.asc"))
    events = read_eyelink(_data(folder, "002_rlmw_events_short.asc"))
    shut = (np.nan_to_num(samples.pupils) == 0) | np.isnan(samples.gaze_px).any(axis=-1)
    step, wrong = 0.002, 0
    for eye, side in enumerate(("left", "right")):
        ours = blink_intervals(samples.times_seconds, shut[:, eye]).tolist()
        theirs = [(a, b) for name, a, b in events.blinks if name == side and b - a + step >= 0.05]
        for a, b in theirs:
            near = [o for o in ours if abs(o[0] - a) < 1.1 * step and abs(o[1] - b) < 1.1 * step]
            wrong += not near
            ours = [o for o in ours if o not in near]
        wrong += len(ours)
    return float(wrong)


# ── the rows ────────────────────────────────────────────────────────────────────────────────────

_CORE = "a real recording of two eyes (Pupil Labs Core, 39 s, 250 Hz)"
_STEP = "a look from 0.4 m to 0.6 m, 30 Hz"
_CORE_30 = f"{_CORE}, thinned to 30 Hz"


def _made_up(name: str) -> list[Row]:
    key = f"glass.gaze.{name}"
    figures = [
        Row(f"{key}.step_{round(100 * share)}", "glass", None, "s", _STEP,
            lambda share=share: step_seconds(name, share))
        for share in (0.5, 0.63)
    ]  # fmt: skip
    figures.append(
        Row(f"{key}.ramp_lag", "glass", None, "s", "a gaze that draws near steadily, 30 Hz",
            lambda: ramp_lag(name))
    )  # fmt: skip
    for metres in DISTANCES_M:
        for index, what in enumerate(("jitter", "bias")):
            figures.append(
                Row(f"{key}.{what}_{metres:g}m", "glass", None, "D",
                    f"eyes at rest on {metres:g} m with 0.5° of noise, 30 Hz",
                    lambda metres=metres, index=index: rest_figures(name, metres)[index])
            )  # fmt: skip
    return figures


def _recorded(name: str) -> list[Row]:
    key = f"glass.gaze.recording.{name}"
    rates: tuple[tuple[str, str, float | None], ...] = (
        ("", _CORE, None),
        (".30_hz", _CORE_30, RATE_HZ),
    )
    return [
        row
        for end, against, rate in rates
        for row in (
            Row(f"{key}.jitter{end}", "glass", None, "D", f"{against}, where both eyes rest",
                lambda rate=rate: _jitter(name, rate)),
            Row(f"{key}.lag{end}", "glass", None, "s", against, lambda rate=rate: _lag(name, rate)),
        )
    ]  # fmt: skip


ROWS: tuple[Row, ...] = (
    Row("glass.gaze.crossing", "glass", 1e-12, "relative", "rays through one point", _crossing),
    Row("glass.gaze.skew", "glass", 0.005, "m", "0.88…1.16 m of ±0.5° at 1 m", _span),
    Row("glass.gaze.never_nan", "glass", 0, "values",
        "blinks, NaN bursts, one eye lost, parallel rays, clocks that jump, gaps, 7 to 1000 Hz",
        _not_finite),
    Row("glass.gaze.paper.lag", "glass", 1e-6, "s", "(20 − 1)/2 samples of 30 Hz, 0.317 s",
        lambda: abs(ramp_lag("paper") - 19 / 2 / RATE_HZ)),
    *(row for name in FILTERS for row in _made_up(name)),
    Row("glass.gaze.recording.never_nan", "glass", 0, "values", _CORE, _recorded_not_finite),
    *(
        Row(f"glass.gaze.recording.rejected.{reason.replace(' ', '_')}", "glass", None, "%", _CORE,
            lambda reason=reason: _rejected(reason))
        for reason in REASONS
    ),
    Row("glass.gaze.recording.tracker.level", "glass", None, "D, median difference",
        "the tracker's own 3-D point, rays within 0.2° of each other",
        lambda: _against_tracker(0, 0.2)),
    Row("glass.gaze.recording.tracker.skew", "glass", None, "D, median difference",
        "the same, which levels the rays first, where ours are 1…3° apart",
        lambda: _against_tracker(1, 3)),
    *(row for name in FILTERS for row in _recorded(name)),
    Row("glass.gaze.blinks", "glass", None, "blinks wrong",
        "the list of an EyeLink 1000, 41 s, both eyes, from 50 ms on", _blinks_missed),
)  # fmt: skip
