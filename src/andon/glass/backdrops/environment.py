"""What surrounds a body: harmonics of the light that a ray finds where it hits nothing."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from andon.harmonics import basis
from andon.lamps import HemisphereLamp, Lamp, SkyLamp

__all__ = ["environment_of"]

Float = NDArray[np.float64]

# Y00.
FIRST = 0.5 / np.sqrt(np.pi)


def environment_of(ambient_lux: ArrayLike, lamps: Iterable[Lamp] = (), /) -> Float:
    """(9, 3) harmonics in cd/m² of `ambient_lux` (3,) from all sides, and of skies in `lamps`.

    `ambient_lux` is what is left of E0 after dimming, in lx; it stands for a luminance of E0/π in
    every direction. Of a sky of luminance E/π above the horizon bands 0 and 1 are exact (band 2 is
    0), so its edge is lost: the light falls off with the height, a quarter too bright at the zenith
    of a lone sky (5/4 instead of 1). Other lamps are highlights, no environment.
    """
    found = np.zeros((9, 3))
    found[0] = np.asarray(ambient_lux, np.float64) / np.pi / FIRST
    for lamp in lamps:
        if isinstance(lamp, SkyLamp):
            sky, ground = np.asarray(lamp.illuminance_lux), np.zeros(3)
        elif isinstance(lamp, HemisphereLamp):
            sky, ground = lamp.sky_illuminance_lux, lamp.ground_illuminance_lux
        else:
            continue
        # ∫ over the upper half: 2π·Y00 of band 0, π·√(3/4π)·up of band 1; times E/π.
        found[0] += 2 * FIRST * (sky + ground)
        found[1:4] += basis(lamp.up)[1:4, None] * (sky - ground)
    return found
