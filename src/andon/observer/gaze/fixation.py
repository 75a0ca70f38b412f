"""Where the rays of both eyes meet.

::

      left  o────────_____                 the fixation is the middle of the shortest segment
                          ─────*───          between the rays; `gap` is that segment's length
      between +        gap │   ┊             seen from the eyes, the vergence is 1/distance from
                          ─────*───          the point between them
      right o─────────────
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from andon.observer.gaze.blinks import blink_intervals, inside
from andon.observer.model import DistanceRecording, Fixation, GazeRecording

__all__ = ["NEAREST_M", "REASONS", "Meeting", "fixations", "meeting", "shut"]

Float = NDArray[np.float64]
Mask = NDArray[np.bool_]

# Why a sample is rejected, in the order in which it is asked.
REASONS = (
    "blink",
    "both eyes missing",
    "one eye missing",
    "low confidence",
    "diverging",
    "gap",
    "too near",
)
# Nobody's eyes converge on less; the near point of convergence is 5 to 10 cm.
NEAREST_M = 0.05
# |d1 × d2|² of rays that are parallel to the last digits of float64: they meet 10⁵ km away.
PARALLEL = 1e-24


class Meeting(NamedTuple):
    """Where two rays meet, of each of n pairs; NaN where a ray is missing or both are parallel.

    Attributes
    ----------
    points_m : (n, 3) middle of the shortest segment between the *lines*.
    along_m : (n, 2) how far along each ray; < 0: behind the eye.
    gap_m : (n,) length of the segment.
    """

    points_m: Float
    along_m: Float
    gap_m: Float


def meeting(origins_m: Float, directions: Float, /) -> Meeting:
    """Where the rays of (n, 2, 3) eyes meet; `directions` are unit vectors.

    By cross products, which keep their digits where the rays are nearly parallel; the usual form
    with 1 − (d1·d2)² has lost half of them at 2 m.
    """
    d1, d2 = directions[:, 0], directions[:, 1]
    across = np.cross(d1, d2)
    square = np.einsum("ni,ni->n", across, across)
    square = np.where(square > PARALLEL, square, np.nan)
    between = origins_m[:, 1] - origins_m[:, 0]
    along = np.stack(
        [np.einsum("ni,ni->n", np.cross(between, d), across) / square for d in (d2, d1)], axis=1
    )
    ends = origins_m + along[..., None] * directions
    gap = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=-1)
    return Meeting(ends.mean(axis=1), along, gap)


def shut(recording: GazeRecording | DistanceRecording, minimum_confidence: float = 0.6, /) -> Mask:
    """(n,) neither eye is seen, or what is seen is not trusted."""
    low = recording.confidence < minimum_confidence
    if isinstance(recording, DistanceRecording):
        return np.isnan(recording.dioptres) | low
    return np.isnan(recording.directions).any(axis=-1).all(axis=-1) | low


def fixations(
    recording: GazeRecording | DistanceRecording,
    /,
    *,
    minimum_confidence: float = 0.6,
    maximum_gap_degrees: float = 3.0,
) -> Fixation:
    """The vergence of each sample, or why there is none.

    A blink is known when it is over, but its samples are bad for themselves (missing or without
    confidence): what a live source rejects at once is what is rejected here. Eyes that look far
    away are parallel, and noise makes half of those samples diverge: they are rejected, so the mean
    of what is left lies too near, by 0.11 D for 0.5° of noise on a vergence of 0.

    Parameters
    ----------
    minimum_confidence : 0…1, samples below are rejected.
    maximum_gap_degrees : > 0, samples whose rays miss each other by more are.
    """
    if isinstance(recording, DistanceRecording):
        found, bad = _of_distances(recording)
        gap = np.full(len(found), np.nan)
    else:
        found, gap, bad = _of_rays(recording, maximum_gap_degrees)
    closed = shut(recording, minimum_confidence)
    bad["low confidence"] = recording.confidence < minimum_confidence
    bad["blink"] = closed & inside(
        recording.times_seconds, blink_intervals(recording.times_seconds, closed)
    )
    good = np.ones(len(found), bool)
    rejected: dict[str, int] = {}
    for reason in REASONS:
        why = bad.get(reason)
        if why is not None and (why & good).any():
            rejected[reason] = int((why & good).sum())
            good &= ~why
    return Fixation(recording.times_seconds, np.where(good, found, np.nan), gap, good, rejected)


def _of_distances(recording: DistanceRecording) -> tuple[Float, dict[str, Mask]]:
    found = recording.dioptres
    return found, {"both eyes missing": np.isnan(found), "too near": found > 1 / NEAREST_M}


def _of_rays(
    recording: GazeRecording, maximum_gap_degrees: float
) -> tuple[Float, Float, dict[str, Mask]]:
    left, right = (np.isnan(recording.directions[:, eye]).any(axis=-1) for eye in (0, 1))
    at = meeting(recording.origins_m, recording.directions)
    distance: Float = np.linalg.norm(at.points_m - recording.origins_m.mean(axis=1), axis=-1)
    gap: Float = np.degrees(np.arctan2(at.gap_m, distance))
    bad: dict[str, Any] = {
        "both eyes missing": left & right,
        "one eye missing": left | right,
        # Parallel rays have NaN here, which is not > 0 either.
        "diverging": ~((at.along_m[:, 0] > 0) & (at.along_m[:, 1] > 0)),
        "gap": gap > maximum_gap_degrees,
        "too near": distance < NEAREST_M,
    }
    with np.errstate(divide="ignore"):
        return 1 / distance, gap, bad
