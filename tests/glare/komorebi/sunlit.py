"""A canopy with gaps of one size, and the sun behind it."""

import numpy as np

from andon.glare.calibration import projected
from andon.glare.komorebi import Komorebi, Sun, canopy_of_mask
from andon.lamps.flicker import Flicker

__all__ = ["VIEW", "komorebi"]

VIEW = projected("pinhole", 40.0, 160, 100)


def komorebi(size=2, count=12, seed=3, exposure=0.0, z=1.8, **sun):
    mask = np.zeros(VIEW.shape, bool)
    places = [(12 + 34 * (n % 4), 14 + 30 * (n // 4)) for n in range(count)]
    for x, y in places:
        mask[y : y + size, x : x + size] = True
    canopy = canopy_of_mask(mask, VIEW)
    return Komorebi(canopy, Sun(**sun), Flicker(seed, z, 6.0, count), exposure_seconds=exposure)
