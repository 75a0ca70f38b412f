"""What is known of where somebody looks."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

__all__ = ["Fixation", "GazeRecording"]

Float = NDArray[np.float64]


@dataclass(frozen=True)
class GazeRecording:
    """Eye rays over time, in one frame of reference.

    Attributes
    ----------
    times_seconds : (n,) rising; from the first sample.
    origins_m : (n, 2, 3) centres of the left and the right eye; NaN: missing.
    directions : (n, 2, 3) unit; NaN: missing.
    confidence : (n,) 0…1; 1 where the file has none.
    """

    times_seconds: Float
    origins_m: Float
    directions: Float
    confidence: Float


@dataclass(frozen=True)
class Fixation:
    """Where both eyes look: vergences in dioptres, a series of them.

    Attributes
    ----------
    times_seconds : (n,)
    dioptres : (n,) 1/distance from the point between the eyes; NaN where `good` is False.
    gap_degrees : (n,) how much the rays miss each other, seen from the eyes.
    good : (n,) bool: not a blink, not diverging, both eyes, confident, small gap.
    rejected : reason → number of samples.
    """

    times_seconds: Float
    dioptres: Float
    gap_degrees: Float
    good: NDArray[np.bool_]
    rejected: dict[str, int] = field(default_factory=dict[str, int])
