"""Against banding: captured light anywhere within its step, not at its middle.

A code of the photograph stands for all light within half a step of it. Brightened, its step is A
codes wide, and a slow gradient becomes bands of A codes. Where in its step a value lies is told by
its surroundings, and noise fills the room that is left to either side::

    light    ╱╱╱╱╱╱╱╱      captured  ▁▁▁▃▃▃▅▅▅      × A   bands
    mean of surroundings   captured  ▁▂▂▃▃▄▄▅▅      × A   gradient, rounded
    and noise              captured  ▁▂▃▂▄▃▅▄▅      × A   gradient in grain

Both happen to the captured light, before it is relit, never leave the step, and fade where the
surroundings spread by more than the step: texture has no bands, and is left as it is.

=========================  =====================================================================
noise                      and why not the other
=========================  =====================================================================
**±½ step, captured**      what was not changed keeps its bytes, since half a step rounds back;
                           whatever light, curve, tone or glass do to the step they do to the noise;
                           what is virtual has no steps and gets none; costs a frame nothing
√(A² − 1) codes, display   the same width, but A is the slope of all that comes between, it needs
                           the photograph once more in the display's pass, and is even on both
                           sides of a code where the step is not
noise alone                hides edges of bands; their means still are a staircase
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

__all__ = ["blue_noise", "dithered", "within_steps"]

Float = NDArray[np.float64]

TILE_PX = 64
# Ulichney's σ of the filter that finds voids and clusters, and his share of first dots.
SIGMA_PX, FIRST_SHARE = 1.5, 0.1
# Where the tile begins in each channel, (row, column): a third of it apart.
OFFSETS = ((0, 0), (21, 42), (42, 21))
# Sides of the surroundings that tell where in its step a value lies: the widest that are even. As
# their spread grows from the one to the other, in codes, they tell less: there is texture or noise.
AROUND_PX = (33, 17, 9, 5)
EVEN_CODES, BUSY_CODES = 0.4, 0.8
# Of a step to either side: a half, less what float32 powers err by on the GPU.
REACH = 0.49
# Captured and relit light are half floats there: each rounds by up to 2⁻¹² of the value, and the
# smallest by 2⁻²⁵.
HALF_ROUNDING, LEAST_ROUNDING = 2.0**-12, 2.0**-25


def dithered(frame: CameraFrame, /) -> CameraFrame:
    """The frame with each value elsewhere in its step, so that unchanged light keeps its bytes.

    Black stays black (borders are), and clipped white white. Floats have no steps: their frame is
    returned as it is.
    """
    if frame.code_step == 0:
        return frame
    linear = np.asarray(frame.linear, np.float64)
    codes, room = within_steps(frame)
    moved = codes + 2 * room * _tiled(linear.shape)
    nearest = np.round(codes)
    inside = (nearest > 0) & (nearest < round(1 / frame.code_step))
    drawn = np.where(inside, frame.response.decode(moved * frame.code_step), linear)
    return replace(frame, linear=drawn.astype(np.float32))


def within_steps(frame: CameraFrame, /) -> tuple[Float, Float]:
    """Where in its step each value (H, W, 3) lies by its surroundings, in codes; and the room to
    either side of it that noise has, in codes.

    In texture values stay where they are, and have no room. Values between two codes, as
    undistortion makes them, stay nearer to the same one.
    """
    linear = np.asarray(frame.linear, np.float64)
    codes = np.asarray(frame.response.encode(linear), np.float64) / frame.code_step
    nearest, reach = np.round(codes), _reach(frame, codes)
    inner, busy = codes.copy(), np.ones_like(codes)
    for size in AROUND_PX:
        mean, spread = _surroundings(codes, size)
        even = busy * np.clip((BUSY_CODES - spread) / (BUSY_CODES - EVEN_CODES), 0, 1)
        inner += even * (mean - codes)
        busy -= even
    most = np.maximum(reach, np.abs(codes - nearest))
    inner = np.clip(inner, nearest - most, nearest + most)
    return inner, (1 - busy) * np.maximum(reach - np.abs(inner - nearest), 0)


def _surroundings(codes: Float, size: int) -> tuple[Float, Float]:
    """Mean and standard deviation of `size`² values around each (H, W, 3)."""
    import cv2

    mean = np.asarray(cv2.blur(codes, (size, size)), np.float64)
    square = np.asarray(cv2.blur(codes * codes, (size, size)), np.float64)
    return mean, np.sqrt(np.maximum(square - mean * mean, 0))


def _reach(frame: CameraFrame, codes: Float) -> Float:
    """(H, W, 3) how far a value may go to either side of its code: 0.49 codes and less.

    Less where half floats, in which the GPU holds light, are not much finer than the step: bright
    codes lose up to 0.13, those of 16 bits all but in the dark.
    """
    response, step = frame.response, frame.code_step
    edge = np.maximum(np.round(codes) - 0.5, 0) * step
    light = np.asarray(response.decode(edge), np.float64)
    rounded = light + 2 * np.maximum(light * HALF_ROUNDING, LEAST_ROUNDING)
    return np.maximum(REACH - (np.asarray(response.encode(rounded), np.float64) - edge) / step, 0)


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
