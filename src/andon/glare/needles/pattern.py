"""The random numbers of an eye, drawn once: they do not change with source, light or time.

Needle i of an eye exists with the weight ``clamp(number − i, 0, 1)``, so a number that changes
fades the last needle in or out and leaves the others where they are. For that every *first* n of
them must be spread over the circle: their azimuths are van der Corput's sequence, scrambled after
Owen. Of the first 2ᵏ one lies in each 2ᵏ-th of the circle, anywhere in it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from andon.glare.needles.model import Which

__all__ = ["Pattern", "pattern_of"]

Float = NDArray[np.float64]
_EYES: dict[Which, int] = {"mono": 0, "left": 1, "right": 2}
# Standard deviation of the logarithm of widths and of strengths.
WIDTH_SPREAD, STRENGTH_SPREAD = 0.35, 0.4
# Of |g|: what is shorter would be a dot at the outline.
SHORTEST = 0.05


@dataclass(frozen=True, eq=False)
class Pattern:
    """An eye's needles.

    Attributes
    ----------
    number : g of the number, a standard normal variate.
    turn : (n,) azimuth in turns, 0…1, uniform and stratified.
    length : (n,) |g|, half-normal, at least `SHORTEST`.
    width : (n,) factor of the width, median 1.
    strength : (n,) share of the light of all n, sums to 1: longer ones have more.
    """

    number: float
    turn: Float
    length: Float
    width: Float
    strength: Float


@lru_cache(maxsize=64)
def pattern_of(seed: int, which: Which, most: int) -> Pattern:
    """The `most` (a power of two) needles of an eye; the same for the same arguments, always."""
    generator = np.random.default_rng((seed, _EYES[which]))
    number = float(generator.standard_normal())
    turn = _scrambled(most, generator)
    length, width, strength = generator.standard_normal((3, most))
    long = np.maximum(np.abs(length), SHORTEST)
    wide = np.exp(WIDTH_SPREAD * width)
    light = np.sqrt(long) * wide * np.exp(STRENGTH_SPREAD * strength)
    return Pattern(number, turn, long, wide, light / light.sum())


def _scrambled(count: int, generator: np.random.Generator) -> Float:
    """(count,) van der Corput's sequence in base 2 with random digits, Owen 1995.

    Each digit is flipped or not, by a coin of its own for each value of the digits before it.
    """
    index = np.arange(count)
    whole = np.zeros(count, int)
    for digit in range(count.bit_length() - 1):
        coins = generator.integers(0, 2, 1 << digit)
        whole = 2 * whole + (((index >> digit) & 1) ^ coins[whole])
    return (whole + generator.random(count)) / count
