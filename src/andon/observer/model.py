"""What is known of where somebody looks."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from andon.files.gaze import DistanceRecording, GazeRecording

__all__ = ["DistanceRecording", "Fixation", "GazeRecording", "GazeState"]

Float = NDArray[np.float64]
# A fixation that is measured; the last good one; none, so that the surface is looked at.
GazeState = Literal["seen", "held", "fallback"]


@dataclass(frozen=True, eq=False)
class Fixation:
    """Where both eyes look: vergences in dioptres, a series of them.

    Attributes
    ----------
    times_seconds : (n,)
    dioptres : (n,) 1/distance from the point between the eyes; NaN where `good` is False.
    gap_degrees : (n,) how much the rays miss each other, seen from the eyes; NaN: no rays.
    good : (n,) bool: not a blink, not diverging, both eyes, confident, small gap.
    rejected : reason → number of samples; each rejected sample has one reason, the first of
        `andon.observer.gaze.REASONS` that holds.
    """

    times_seconds: Float
    dioptres: Float
    gap_degrees: Float
    good: NDArray[np.bool_]
    rejected: dict[str, int] = field(default_factory=dict[str, int])
