"""Shares of the finest rungs and of the neighbours: the kernel averaged over pixels.

What a pixel sends to the pixel at an offset d is ``∫ K(θ)·tent(θ − d)``, the mean over both; near
by, where a spread function falls within a pixel to half, this is not the mixture's W any more. So
shares of the finest rungs are those that send as much, by least squares over the offsets from 2 to
`REACH` pixels, all ≥ 0; and the eight neighbours get what is then missing. The sphere counts as
flat here, and what a rung sends is its mean over all places of pixels in blocks and of blocks in
cells. What is left, energy says, stays in the pixel.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from andon.glare.kernel import Kernel
from andon.glare.whole_picture.splines import quintic

__all__ = ["OFFSETS", "fitted", "sent", "sent_by_blocks", "sent_by_filter"]

Float = NDArray[np.float64]

# Pixels, and the offsets (n, 2) of a quadrant within them but for the pixel itself.
REACH = 16
LEAST_SENT = 1e-9
OFFSETS: Float = np.argwhere(np.ones((REACH + 1, REACH + 1)))[1:].astype(np.float64)
NEIGHBOURS: NDArray[np.bool_] = OFFSETS.max(1) == 1
# Within θ_min light is veil where pixels are smaller than that, and no light where they are larger
# by this.
CORELESS = 1.25
# Of rings of light: the least, in pixels; each so much wider; and azimuths of a quadrant.
LEAST, RING_STEP, AZIMUTHS = 1e-3, 0.04, 48
# Pixels to which rings are sent; farther off three points an axis have the moments of both pixels
# to the fourth.
RINGED = 4
TENT_AT, TENT_WEIGHTS = math.sqrt(0.4), (1 / 4.8, 1 - 2 / 4.8, 1 / 4.8)
# How much offsets within θ_min count.
PLATEAU = 0.1
# Sweeps of the descent along one share after another; 5 shares settle to 1e-6.
SWEEPS = 400
# How much a share that is off what W says by all of itself counts, against the veil's error.
PRIOR = 0.05
# And by which power of how narrow a pixel is it counts more.
NARROW_PRIOR = 1.5


def sent(kernel: Kernel, pixels: Float, /) -> Float:
    """(m, n) share of a pixel's light that arrives at `OFFSETS`, of pixels (m, 2) wide, high."""
    core = (CORELESS - np.sqrt(pixels.prod(1)) / np.radians(kernel.minimum_degrees)) / (
        CORELESS - 1
    )
    core = np.clip(core, 0, 1)[:, None]

    def value(theta: Float) -> Float:
        return (1 - core) * kernel.per_sr(theta) + core * kernel.per_sr(theta, core=True)

    total = np.zeros((len(pixels), len(OFFSETS)))
    ends = (-TENT_AT, 0.0, TENT_AT)
    for x, across in zip(ends, TENT_WEIGHTS, strict=True):
        for y, along in zip(ends, TENT_WEIGHTS, strict=True):
            theta = np.hypot(*np.moveaxis((OFFSETS + np.array([x, y])) * pixels[:, None], -1, 0))
            total += across * along * value(theta) * pixels.prod(1)[:, None]
    near = OFFSETS.max(1) <= RINGED
    total[:, near] = _by_rings(value, pixels)[:, near]
    return total


def _by_rings(value: Callable[[Float], Float], pixels: Float) -> Float:
    """As `sent`, right to `RINGED` pixels: points on rings, shared out as both pixels' mean is."""
    size = RINGED + 2
    count = int(np.log(1.5 * size / LEAST) / RING_STEP)
    rings: Float = LEAST * np.exp((np.arange(count) + 0.5) * RING_STEP)
    # Each ring starts at another azimuth.
    turn = (np.arange(count) * 0.6180339887) % 1
    azimuth = (np.arange(AZIMUTHS) + turn[:, None]) * (np.pi / 2 / AZIMUTHS)
    way = np.stack([np.cos(azimuth), np.sin(azimuth)], -1)
    theta = rings * pixels.max(1)[:, None]
    light = value(theta) * theta**2 * (RING_STEP * np.pi / 2 / AZIMUTHS)
    table = np.zeros((len(pixels), REACH + 1, REACH + 1))
    for index, pixel in enumerate(pixels):
        place = (theta[index, :, None, None] * way / pixel).reshape(-1, 2)
        inside = (place < size).all(-1)
        low = place[inside].astype(np.int64)
        high = place[inside] - low
        weights = np.repeat(light[index], AZIMUTHS)[inside]
        for i, j in np.ndindex(2, 2):
            across = high[:, 0] if i else 1 - high[:, 0]
            part = across * (high[:, 1] if j else 1 - high[:, 1])
            bins = (low[:, 0] + i) * (REACH + 1) + low[:, 1] + j
            sums = np.bincount(bins, weights * part, (REACH + 1) ** 2)
            table[index] += sums.reshape(REACH + 1, REACH + 1)
    # What goes to the other side of an axis arrives on it, too.
    table[:, 0] *= 2
    table[:, :, 0] *= 2
    return table.reshape(len(pixels), -1)[:, 1:]


def sent_by_blocks() -> Float:
    """(n,) as `sent`, by blocks alone."""
    along = np.zeros(REACH + 1)
    along[:4] = np.array([20, 15, 6, 1]) / 64
    return _product(along, along)


def sent_by_filter(half: tuple[float, ...], cells: Float, /) -> Float:
    """(m, n) as `sent`, by a level's filter whose cells are (m, 2) pixels wide and high."""
    return _product(_along(half, cells[:, 0]), _along(half, cells[:, 1]))


def _product(across: Float, along: Float) -> Float:
    whole = across[..., :, None] * along[..., None, :]
    return whole.reshape(*whole.shape[:-2], -1)[..., 1:]


def _along(half: tuple[float, ...], cell: Float) -> Float:
    """(m, REACH + 1) to pixels at offsets 0…REACH, through blocks there and back."""
    total = np.zeros((len(cell), REACH + 1))
    for offset in range(REACH + 1):
        for phase in (0, 1):
            for one, share in _blocks(phase):
                for other, read in _blocks(phase + offset):
                    place = 2 * (other - one) / cell
                    total[:, offset] += share * read / 2 * _density(half, place) / cell
    return total


def _blocks(pixel: int) -> tuple[tuple[int, float], ...]:
    """The blocks of a pixel and its shares in them."""
    own = pixel // 2
    return (own, 0.75), (own + (1 if pixel % 2 else -1), 0.25)


def _density(half: tuple[float, ...], place: Float) -> Float:
    """B ∗ P ∗ B at places in cells."""
    reach = len(half) - 1
    return np.sum([half[abs(n)] * quintic(place - n) for n in range(-reach, reach + 1)], 0)


def fitted(
    parts: Float, wanted: Float, rest: Float, expected: Float, pixel: Float, narrow: Float, /
) -> Float:
    """(m, k) shares ≥ 0 by which `parts` (m, n, k) and `rest` sum to `wanted`, both (m, n).

    They are not far from `expected` (m, k) where that does as well. Relative errors, and a ring of
    offsets counts as much as any other; neighbours as far as a `pixel` (m,) is less than θ_min.
    Where pixels are `narrow` (m,), height by width, what is expected counts more.
    """
    counts = np.where(NEIGHBOURS, np.clip(2 - 2 * pixel, 0, 1)[:, None], 1.0)
    # Within θ_min the plateau's edge is none of a sum of bumps: they are to be right beyond it.
    beyond = np.clip((np.hypot(*OFFSETS.T) * pixel[:, None] - 0.8) / 0.2, PLATEAU, 1)
    counts = counts * beyond
    # Beyond the kernel's end there is nothing to be had.
    counts = np.where(wanted > LEAST_SENT, counts, 0)
    weight = counts / (np.hypot(*OFFSETS.T) * np.maximum(wanted, LEAST_SENT))
    rows = parts * weight[..., None]
    prior = PRIOR * narrow[:, None] ** NARROW_PRIOR
    rows = np.concatenate([rows, np.eye(parts.shape[2]) * (prior / expected)[:, :, None]], 1)
    right = np.concatenate([(wanted - rest) * weight, np.tile(prior, expected.shape[1])], 1)
    square = np.einsum("mni,mnj->mij", rows, rows)
    product = np.einsum("mni,mn->mi", rows, right)
    shares = expected.copy()
    for _ in range(SWEEPS):
        for k in range(shares.shape[1]):
            rest = product[:, k] - np.einsum("mj,mj->m", square[:, k], shares)
            shares[:, k] = np.maximum(shares[:, k] + rest / square[:, k, k], 0)
    return shares
