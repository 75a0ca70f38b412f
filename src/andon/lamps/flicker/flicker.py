"""S(t): independent flickers that can be asked for any time, in any order."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from andon.errors import InputError
from andon.lamps.flicker.density import invariant_density
from andon.lamps.flicker.intermittency import NOISE, iterate, uniform

__all__ = ["Flicker"]

Float = NDArray[np.float64]
Indices = NDArray[np.int64]

# Iterations that go on from one another. At 30 a second 2.4 hours, and two seconds of work for
# whoever asks for their end first.
BLOCK = 1 << 18
# Iterations that are made at once; between them the states are kept.
CHUNK = 256
# Numbers of whole chunks that are kept.
MOST_KEPT = 1 << 21
# An exposure of more iterations is a mistyped number.
LONGEST_EXPOSURE = 10_000
# Times farther off would need more bits than float64 has for parts of an iteration.
MOST_ITERATIONS = 2**40


@dataclass(frozen=True, eq=False)
class Flicker:
    """`streams` independent S(t) of one kind.

    Attributes
    ----------
    seed : the same seed is the same light; stream i does not depend on how many there are.
    z : exponent of the map, 1 < z < 2; 1/f-like above 1.5.
    iterations_per_second : > 0.
    streams : ≥ 1.
    """

    seed: int = 0
    z: float = 1.8
    iterations_per_second: float = 30.0
    streams: int = 1
    _starts: dict[int, list[Float]] = field(init=False, repr=False, default_factory=dict)
    _chunks: dict[int, Float] = field(init=False, repr=False, default_factory=dict)

    def __post_init__(self) -> None:
        if not 1 < self.z < 2:
            raise InputError(f"must be > 1 and < 2, got {self.z:g}", field="flicker.z")
        if not 0 < self.iterations_per_second < np.inf:
            raise InputError(
                f"must be > 0, got {self.iterations_per_second:g}",
                field="flicker.iterations_per_second",
            )
        if self.streams < 1:
            raise InputError(f"must be ≥ 1, got {self.streams}", field="flicker.streams")

    @property
    def mean(self) -> float:
        """⟨S⟩ over all time, 0…1."""
        return invariant_density(self.z).mean

    def at(self, times_seconds: ArrayLike, /, *, exposure_seconds: float = 0.0) -> Float:
        """(streams, ...) S/⟨S⟩ at `times_seconds` (...): ≥ 0, of mean 1 over all time.

        With `exposure_seconds` > 0 the mean over that long, the time in its middle: without it
        pictures that are fewer a second than iterations would alias.
        Raises `InputError` for times that are not finite or too far off.
        """
        return self.open_share(times_seconds, exposure_seconds=exposure_seconds) / self.mean

    def open_share(self, times_seconds: ArrayLike, /, *, exposure_seconds: float = 0.0) -> Float:
        """(streams, ...) S itself, 0…1, of mean `mean`; else as `at`."""
        steps = np.asarray(times_seconds, np.float64) * self.iterations_per_second
        half = exposure_seconds * self.iterations_per_second / 2
        if not 0 <= half <= LONGEST_EXPOSURE / 2:
            rule = f"must be ≥ 0 and at most {LONGEST_EXPOSURE} iterations"
            raise InputError(f"{rule}, got {exposure_seconds:g} s", field="exposure_seconds")
        if not np.all(np.abs(steps) < MOST_ITERATIONS):
            raise InputError(
                f"must be finite and less than {MOST_ITERATIONS} iterations from 0",
                field="times_seconds",
            )
        first = np.floor(steps - half).astype(np.int64) - 1
        indices = first[..., None] + np.arange(4 + int(np.ceil(2 * half)))
        apart = steps[..., None] - indices
        weights = _bump(apart) if half == 0 else _windowed(apart, half)
        return np.einsum("...k,s...k->s...", weights, self.states(indices))

    def states(self, indices: Indices, /) -> Float:
        """(streams, ...) S after iteration numbers (...), of which 0 is that of time 0."""
        needed, place = np.unique(indices, return_inverse=True)
        states = np.empty((self.streams, len(needed)))
        chunks, starts = np.unique(needed // CHUNK, return_index=True)
        ends = np.append(starts, len(needed))[1:]
        for chunk, start, end in zip(chunks.tolist(), starts, ends, strict=True):
            states[:, start:end] = self._chunk(chunk)[needed[start:end] - chunk * CHUNK].T
        return states[:, place.reshape(indices.shape)]

    def _chunk(self, number: int) -> Float:
        """(CHUNK, streams) states from iteration number·CHUNK on."""
        if number not in self._chunks:
            # A chunk lies before time 0, for exposures that began before it.
            block, wanted = divmod(number + 1, BLOCK // CHUNK)
            starts = self._starts.setdefault(block, [self._start(block)])
            for made in range(min(wanted, len(starts) - 1), wanted + 1):
                this = number - wanted + made
                states = self._iterated(this, starts[made])
                if made == len(starts) - 1:
                    starts.append(states[-1])
                self._keep(this, states)
        return self._chunks[number]

    def _iterated(self, number: int, start: Float) -> Float:
        indices = np.arange(number * CHUNK, (number + 1) * CHUNK).astype(np.uint64)
        return iterate(start, self.z, NOISE * uniform(self.seed, self._names, indices))

    def _start(self, block: int) -> Float:
        """(streams,) before the first iteration of a block, as often where as the map is."""
        index = np.array([2**63 + block], np.uint64)  # no iteration has that number
        drawn = invariant_density(self.z).state(uniform(self.seed, self._names, index)[0])
        # The density is solved for, and not to the last bit the same everywhere.
        return np.rint(drawn * 2**24) / 2**24

    def _keep(self, number: int, states: Float) -> None:
        self._chunks[number] = states
        while len(self._chunks) > max(2, MOST_KEPT // states.size):
            del self._chunks[next(iter(self._chunks))]

    @property
    def _names(self) -> NDArray[np.uint64]:
        return np.arange(self.streams, dtype=np.uint64)


def _bump(x: Float) -> Float:
    """The cubic B-spline: 2 wide to each side of 0, integral 1."""
    x = np.abs(x)
    return (np.maximum(2 - x, 0) ** 3 - 4 * np.maximum(1 - x, 0) ** 3) / 6


def _windowed(x: Float, half: float) -> Float:
    """Mean of the spline over x ± half."""
    return (_below(x + half) - _below(x - half)) / (2 * half)


def _below(x: Float) -> Float:
    """Integral of the spline from −∞ to x."""
    x = np.clip(x, -2, 2)
    powers = [np.maximum(x + 2 - j, 0) ** 4 for j in range(4)]
    return (powers[0] - 4 * powers[1] + 6 * powers[2] - 4 * powers[3]) / 24
