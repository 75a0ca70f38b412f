"""Noise against banding: captured light anywhere within its step, not at its middle.

A code of the photograph stands for all light within half a step of it. Brightened, its step is A
codes wide, and a slow gradient becomes bands::

    light   ╱╱╱╱╱╱╱╱     8 bits   ▁▁▁▃▃▃▅▅▅     × 16   bands of A codes
    noise of ±½ step     8 bits   ▁▂▁▃▂▄▃▅▄     × 16   grain: as wide as the step has become

So the noise is put in where the step is: into the captured light, before it is relit.

=========================  =====================================================================
noise                      and why not the other
=========================  =====================================================================
**±½ step, captured**      what was not changed keeps its bytes, since half a step rounds back;
                           whatever light, curve, tone or glass do to the step they do to the noise;
                           what is virtual has no steps and gets none; costs a frame nothing
√(A² − 1) codes, display   the same width, but A is the slope of all that comes between, it needs
                           the photograph once more in the display's pass, and is even on both
                           sides of a code where the step is not
=========================  =====================================================================

The pattern is blue noise (void and cluster), still, as the photograph's own grain is. Share of the
power below ⅛ cycle/px, of white noise's: 0.0003; R2 sequence 0.03, interleaved gradient noise 0.07,
both with lines in their spectra that show as stripes.

Sources: Ulichney 1993 (void and cluster); Roberts 1962 (noise before quantisation).
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.quantities import CameraFrame

__all__ = ["blue_noise", "dithered", "noise_reach"]

Float = NDArray[np.float64]

TILE_PX = 64
# Ulichney's σ of the filter that finds voids and clusters, and his share of first dots.
SIGMA_PX, FIRST_SHARE = 1.5, 0.1
# Where the tile begins in each channel, (row, column): a third of it apart.
OFFSETS = ((0, 0), (21, 42), (42, 21))
# Of a step to either side: a half, less what float32 powers err by on the GPU.
REACH = 0.49
# Captured and relit light are half floats there: each rounds by up to 2⁻¹² of the value.
HALF_ROUNDINGS = 2 * 2.0**-12


def dithered(frame: CameraFrame, /) -> CameraFrame:
    """The frame with noise of ±½ step of its codes, so that unchanged light keeps its bytes.

    Values between two codes, as undistortion makes them, move by less: to the middle between
    codes, where there is none left. Black stays black (borders are), and clipped white white.
    Floats have no steps: their frame is returned as it is.
    """
    if frame.code_step == 0:
        return frame
    linear = np.asarray(frame.linear, np.float64)
    codes = np.asarray(frame.response.encode(linear), np.float64) / frame.code_step
    nearest = np.round(codes)
    room = np.maximum(noise_reach(frame) - np.abs(codes - nearest), 0)
    moved = codes + 2 * room * _tiled(linear.shape)
    inside = (nearest > 0) & (nearest < round(1 / frame.code_step))
    drawn = np.where(inside, frame.response.decode(moved * frame.code_step), linear)
    return replace(frame, linear=drawn.astype(np.float32))


def noise_reach(frame: CameraFrame, /) -> Float:
    """(H, W, 3) how far the noise goes to either side of a code, in steps: 0.49 and less.

    Less where half floats, in which the GPU holds light, are not much finer than the step: bright
    codes lose up to 0.13, those of 16 bits all but in the dark.
    """
    linear = np.asarray(frame.linear, np.float64)
    encode = frame.response.encode
    rounded = encode(linear * (1 + HALF_ROUNDINGS)) - encode(linear)
    return np.maximum(REACH - np.asarray(rounded, np.float64) / frame.code_step, 0)


def _tiled(shape: tuple[int, ...]) -> Float:
    """(H, W, 3) noise in (−½, ½), another in each channel."""
    height, width = shape[:2]
    repeats = (-(-height // TILE_PX), -(-width // TILE_PX))
    tiles = [np.tile(np.roll(blue_noise(), at, axis=(0, 1)), repeats) for at in OFFSETS]
    return np.stack(tiles, axis=-1)[:height, :width]


@cache
def blue_noise() -> Float:
    """(64, 64) in (−½, ½), each of 4096 even values once; tiles without a seam.

    Source: Ulichney 1993: dots are set into the largest void, in the order that is their rank; the
    first tenth are spread evenly by moving the dot of the tightest cluster, again and again, and
    ranked by taking the tightest away. Both searches are of one Gaussian, round the edges.
    """
    field = _Field(TILE_PX)
    count = round(FIRST_SHARE * TILE_PX**2)
    for place in np.random.default_rng(0).choice(TILE_PX**2, count, replace=False):
        field.put(int(place))
    cluster, void = field.tightest(), -1
    while cluster != void:
        field.take(cluster)
        void = field.emptiest()
        field.put(void)
        cluster = field.tightest()
    rank = np.zeros(TILE_PX**2)
    first = field.copy()
    for number in range(count - 1, -1, -1):
        cluster = first.tightest()
        first.take(cluster)
        rank[cluster] = number
    for number in range(count, TILE_PX**2):
        void = field.emptiest()
        field.put(void)
        rank[void] = number
    noise = (rank.reshape(TILE_PX, TILE_PX) + 0.5) / TILE_PX**2 - 0.5
    noise.flags.writeable = False
    return noise


class _Field:
    """Dots on a torus, and how close they stand."""

    def __init__(self, size: int) -> None:
        self._size = size
        away = np.minimum(np.arange(size), size - np.arange(size))
        square = away[:, None] ** 2 + away[None] ** 2
        self._around = np.tile(np.exp(-square / (2 * SIGMA_PX**2)), (2, 2))
        self._dots = np.zeros(size * size, bool)
        self._energy = np.zeros(size * size)

    def copy(self) -> _Field:
        """The same dots, on their own."""
        other = _Field(self._size)
        other._dots, other._energy = self._dots.copy(), self._energy.copy()
        return other

    def put(self, place: int) -> None:
        """A dot there."""
        self._dots[place] = True
        self._energy += self._reach_of(place)

    def take(self, place: int) -> None:
        """No dot there."""
        self._dots[place] = False
        self._energy -= self._reach_of(place)

    def tightest(self) -> int:
        """The dot with the most around it."""
        return int(np.argmax(np.where(self._dots, self._energy, -np.inf)))

    def emptiest(self) -> int:
        """The place without a dot that has the least around it."""
        return int(np.argmin(np.where(self._dots, np.inf, self._energy)))

    def _reach_of(self, place: int) -> NDArray[Any]:
        row, column = divmod(place, self._size)
        rows = slice(self._size - row, 2 * self._size - row)
        return self._around[rows, self._size - column : 2 * self._size - column].ravel()
