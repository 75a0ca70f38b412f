"""Azimuths around a source in the frame of the eye, and the shape of its outline there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.glare.model import Source

__all__ = ["Elongation", "elongation", "eye_axes", "lobed", "outline_at"]

Float = NDArray[np.float64]

# Quadrature of moments and of the lobe: both are smooth; twice as many change nothing at 1e-6.
STEPS = 720


def eye_axes(direction: Float, /) -> tuple[Float, Float]:
    """(right, down), each (3,): the camera's x and y, carried to `direction` (3,) without twist.

    They are turned with the great circle from straight ahead to `direction`, so what belongs to
    the eye looks the same around every source. Straight behind, where no eye sees, they jump.
    """
    x, y, z = direction
    if z < -1 + 1e-12:
        return np.array([-1.0, 0, 0]), np.array([0.0, 1, 0])
    lean = 1 / (1 + z)
    right = np.array([1 - x * x * lean, -x * y * lean, -x])
    down = np.array([-x * y * lean, 1 - y * y * lean, -y])
    return right, down


def outline_at(source: Source, azimuth_radians: Float, /) -> Float:
    """(...) θ0 of the outline at azimuths (...) of the eye's frame."""
    if _is_circle(source):
        return np.full(np.shape(azimuth_radians), source.outline.radii_radians[0])
    return source.outline.radius(azimuth_radians - _offset(source))


def _is_circle(source: Source) -> bool:
    """Most sources are, and need no quadrature."""
    return len(source.outline.radii_radians) == 1


def _offset(source: Source) -> float:
    """Azimuth of the outline's φ = 0 in the eye's frame."""
    right, down = eye_axes(source.direction)
    start = source.axes[0]
    return float(np.arctan2(start @ down, start @ right))


@dataclass(frozen=True)
class Elongation:
    """Of an outline: 0 circle … 1 line, and the azimuth of its long axis in the eye's frame."""

    degree: float
    axis_radians: float


def elongation(source: Source, /) -> Elongation:
    """From the second moments of the outline's area about its own centre.

    ``(λ₁ − λ₂)/(λ₁ + λ₂)`` of their eigenvalues: (a² − b²)/(a² + b²) for an ellipse. The tangent
    plane stands for the sphere.
    """
    if _is_circle(source):
        return Elongation(0.0, 0.0)
    phi = (np.arange(STEPS, dtype=np.float64) + 0.5) * (2 * np.pi / STEPS)
    radius = outline_at(source, phi)
    unit = np.stack([np.cos(phi), np.sin(phi)])
    area = np.mean(radius**2) / 2
    centre = np.mean(radius**3 * unit, axis=1) / (3 * area)
    second = np.einsum("i,ai,bi->ab", radius**4, unit, unit) / (4 * STEPS * area)
    xx, xy, yy = (second - np.outer(centre, centre)).flat[[0, 1, 3]]
    degree = np.hypot(xx - yy, 2 * xy) / (xx + yy)
    return Elongation(float(degree), float(np.arctan2(2 * xy, xx - yy) / 2))


def lobed(turn: Float, shape: Elongation, lobe_radians: float, /) -> Float:
    """(n,) azimuths in radians of needles whose azimuth around a circle is `turn` (n,) turns.

    Each half of the circle about the long axis is swept into a Gaussian lobe, by the quantiles of
    the Gaussian cut off at ±90°; its standard deviation is `lobe_radians` around a line and
    ∞ around a circle, which leaves the needles where they are. So the lobes grow out of the uniform
    circle without a jump as a source turns from a disc into an ellipse, or the ellipse turns.
    """
    azimuth = 2 * np.pi * turn
    if shape.degree == 0:
        return azimuth
    place = (azimuth - shape.axis_radians + np.pi / 2) / np.pi
    half = np.floor(place)
    x = np.linspace(-np.pi / 2, np.pi / 2, STEPS + 1)
    density = np.exp(-((x * shape.degree / lobe_radians) ** 2) / 2)
    share = np.concatenate([[0.0], np.cumsum((density[1:] + density[:-1]) / 2)])
    swept = np.interp(place - half, share / share[-1], x)
    return shape.axis_radians + half * np.pi + swept
