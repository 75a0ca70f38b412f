"""The flux behind a ball, as a table over concentric spheres and angles; both engines read it.

Lengths are in radii of the ball, `vergence` is one over a length: 0 far away, 1 at the surface.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "CELLS",
    "ROWS",
    "BallTable",
    "angle_of",
    "ball_table",
    "place_of",
    "polar_angle",
    "transmittance",
]

Float = NDArray[np.float64]

# Angles and vergences. 256 × 256 half floats of four channels are 512 KiB. Rows are so near to each
# other that the caustic, which moves by dψ = b·dv from row to row, is in the same or the next cell:
# with fewer rows two pale rings would stand for a bright one.
CELLS, ROWS = 256, 256
# Where cells turn from equal angles to growing ones, as sin ψ/2: see `place_of`.
KNEE = 0.5
# Rays through half a ball. The table is exact for rings between rays; 512 err by 2e-6 rad in where
# the caustic is.
RAYS = 512
# np.interp sorts all rows at once: ψ of one row ends below where the next one begins.
ROW_STEP = 8.0


@dataclass(frozen=True)
class BallTable:
    """What a ball makes of the light of one lamp.

    Attributes
    ----------
    light : (ROWS, CELLS, 3) flux through a cell of a concentric sphere, over the flux that one
        unit of the illuminance which the lamp would give at the centre sends through the cell's
        solid angle (times the square of the radius): E·ρ²/E_centre.
    lean : (ROWS, CELLS) the same of all three channels together, times tan χ/v of each ray: χ is
        its angle from the radius, towards the axis, v the row's vergence. The light of several rays
        is the sum of their vectors, (1, tan χ) for a unit through the sphere; so this is
        interpolated like `light`, and the direction is its ratio to the sum of the channels.
    """

    light: Float
    lean: Float


def place_of(sine: Float, /) -> Float:
    """Place [0, 1] in the table of sin ψ/2 in [0, 1]: even near the axis, coarser far from it."""
    return (1 + KNEE) * sine / (KNEE + sine)


def angle_of(place: Float, /) -> Float:
    """ψ in [0, π] of a place [0, 1] in the table."""
    return 2 * np.arcsin(np.clip(KNEE * place / (1 + KNEE - place), 0, 1))


def polar_angle(b: Float, vergence: Float | float, lamp_vergence: float, index: float, /) -> Float:
    """ψ in radians, signed, where the ray of impact parameter `b` meets a concentric sphere.

    Source: van de Hulst 1957, section 12.2, with lamp and receiver at finite distances. Arguments
    broadcast; b in [0, 1], vergences in [0, 1], index ≥ 1.
    """
    straight = np.arcsin(b * lamp_vergence) + np.arcsin(np.clip(b * vergence, -1, 1))
    return straight - 2 * np.arcsin(b) + 2 * np.arcsin(b / index)


def transmittance(b: Float, index: float, absorption: float, /) -> Float:
    """(1 − F)²·exp(−chord·absorption) of the ray of impact parameter `b`; `absorption` per radius.

    F is the mean of both polarisations at each surface, equal at both by symmetry: Born & Wolf
    1999, section 1.5.2, equation (21).
    """
    # Never 0, so that a ball of air reflects nothing at b = 1 either.
    cos_i, cos_r = (np.sqrt(np.maximum(1 - x**2, 1e-24)) for x in (b, b / index))
    across = (cos_i - index * cos_r) / (cos_i + index * cos_r)
    along = (index * cos_i - cos_r) / (index * cos_i + cos_r)
    fresnel = (across**2 + along**2) / 2
    return (1 - fresnel) ** 2 * np.exp(-2 * absorption * cos_r)


@lru_cache(maxsize=64)
def ball_table(
    lamp_vergence: float,
    index: tuple[float, float, float],
    absorption: tuple[float, float, float],
    /,
) -> BallTable:
    """The table of a ball; `absorption` per radius. Made in 80 ms, 40 ms without
    dispersion (one core)."""
    # Rays are even in sin⁻¹ b: dense where Fresnel and the angles change fastest.
    incidence = np.linspace(0, np.pi / 2, RAYS + 1)
    flux = [_flux(incidence, lamp_vergence, n, a) for n, a in zip(index, absorption, strict=True)]
    edges = angle_of(np.linspace(0, 1, CELLS + 1))
    light = np.empty((ROWS, CELLS, 3))
    lean = np.zeros((ROWS, CELLS))
    b = np.sin(incidence)
    for one in dict.fromkeys(index):
        channels = [c for c in range(3) if index[c] == one]
        where = _crossings(b, lamp_vergence, one, edges)
        for channel in channels:
            light[..., channel] = _cells(flux[channel], where)
        lean += _lean(b, np.sum([flux[channel] for channel in channels], axis=0), where)
    solid_angle = np.diff(-2 * np.pi * np.cos(edges))
    return BallTable(light / solid_angle[:, None], lean / solid_angle)


def _integral(incidence: Float, values: Float, middles: Float) -> Float:
    """Running integral over incidence by Simpson's rule, 0 at first; `middles` between `values`."""
    step = incidence[1] - incidence[0]
    parts = (values[:-1] + 4 * middles + values[1:]) * (step / 6)
    return np.concatenate([[0.0], np.cumsum(parts)])


def _density(incidence: Float, lamp_vergence: float, index: float, absorption: float) -> Float:
    """Flux per incidence: what a unit of illuminance at the centre sends through the ball.

    I·2π·sin θ·dθ with sin θ = b/ρ_lamp is (I/ρ_lamp²)·2π·b·db/cos θ.
    """
    b = np.sin(incidence)
    # b·db of a lamp that touches the ball cancels with cos θ but for the limit itself.
    cosine = np.maximum(np.sqrt(np.maximum(1 - (b * lamp_vergence) ** 2, 0)), 1e-9)
    return 2 * np.pi * transmittance(b, index, absorption) * b * np.cos(incidence) / cosine


def _flux(incidence: Float, lamp_vergence: float, index: float, absorption: float) -> Float:
    middle = (incidence[:-1] + incidence[1:]) / 2
    both = [_density(x, lamp_vergence, index, absorption) for x in (incidence, middle)]
    return _integral(incidence, *both)


def _lean(b: Float, flux: Float, where: list[Float]) -> Float:
    """(ROWS, CELLS) flux that falls into each cell, times tan χ/v = b/√(1 − b²v²)."""
    vergence = np.linspace(0, 1, 2 * ROWS - 1)[:, None]
    middle = (b[:-1] + b[1:]) / 2
    moment = np.zeros((len(vergence), len(b)))
    slope = middle / np.sqrt(1 - (middle * vergence) ** 2)
    np.cumsum(np.diff(flux) * slope, axis=1, out=moment[:, 1:])
    ahead, crossed = _shares(moment, where)
    return _blended(ahead - crossed)


def _crossings(b: Float, lamp_vergence: float, index: float, edges: Float) -> list[Float]:
    """Ray numbers at the edges of cells: of the part of ψ(b) that rises, of that which falls, and
    of the falling part beyond the axis (ψ < 0); each (2·ROWS − 1, CELLS + 1).

    ψ(b) rises to the caustic, where there is one, and falls from there: √(1 − b²)·dψ/db is a sum of
    falling terms, so dψ/db changes its sign once at most.
    """
    rows = 2 * ROWS - 1
    angle = polar_angle(b, np.linspace(0, 1, rows)[:, None], lamp_vergence, index)
    turn = np.argmax(angle, axis=1)[:, None]
    number = np.arange(len(b))
    offset = ROW_STEP * np.arange(rows)[:, None]
    peak = np.take_along_axis(angle, turn, axis=1)
    rising = (np.where(number <= turn, angle, peak) + offset).astype(np.float64)
    rising_number = np.broadcast_to(np.minimum(number, turn), angle.shape)
    falling = (np.where(number >= turn, angle, peak)[:, ::-1] + offset).astype(np.float64)
    falling_number = np.broadcast_to(np.maximum(number, turn)[:, ::-1], angle.shape)

    def numbers(wanted: Float, known: Float, values: Float) -> Float:
        # Below and above what a row has: its first and its last.
        inside = np.clip(wanted, known[:, :1], known[:, -1:])
        found = np.interp(inside.ravel(), known.ravel(), values.ravel())
        return found.reshape(inside.shape)

    up = numbers(edges + offset, rising, rising_number)
    down = numbers(edges + offset, falling, falling_number)
    beyond = numbers(offset - edges, falling, falling_number)
    return [up, down, beyond]


def _cells(running: Float, where: list[Float]) -> Float:
    """(ROWS, CELLS) of a running sum over rays what falls into each cell."""
    ahead, crossed = _shares(np.broadcast_to(running, (len(where[0]), len(running))), where)
    return _blended(ahead + crossed)


def _blended(halves: Float) -> Float:
    """Rows from rows at half the step, each with its neighbours: ¼, ½, ¼."""
    around = np.concatenate([halves[:1], halves, halves[-1:]])
    return (around[:-2] + 2 * around[1:-1] + around[2:])[::2] / 4


def _shares(running: Float, where: list[Float]) -> tuple[Float, Float]:
    """Of running sums (rows, rays) what falls into each cell: on its own side of the axis, and
    crossed over; each (rows, CELLS).
    """
    up, down, beyond = (_at(running, numbers) for numbers in where)
    return np.diff(up, axis=1) - np.diff(down, axis=1), np.diff(beyond, axis=1)


def _at(running: Float, numbers: Float) -> Float:
    below = np.minimum(numbers.astype(np.int64), running.shape[1] - 2)
    first = np.take_along_axis(running, below, axis=1)
    after = np.take_along_axis(running, below + 1, axis=1)
    part = numbers - below
    # Flux grows with the square of the ray's number, near the axis exactly.
    return first + (after - first) * part * (2 * below + part) / (2 * below + 1)
