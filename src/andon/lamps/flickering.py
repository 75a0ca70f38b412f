"""By how much the flicker of a scene file changes a lamp, at one moment."""

from __future__ import annotations

from functools import lru_cache
from hashlib import blake2b
from typing import TYPE_CHECKING

import numpy as np

from andon.files.cached import read_cached
from andon.lamps.flicker import Flicker
from andon.lamps.flicker.gaps import read_gaps

if TYPE_CHECKING:
    from andon.scene import Scene
    from andon.scene.lamp_base import LampTable

__all__ = ["flicker_factor"]

# Flickers whose orbits go on from where a frame left them.
KEPT = 64


def flicker_factor(scene: Scene, place: str, table: LampTable, time_seconds: float, /) -> float:
    """What the lamp's light is times its mean: 1 without flicker, of mean 1 over all time.

    The mean over one frame of `scene.frames_per_second`, so that iterations between frames do not
    alias. `place` is the table's name in messages.
    """
    flicker = table.flicker
    if flicker is None or flicker.amount == 0:
        return 1.0
    weights = np.full(flicker.gaps, 1 / flicker.gaps)
    if flicker.mask is not None:
        pixels = read_cached(read_gaps, scene.path(flicker.mask, f"{place}.flicker.mask")).pixels
        weights = pixels / pixels.sum()
    seed = flicker.seed
    if seed is None:
        own = f"{scene.scene.seed}:{table.name}".encode()
        seed = int.from_bytes(blake2b(own, digest_size=7).digest())
    each = _flicker(seed, flicker.exponent, flicker.steps_per_second, len(weights))
    swing = each.at(time_seconds, exposure_seconds=1 / scene.scene.frames_per_second)
    return float(1 + flicker.amount * (weights @ swing - 1))


@lru_cache(maxsize=KEPT)
def _flicker(seed: int, z: float, iterations_per_second: float, streams: int) -> Flicker:
    return Flicker(seed, z, iterations_per_second, streams)
