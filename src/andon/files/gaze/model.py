"""What gaze files hold."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

__all__ = ["DistanceRecording", "GazeRecording", "PupilRecording"]

Float = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class GazeRecording:
    """Eye rays over time, in one frame of reference.

    Attributes
    ----------
    times_seconds : (n,) rising; from the first sample.
    origins_m : (n, 2, 3) centres of the left and the right eye; NaN: missing.
    directions : (n, 2, 3) unit; NaN: missing.
    confidence : (n,) 0…1; 1 where the file has none.
    dropped : reason → rows of the file that are no samples, such as repeated times.
    """

    times_seconds: Float
    origins_m: Float
    directions: Float
    confidence: Float
    dropped: dict[str, int] = field(default_factory=dict[str, int])


@dataclass(frozen=True, eq=False)
class DistanceRecording:
    """A distance of fixation over time, of a tracker that keeps its rays to itself.

    Attributes
    ----------
    times_seconds : (n,) rising; from the first sample.
    dioptres : (n,) 1/distance from the point between the eyes, ≥ 0; NaN: missing.
    confidence : (n,) 0…1; 1 where the file has none.
    dropped : reason → rows of the file that are no samples.
    """

    times_seconds: Float
    dioptres: Float
    confidence: Float
    dropped: dict[str, int] = field(default_factory=dict[str, int])


@dataclass(frozen=True, eq=False)
class PupilRecording:
    """Pupils over time, and where on a screen each eye looks: no rays, so no fixation.

    Attributes
    ----------
    times_seconds : (n,) rising; from the start of the recording.
    gaze_px : (n, 2, 2) x, y on the screen of the left and the right eye; NaN: missing.
    pupils : (n, 2) in the tracker's own unit, ≥ 0; NaN: missing; trackers say 0 for a closed eye.
    unit : what `pupils` is of: ``area`` or ``diameter``, "" where the file does not say.
    blinks : (eye, start, end) that the tracker found: ``left`` or ``right``, seconds.
    dropped : reason → lines of the file that are no samples.
    """

    times_seconds: Float
    gaze_px: Float
    pupils: Float
    unit: Literal["area", "diameter", ""] = ""
    blinks: tuple[tuple[Literal["left", "right"], float, float], ...] = ()
    dropped: dict[str, int] = field(default_factory=dict[str, int])
