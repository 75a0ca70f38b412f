"""How still and how late a smoothed gaze is."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from andon.observer.model import GazeRecording

__all__ = ["jitter_dioptres", "lag_seconds", "rests", "thinned"]

Float = NDArray[np.float64]

# Dispersion and length of a fixation, as Salvucci & Goldberg 2000 suggest for I-DT (½° to 1°,
# 100 to 200 ms).
REST_DEGREES, REST_SECONDS = 1.0, 0.2
LONGEST_LAG_SECONDS = 1.0


def rests(recording: GazeRecording, good: NDArray[np.bool_], /) -> Float:
    """(k, 2) first and last time of each span in which both eyes rest on one direction.

    By dispersion (Salvucci & Goldberg 2000, I-DT): longest spans of good samples in which the
    middle of both directions moves by at most 1° across and up together, for at least 0.2 s. The
    vergence plays no part in it, so its noise can be measured there.
    """
    ahead = recording.directions.mean(axis=1)
    angles = np.degrees(
        np.stack(
            [
                np.arctan2(ahead[:, 0], ahead[:, 2]),
                np.arctan2(ahead[:, 1], np.hypot(ahead[:, 0], ahead[:, 2])),
            ],
            axis=1,
        )
    )
    times = recording.times_seconds
    found: list[tuple[float, float]] = []
    start: int | None = None
    low = high = np.zeros(2)
    for index, (angle, fits) in enumerate(zip(angles, good.tolist(), strict=True)):
        if start is not None:
            low, high = np.minimum(low, angle), np.maximum(high, angle)
            fits_span = fits and float((high - low).sum()) <= REST_DEGREES
            if fits_span:
                continue
            if times[index - 1] - times[start] >= REST_SECONDS:
                found.append((float(times[start]), float(times[index - 1])))
        start, low, high = (index if fits else None), angle, angle
    if start is not None and times[-1] - times[start] >= REST_SECONDS:
        found.append((float(times[start]), float(times[-1])))
    return np.array(found, np.float64).reshape(-1, 2)


def jitter_dioptres(times_seconds: Float, dioptres: Float, spans: Float, /) -> float:
    """RMS of (n,) vergences about their mean in each of (k, 2) spans; NaN where there is none."""
    squares, count = 0.0, 0
    for first, last in spans.tolist():
        part = dioptres[(times_seconds >= first) & (times_seconds <= last)]
        part = part[np.isfinite(part)]
        if len(part) > 1:
            squares += float(((part - part.mean()) ** 2).sum())
            count += len(part)
    return math.sqrt(squares / count) if count else math.nan


def lag_seconds(times_seconds: Float, dioptres: Float, smooth: Float, /) -> float:
    """By how much `smooth` (n,) trails `dioptres` (n,), its input, where the input is finite.

    The shift, 0…1 s, at which the two differ least in RMS, on a grid of the median interval and
    between its points by a parabola.
    """
    fine = np.isfinite(dioptres)
    if fine.sum() < 3:
        return math.nan
    step = float(np.median(np.diff(times_seconds)))
    grid = np.arange(times_seconds[fine][0], times_seconds[-1] - LONGEST_LAG_SECONDS, step)
    # Where a sample before or after is missing there is nothing to trail.
    grid = grid[np.interp(grid, times_seconds, fine.astype(float)) == 1]
    if len(grid) < 3:
        return math.nan
    raw = np.interp(grid, times_seconds[fine], dioptres[fine])
    shifts = np.arange(0.0, LONGEST_LAG_SECONDS, step)
    errors = [
        float(np.mean((np.interp(grid + shift, times_seconds, smooth) - raw) ** 2))
        for shift in shifts
    ]
    at = int(np.argmin(errors))
    if not 0 < at < len(errors) - 1:
        return float(shifts[at])
    before, here, after = errors[at - 1 : at + 2]
    bend = before - 2 * here + after
    return float(shifts[at]) + (step * 0.5 * (before - after) / bend if bend > 0 else 0.0)


def thinned(recording: GazeRecording, rate_hz: float, /) -> GazeRecording:
    """The recording as a slower tracker would give it: the last sample before each tick."""
    times = recording.times_seconds
    if len(times) < 2 or 1 / rate_hz <= np.diff(times).min():
        return recording  # it is no faster
    ticks = np.arange(times[0], times[-1], 1 / rate_hz)
    keep = np.unique(np.searchsorted(times, ticks, side="right") - 1)
    return GazeRecording(
        times[keep],
        recording.origins_m[keep],
        recording.directions[keep],
        recording.confidence[keep],
        recording.dropped,
    )
