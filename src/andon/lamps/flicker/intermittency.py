"""The intermittent map S ← (S + S^z + noise) mod 1, the same on every machine.

A chaotic orbit doubles an error of the last bit until it is all of it, so "the same seed, the same
light" needs arithmetic that is the same to the last bit. Sums, products and integers are; powers
are not. S^z is read from a table of float32, between whose values lines run: 1e-5 off the power.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

__all__ = ["NOISE", "iterate", "uniform"]

Float = NDArray[np.float64]
Words = NDArray[np.uint64]

# Uniform on [0, this): far below what shapes the spectrum within 1e-4…1e-2 per iteration, and
# thousands of times the last bit of a state near 1, so that no orbit closes.
NOISE = 1e-12

# Segments of the table: 2⁷ to each power of two, down to 2⁻⁶⁴, whose powers are below any noise.
MANTISSA_BITS, SMALLEST_EXPONENT = 7, -64
_SHIFT = 52 - MANTISSA_BITS
_FIRST = (SMALLEST_EXPONENT + 1023) << MANTISSA_BITS


def iterate(states: Float, z: float, noise: Float, /) -> Float:
    """(k, n) the states after each of k iterations from `states` (n,), with `noise` (k, n)."""
    table, slope, start = _power_table(z)
    found = np.empty_like(noise)
    for k, added in enumerate(noise):
        segment = np.maximum((states.view(np.int64) >> _SHIFT) - _FIRST, 0)
        power = table[segment] + slope[segment] * (states - start[segment])
        states = states + power + added
        states -= np.floor(states)
        found[k] = states
    return found


@lru_cache(maxsize=64)
def _power_table(z: float) -> tuple[Float, Float, Float]:
    """S^z at the start of each segment of [2^SMALLEST_EXPONENT, 2), slopes, and the starts."""
    count = (1 - SMALLEST_EXPONENT) << MANTISSA_BITS
    bits = (np.arange(count + 1, dtype=np.int64) + _FIRST) << _SHIFT
    start = bits.view(np.float64).copy()
    start[0] = 0  # what is smaller than the table lies on its first line
    # Rounded to float32, so that the last bit of the power, which is not the same everywhere,
    # is gone.
    value = np.asarray(np.asarray(start**z, np.float32), np.float64)
    return value[:-1], np.diff(value) / np.diff(start), start[:-1]


def uniform(seed: int, streams: Words, indices: Words, /) -> Float:
    """(k, n) uniform on [0, 1): for each of `indices` (k,) and `streams` (n,), without any order.

    SplitMix64's mixing function over words that no two (seed, stream, index) share.
    """
    key = _mixed(_mixed(np.uint64(seed % 2**64)) ^ streams)
    # 11 bits go, 53 stay: what a float64 holds.
    words = _mixed(key[None, :] + indices[:, None] * _GOLDEN) >> np.uint64(11)
    return np.asarray(words, np.float64) * 2.0**-53


_GOLDEN = np.uint64(0x9E3779B97F4A7C15)


def _mixed(word: Words | np.uint64) -> Words:
    with np.errstate(over="ignore"):  # modulo 2⁶⁴ is meant
        word = np.asarray(word, np.uint64) + _GOLDEN
        word = (word ^ (word >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        word = (word ^ (word >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        return word ^ (word >> np.uint64(31))
