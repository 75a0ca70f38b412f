"""What the eyes of a scene are adapted to; glass and glare ask for it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from andon.quantities import CameraFrame, photometric
from andon.scene import Scene

__all__ = ["adaptation_cd_m2"]

# Of the picture's white: what scenes without a photograph are taken to have in the mean.
GREY_WORLD = 0.18


def adaptation_cd_m2(
    scene: Scene, frames: Mapping[str, CameraFrame], dimming: NDArray[np.float64], /
) -> float:
    """Mean luminance in cd/m² of the dimmed photograph, without lamps; relative as the scene is."""
    if not scene.has_photograph:
        return GREY_WORLD * next(iter(frames.values())).luminance_per_unit
    means = [
        float(photometric(dimming * frame.linear.reshape(-1, 3).mean(axis=0)))
        * frame.luminance_per_unit
        for frame in frames.values()
    ]
    return float(np.mean(means))
