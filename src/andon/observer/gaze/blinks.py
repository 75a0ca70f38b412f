"""Blinks: both eyes are shut for a while, and not for long."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["LONGEST_SECONDS", "SHORTEST_SECONDS", "blink_intervals", "inside"]

Float = NDArray[np.float64]
Mask = NDArray[np.bool_]

# Shorter is a lost image, longer is closed eyes or a tracker that has lost them.
SHORTEST_SECONDS, LONGEST_SECONDS = 0.05, 0.5


def blink_intervals(
    times_seconds: Float,
    shut: Mask,
    /,
    *,
    shortest_seconds: float = SHORTEST_SECONDS,
    longest_seconds: float = LONGEST_SECONDS,
) -> Float:
    """(k, 2) first and last sample of each blink, in seconds.

    ::

        shut   ──┐  ┌──────┐ ┌─┐      a run of shut samples lasts from its first sample to the
        open     └──┘      └─┘ └──    first open one; the last run ends with the recording

    Parameters
    ----------
    times_seconds : (n,) rising.
    shut : (n,) neither eye is seen.
    shortest_seconds, longest_seconds : runs outside are no blinks.
    """
    edges = np.diff(np.concatenate([[0], shut.astype(np.int8), [0]]))
    starts, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    if not len(starts):
        return np.zeros((0, 2))
    opened = times_seconds[np.minimum(ends, len(times_seconds) - 1)]
    lasts = opened - times_seconds[starts]
    found = (lasts >= shortest_seconds) & (lasts <= longest_seconds)
    return np.stack([times_seconds[starts], times_seconds[ends - 1]], axis=1)[found]


def inside(times_seconds: Float, intervals: Float, /) -> Mask:
    """(n,) whether a time lies in one of the (k, 2) intervals, ends included."""
    if not len(intervals):
        return np.zeros(len(times_seconds), bool)
    at = np.searchsorted(intervals[:, 0], times_seconds, side="right") - 1
    return (at >= 0) & (times_seconds <= intervals[np.maximum(at, 0), 1])
