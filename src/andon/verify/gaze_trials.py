"""Eyes that are made up: where they look is known, so lag and noise of a filter can be measured."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

import numpy as np
from numpy.typing import NDArray

from andon.files.gaze import GazeRecording
from andon.observer.gaze import FILTERS, Smoother, make_filter, smoothed
from andon.observer.gaze.fixation import fixations
from andon.observer.model import Fixation

__all__ = [
    "RATE_HZ",
    "eyes_on",
    "faulty_outputs",
    "noisy_rest",
    "ramp_lag",
    "rest_figures",
    "step_seconds",
]

Float = NDArray[np.float64]

RATE_HZ = 30.0  # of the paper's tracker
INTERPUPILLARY_M = 0.063
NOISE_DEGREES = 0.5
# The paper's own two distances from the eye: the ball's centre and the plane behind it.
NEAR_M, FAR_M = 0.4, 0.6


def eyes_on(times_seconds: Float, points_m: Float, noise_degrees: float = 0.0) -> GazeRecording:
    """Both eyes on (n, 3) points, x right, y up, z ahead, the middle between the eyes at 0.

    `noise_degrees` is the standard deviation of the angle *between* the rays; each eye has 1/√2 of
    it, across and up, independently, seed 5.
    """
    origins = np.zeros((len(times_seconds), 2, 3))
    origins[:, :, 0] = INTERPUPILLARY_M * np.array([-0.5, 0.5])
    rays = points_m[:, None] - origins
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    if noise_degrees:
        each = np.radians(noise_degrees) / np.sqrt(2)
        off = np.random.default_rng(5).normal(0, each, (len(times_seconds), 2, 2))
        rays[..., :2] += off
        rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    return GazeRecording(times_seconds, origins, rays, np.ones(len(times_seconds)))


def straight_ahead(distance_m: Float) -> Float:
    """(n, 3) points."""
    return np.stack([np.zeros_like(distance_m)] * 2 + [distance_m], axis=1)


@cache
def noisy_rest(distance_m: float) -> Fixation:
    """60 s at 30 Hz of eyes that rest on a distance, with 0.5° of noise."""
    times = np.arange(60 * RATE_HZ) / RATE_HZ
    points = straight_ahead(np.full(len(times), distance_m))
    return fixations(eyes_on(times, points, NOISE_DEGREES))


def rest_figures(name: str, distance_m: float) -> tuple[float, float]:
    """RMS about its mean in dioptres of a filter's output at rest, and the mean minus the truth."""
    found = noisy_rest(distance_m)
    out = smoothed(found.times_seconds, found.dioptres, make_filter(name)).dioptres
    settled = out[found.times_seconds > 2]
    return float(settled.std()), float(settled.mean() - 1 / distance_m)


def step_seconds(
    name: str, share: float, before_m: float = NEAR_M, after_m: float = FAR_M
) -> float:
    """From the first sample after a jump of the gaze until `share` of it is crossed, in dioptres.

    Between samples by a straight line; 0 where the first sample is already beyond.
    """
    times = np.arange(-60, 91) / RATE_HZ
    dioptres = np.where(times < 0, 1 / before_m, 1 / after_m)
    out = smoothed(times, dioptres, make_filter(name)).dioptres
    way = (out - 1 / before_m) / (1 / after_m - 1 / before_m)
    after = times >= 0
    crossed = int(np.argmax(after & (way >= share - 1e-12)))
    if crossed == int(np.argmax(after)):
        return 0.0
    part = (share - way[crossed - 1]) / (way[crossed] - way[crossed - 1])
    return float(times[crossed - 1] + part * (times[crossed] - times[crossed - 1]))


def ramp_lag(name: str) -> float:
    """How late a filter's output is on a gaze that draws near steadily, in seconds.

    0.1 m/s in metres for the filter that works in metres, 0.25 D/s for the others.
    """
    times = np.arange(0, 301) / RATE_HZ
    if name == "paper":
        out = 1 / smoothed(times, 1 / (2 - 0.1 * times), make_filter(name)).dioptres
        return float(times[-1] - (2 - out[-1]) / 0.1)
    out = smoothed(times, 0.5 + 0.25 * times, make_filter(name)).dioptres
    return float(times[-1] - (out[-1] - 0.5) / 0.25)


def faulty_outputs() -> Iterator[Float]:
    """What every filter says of every fault, at samples and between them."""
    for rate_hz in (7.0, 30.0, 200.0, 1000.0):
        for times, recording in _faults(rate_hz):
            found = fixations(recording)
            for name in FILTERS:
                one = Smoother(make_filter(name))
                said: list[float] = []
                for time, value in zip(times.tolist(), found.dioptres.tolist(), strict=True):
                    said.append(one.push(time, value))
                    dioptres = one.at(time + 0.3 / rate_hz)[0]
                    said.append(one.dioptres if dioptres is None else dioptres)
                yield np.array(said)


def _faults(rate_hz: float) -> Iterator[tuple[Float, GazeRecording]]:
    """(times as they come in, 4 s of eyes on 0.7 m) for each way in which a tracker fails."""
    times = np.arange(round(4 * rate_hz)) / rate_hz
    count = len(times)
    sound = eyes_on(times, straight_ahead(np.full(count, 0.7)), NOISE_DEGREES)
    generator = np.random.default_rng(9)
    blink = (times % 1.0) < 0.2
    kinds: dict[str, NDArray[np.bool_]] = {
        "blinks": np.repeat(blink[:, None], 2, axis=1),
        "one eye": np.stack([times > 2, np.zeros(count, bool)], axis=1),
        "bursts": generator.random((count, 2)) < 0.5,
        "nothing": np.ones((count, 2), bool),
    }
    for gone in kinds.values():
        yield times, _with(sound, np.where(gone[..., None], np.nan, sound.directions))
    ahead = np.zeros_like(sound.directions)
    ahead[..., 2] = 1.0
    yield times, _with(sound, np.where(blink[:, None, None], ahead, sound.directions))
    yield times, _with(sound, sound.directions * generator.choice([1.0, -1.0], (count, 1, 1)))
    jumps = times.copy()
    jumps[count // 4] -= 0.5
    jumps[count // 2 :] -= 3.0
    jumps[3 * count // 4 :] += 10.0
    jumps[-1] = np.nan
    yield jumps, sound


def _with(sound: GazeRecording, directions: Float) -> GazeRecording:
    return GazeRecording(sound.times_seconds, sound.origins_m, directions, sound.confidence)
