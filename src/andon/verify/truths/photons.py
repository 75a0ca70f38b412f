"""Light through a glass ball by photons: vectors, Snell and Fresnel at each surface, and a count.

Nothing of the closed form of `andon.transport.direct.balls` is in it: no impact parameter, no
symmetry, no table.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Landed", "illuminance_map", "is_open", "through_ball"]

Float = NDArray[np.float64]


@dataclass(frozen=True)
class Landed:
    """Photons on the plane y = 0.

    Attributes
    ----------
    place : (n, 2) x and z in metres.
    flux : (n,) lm for a lamp of one candela; 0 for those that never land.
    sent : lm that were sent at the ball.
    """

    place: Float
    flux: Float
    sent: float


def through_ball(
    lamp_m: Float,
    centre_m: Float,
    radius_m: float,
    index: float,
    absorption_per_m: float,
    /,
    *,
    photons: int,
    seed: int = 0,
) -> Landed:
    """Sends `photons` from a lamp of 1 cd at `lamp_m` (3,) at a ball, and on to the plane y = 0.

    Directions are stratified over the cone that the ball fills, so counts are less noisy than
    their root says. Photons that are reflected at a surface are gone.
    """
    generator = np.random.default_rng(seed)
    side = int(np.sqrt(photons))
    cells = np.stack(np.divmod(np.arange(side**2), side), axis=1)
    shares = (cells + generator.uniform(size=cells.shape)) / side
    reach = centre_m - lamp_m
    distance = float(np.linalg.norm(reach))
    lowest = np.sqrt(1 - (radius_m / distance) ** 2)
    solid_angle = 2 * np.pi * (1 - lowest)
    direction = _in_cone(reach / distance, 1 - shares[:, 0] * (1 - lowest), shares[:, 1])
    flux = np.full(len(direction), solid_angle / len(direction))
    # Rounding at the cone's rim: those pass beside the ball with 0.
    half = direction @ reach
    root = np.sqrt(np.maximum(half**2 - distance**2 + radius_m**2, 0))
    point = lamp_m + (half - root)[:, None] * direction
    normal = (point - centre_m) / radius_m
    direction, passed = _refracted(direction, normal, 1 / index)
    flux = flux * passed
    chord = -2 * np.einsum("ij,ij->i", direction, point - centre_m)
    point = point + chord[:, None] * direction
    flux = flux * np.exp(-absorption_per_m * chord)
    direction, passed = _refracted(direction, -(point - centre_m) / radius_m, index)
    flux = flux * passed
    lands = direction[:, 1] < -1e-9
    along = np.where(lands, -point[:, 1] / np.where(lands, direction[:, 1], -1), 0)
    landed = point + along[:, None] * direction
    return Landed(landed[:, [0, 2]], np.where(lands, flux, 0), solid_angle)


def illuminance_map(landed: Landed, first: Float, step: Float, shape: tuple[int, int], /) -> Float:
    """Illuminance (rows, columns) = `shape` in lx, means over cells of the plane.

    `first` and `step` (2,) are x and z of the first cell's middle, and from cell to cell: x along
    columns, z along rows, of either sign.
    """
    at = np.floor((landed.place - first) / step + 0.5)
    rows, columns = shape
    counts = np.histogram2d(
        at[:, 1],
        at[:, 0],
        bins=(np.arange(rows + 1) - 0.5, np.arange(columns + 1) - 0.5),
        weights=landed.flux,
    )[0]
    return counts / abs(float(np.prod(step)))


def is_open(lamp_m: Float, centre_m: Float, radius_m: float, place: Float, /) -> NDArray[np.bool_]:
    """Whether the line from the lamp to points `place` (..., 3) behind a ball passes beside it."""
    line = place - lamp_m
    across = np.cross(line, centre_m - lamp_m)
    return np.linalg.norm(across, axis=-1) > radius_m * np.linalg.norm(line, axis=-1)


def _in_cone(axis: Float, cosine: Float, turn: Float) -> Float:
    """Unit vectors at `cosine` from `axis` (3,), `turn` in [0, 1) around it."""
    helper = np.eye(3)[np.argmin(np.abs(axis))]
    right = np.asarray(np.cross(axis, helper), np.float64)
    right /= np.linalg.norm(right)
    up = np.asarray(np.cross(right, axis), np.float64)
    sine, angle = np.sqrt(np.maximum(1 - cosine**2, 0)), 2 * np.pi * turn
    across = np.cos(angle)[:, None] * right + np.sin(angle)[:, None] * up
    return cosine[:, None] * axis + sine[:, None] * across


def _refracted(direction: Float, normal: Float, ratio: float) -> tuple[Float, Float]:
    """Directions behind a surface with `normal` against the light, and Fresnel's transmittance."""
    cos_i = -np.einsum("ij,ij->i", direction, normal)
    cos_t = np.sqrt(np.maximum(1 - ratio**2 * (1 - cos_i**2), 0))
    # η₁/η₂ = ratio, so both amplitudes are over η₂.
    across = (ratio * cos_i - cos_t) / (ratio * cos_i + cos_t)
    along = (cos_i - ratio * cos_t) / (cos_i + ratio * cos_t)
    bent = ratio * direction + (ratio * cos_i - cos_t)[:, None] * normal
    return bent, 1 - (across**2 + along**2) / 2
