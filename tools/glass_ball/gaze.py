"""A recording of two eyes that read the label, then look through the glass, then read again."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["RATE_HZ", "SECONDS", "gaze_rows"]

Float = NDArray[np.float64]

# The paper's camera and its rate.
RATE_HZ = 30.0
SECONDS = 5.0
# What is looked at from when on, metres away: the label, the board, the label.
LOOKS = ((0.0, 0.325), (1.6, 0.6), (3.4, 0.325))
# Vergence follows with this time constant (its movements last 0.3 to 0.5 s), saccades with the
# next sample.
VERGENCE_SECONDS = 0.12
# Of fixations, and how far they lie apart sideways, degrees of the eyes.
FIXATION_SECONDS = 0.27
READING_DEGREES = (5.0, 1.5)
# Noise from sample to sample of each eye, degrees: head-worn trackers reach 0.1 to 0.2.
NOISE_DEGREES = 0.15
BLINK = (2.45, 2.67)
SEED = 30


def gaze_rows(interpupillary_m: float) -> tuple[tuple[str, ...], list[str]]:
    """Names and lines of a table of eye rays: docs/gaze.md. x right, y down, z forward."""
    random = np.random.default_rng(SEED)
    times = np.arange(round(RATE_HZ * SECONDS)) / RATE_HZ
    targets = _targets(times, random)
    names = ["time_seconds", "confidence"]
    columns: list[Float] = []
    for eye, side in (("left", -0.5), ("right", 0.5)):
        origin = np.array([side * interpupillary_m, 0.0, 0.0])
        way = targets - origin
        way /= np.linalg.norm(way, axis=1, keepdims=True)
        way = way + random.normal(0, np.radians(NOISE_DEGREES), way.shape)
        way /= np.linalg.norm(way, axis=1, keepdims=True)
        columns += [np.broadcast_to(origin, way.shape), way]
        names += [f"{eye}_origin_{axis}_m" for axis in "xyz"]
        names += [f"{eye}_direction_{axis}" for axis in "xyz"]
    rays = np.concatenate(columns, axis=1)
    confidence = np.clip(random.normal(0.93, 0.03, len(times)), 0, 1)
    lines = [
        _line(time, sure, row) for time, sure, row in zip(times, confidence, rays, strict=True)
    ]
    return tuple(names), lines


def _line(time: float, sure: float, row: Float) -> str:
    if BLINK[0] <= time <= BLINK[1]:
        return f"{time:.4f},0.00" + "," * len(row)
    # Lids that close and open hide some of the pupil.
    near = min(abs(time - BLINK[0]), abs(time - BLINK[1])) < 1.5 / RATE_HZ
    cells = [f"{time:.4f}", f"{sure - 0.5 * near:.2f}", *(f"{value:.5f}" for value in row)]
    return ",".join(cells)


def _targets(times: Float, random: np.random.Generator) -> Float:
    """(n, 3) metres, from between the eyes: fixations side by side, at the depth of the time."""
    wanted = np.zeros(len(times))
    for start, distance in LOOKS:
        wanted[times >= start] = 1 / distance
    dioptres = np.empty_like(wanted)
    now = wanted[0]
    for index, goal in enumerate(wanted):
        now += (goal - now) * (1 - np.exp(-1 / (RATE_HZ * VERGENCE_SECONDS)))
        dioptres[index] = now
    count = int(times[-1] / FIXATION_SECONDS) + 1
    places = np.radians(random.normal(0, 0.5, (count, 2)) * READING_DEGREES)
    angles = places[(times / FIXATION_SECONDS).astype(int)]
    distance = 1 / dioptres
    return np.concatenate([np.tan(angles), np.ones((len(times), 1))], axis=1) * distance[:, None]
