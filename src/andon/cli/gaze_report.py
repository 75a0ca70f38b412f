"""What ``andon gaze`` writes: the study of a recording, its pictures and its table."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.display.time_series import COLOURS, Bars, Curve, Panel, Spans, drawn
from andon.errors import InputError
from andon.files import read_gaze
from andon.files.atomic import write_bytes
from andon.files.pictures import write_png
from andon.observer.gaze import FILTERS, blink_intervals, fixations, make_filter, smoothed
from andon.observer.gaze.fixation import shut
from andon.observer.gaze.measures import jitter_dioptres, lag_seconds, rests, thinned
from andon.observer.gaze.smoother import Smoothed
from andon.observer.model import Fixation, GazeRecording
from andon.scene.eye import Gaze

__all__ = ["Study", "study_of", "write_fixations", "write_pictures"]

Float = NDArray[np.float64]

SHADES = {"blink": (226, 205, 190), "rejected": (238, 234, 220)}
# Depth beyond is drawn at the top: 10 m is 0.1 D, less than the noise of any tracker.
FARTHEST_M = 10.0
# Gaps wider than this are not bridged by a line.
LONGEST_STEP_SECONDS = 0.25


@dataclass(frozen=True, eq=False)
class Study:
    """A recording, its fixations, all filters' series, and the report as JSON."""

    fixation: Fixation
    blinks: Float
    series: dict[str, Smoothed]
    chosen: str
    report: dict[str, Any]


def study_of(gaze: Gaze, path: Path, rate_hz: float | None = None) -> Study:
    """Reads a recording and measures it with every filter; the rays thinned to `rate_hz` first."""
    recording = read_gaze(path)
    if rate_hz is not None:
        if not isinstance(recording, GazeRecording):
            rule = "is for recordings of rays, this one is of distances"
            raise InputError(rule, file=path, field="--rate")
        recording = thinned(recording, rate_hz)
    found = fixations(
        recording,
        minimum_confidence=gaze.minimum_confidence,
        maximum_gap_degrees=gaze.maximum_gap_degrees,
    )
    options: dict[str, Any] = {
        "samples": gaze.samples,
        "minimum_cutoff_hz": gaze.minimum_cutoff_hz,
        "speed_coefficient": gaze.speed_coefficient,
    }
    series = {
        name: smoothed(
            found.times_seconds,
            found.dioptres,
            make_filter(name, **options),
            hold_seconds=gaze.hold_seconds,
        )
        for name in FILTERS
    }
    closed = shut(recording, gaze.minimum_confidence)
    blinks = blink_intervals(found.times_seconds, closed)
    report = {"recording": path.name, "filter": gaze.filter, **_facts(found, blinks)}
    report["dropped_rows"] = recording.dropped
    spans = (
        rests(recording, found.good) if isinstance(recording, GazeRecording) else np.zeros((0, 2))
    )
    report["rests"] = len(spans)
    report["settings"] = {**options, "hold_seconds": gaze.hold_seconds}
    report["filters"] = {name: _figures(found, out, spans) for name, out in series.items()}
    return Study(found, blinks, series, gaze.filter, report)


def _facts(found: Fixation, blinks: Float) -> dict[str, Any]:
    times, seen = found.times_seconds, found.dioptres[found.good]
    steps = np.diff(times)
    verging = None
    if len(seen):
        low, middle, high = (float(v) for v in np.percentile(seen, [5, 50, 95]))
        verging = {"p5": low, "median": middle, "p95": high}
    return {
        "samples": len(times),
        "duration_seconds": float(times[-1] - times[0]),
        "median_rate_hz": float(1 / np.median(steps)) if len(steps) else 0.0,
        "good": int(found.good.sum()),
        "rejected": found.rejected,
        "blinks": len(blinks),
        "vergence_dioptres": verging,
    }


def _figures(found: Fixation, out: Smoothed, spans: Float) -> dict[str, Any]:
    times = found.times_seconds
    states = [out.at(time)[1] for time in times.tolist()]
    jitter = jitter_dioptres(times, np.where(found.good, out.dioptres, np.nan), spans)
    lag = lag_seconds(times, found.dioptres, out.dioptres)
    return {
        "lag_seconds": None if math.isnan(lag) else lag,
        "jitter_dioptres": None if math.isnan(jitter) else jitter,
        "not_finite": int((~np.isfinite(out.dioptres)).sum()),
        **{state: states.count(state) / len(states) for state in ("seen", "held", "fallback")},
    }


# ── what is written ─────────────────────────────────────────────────────────────────────────────


def write_fixations(study: Study, path: Path) -> Path:
    """One row a sample: time, raw and smoothed vergence, gap, state. Empty: none."""
    found, out = study.fixation, study.series[study.chosen]
    lines = ["time_seconds,dioptres,gap_degrees,smoothed_dioptres,state"]
    for index, time in enumerate(found.times_seconds.tolist()):
        value, state = out.at(time)
        numbers = (
            found.dioptres[index],
            found.gap_degrees[index],
            math.nan if value is None else value,
        )
        cells = ["" if math.isnan(number) else f"{number:.6g}" for number in numbers]
        lines.append(f"{time:.6f},{','.join(cells)},{state}")
    return write_bytes(path, ("\n".join(lines) + "\n").encode())


def write_pictures(study: Study, folder: Path) -> list[Path]:
    """Depth and vergence over time, and how often each vergence was."""
    times = study.fixation.times_seconds
    span = (float(times[0]), max(float(times[-1]), float(times[0]) + 1e-3))
    pictures = {
        "gaze.png": drawn([_panel(study, span, metres=True), _panel(study, span, metres=False)]),
        "histogram.png": drawn([_histogram(study)]),
    }
    return [write_png(folder / name, picture) for name, picture in pictures.items()]


def _panel(study: Study, span: tuple[float, float], *, metres: bool) -> Panel:
    found = study.fixation

    def shown(dioptres: Float) -> Float:
        return 1 / np.maximum(dioptres, 1 / (2 * FARTHEST_M)) if metres else dioptres

    raw = found.dioptres[found.good]
    top = float(np.percentile(shown(raw), 98)) * 1.15 if len(raw) else 2.0
    names = dict.fromkeys([study.chosen, "paper"])
    curves = [
        Curve(
            "raw", COLOURS[0], found.times_seconds, shown(found.dioptres), 1.0, LONGEST_STEP_SECONDS
        )
    ]
    for name, colour in zip(names, (COLOURS[1], COLOURS[2]), strict=False):
        out = study.series[name]
        curves.append(Curve(_words(name), colour, out.times_seconds, shown(_known(out)), 1.8))
    return Panel(
        "Depth of fixation" if metres else "Vergence: noise is symmetric here",
        "time, s",
        "depth, m" if metres else "vergence, dioptres",
        span,
        (0.0, min(top, FARTHEST_M) if metres else top),
        curves,
        spans=_shaded(study),
    )


def _words(name: str) -> str:
    return {"paper": "mean of metres (paper)", "none": "unfiltered"}.get(name, name)


def _known(out: Smoothed) -> Float:
    age = out.times_seconds - out.last_good
    return np.where(age <= out.hold_seconds, out.dioptres, np.nan)


def _shaded(study: Study) -> list[Spans]:
    times, bad = study.fixation.times_seconds, ~study.fixation.good
    edges = np.diff(np.concatenate([[0], bad.astype(np.int8), [0]]))
    starts, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    runs = np.stack([times[starts], times[np.minimum(ends, len(times) - 1)]], axis=1)
    return [
        Spans("rejected", SHADES["rejected"], runs),
        Spans("blink", SHADES["blink"], study.blinks),
    ]


def _histogram(study: Study) -> Panel:
    raw = study.fixation.dioptres[study.fixation.good]
    top = float(np.percentile(raw, 99)) * 1.1 if len(raw) else 1.0
    edges = np.linspace(0, max(top, 0.1), 61)
    bars = [_bars("raw", COLOURS[0], edges, raw)]
    for name, colour in zip(dict.fromkeys([study.chosen, "paper"]), COLOURS[1:], strict=False):
        known = _known(study.series[name])
        bars.append(_bars(_words(name), colour, edges, known[np.isfinite(known)]))
    highest = max([float(entry.shares.max()) for entry in bars] + [0.01])
    return Panel(
        "How often each vergence was",
        "vergence, dioptres",
        "share of the samples, %",
        (0.0, float(edges[-1])),
        (0.0, highest * 1.1),
        bars=bars,
    )


def _bars(name: str, colour: tuple[int, int, int], edges: Float, values: Float) -> Bars:
    counts = np.histogram(values, edges)[0]
    return Bars(name, colour, edges, 100 * counts / max(len(values), 1))
