"""The camera's white, as lit shades show it.

What a lamp adds to surfaces is known as a ratio to E0, and the photograph carries the rest. A shade
shines by itself: how bright it is in the picture depends on what luminance the camera calls white,
which the photograph without the lamp does not tell, and the reference with it does.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from andon.calibrate.lamps.measures import encoded
from andon.pipeline import Frame

__all__ = ["white_of_shades"]

Float = NDArray[np.float64]

# Fewer pixels are a rim, and dimmer ones than this share of the brightest no shade.
LEAST_PIXELS, LEAST_SHARE = 16, 0.05
# Powers of e in which the white is searched, and the steps of both searches: 0.1, then 0.002.
WIDEST, STEPS, FINER_STEPS = 7.0, 141, 101


def white_of_shades(frame: Frame, wanted: Float, seen: NDArray[np.bool_], /) -> float | None:
    """cd/m² of the linear value 1 with which real shades look most as the reference shows them.

    By the least square of encoded values, clipped as the camera clips. None where too little of a
    shade is seen.

    Parameters
    ----------
    frame : with the fitted lamps.
    wanted : (H, W, 3) linear camera values of the reference.
    seen : (H, W) pixels that it shows.
    """
    light = frame.surface.shell_cd_m2
    if light is None:
        return None
    white, level = frame.captured.luminance_per_unit, light.max(axis=-1)
    looked = seen & (level > LEAST_SHARE * max(float(level.max()), 1e-30))
    if np.count_nonzero(looked) < LEAST_PIXELS:
        return None
    own = light[looked] / white
    beside = np.asarray(frame.luminance.cd_m2, np.float64)[looked] / white - own
    codes, response = encoded(wanted[looked], frame.captured.response), frame.captured.response

    def error(power: float) -> float:
        return float(((encoded(beside + np.exp(power) * own, response) - codes) ** 2).mean())

    step = 2 * WIDEST / (STEPS - 1)
    coarse = _least(error, 0.0, WIDEST, STEPS)
    return white / float(np.exp(_least(error, coarse, step, FINER_STEPS)))


def _least(error: Callable[[float], float], middle: float, reach: float, steps: int) -> float:
    """Where `error` is least of so many steps around `middle`."""
    powers: list[float] = np.linspace(middle - reach, middle + reach, steps).tolist()
    return min(powers, key=error)
