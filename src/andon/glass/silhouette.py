"""The outline of glass: which share of a pixel is glass, and which ray stands for it (float64)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from andon.glass.model import Ball, Solid

__all__ = ["silhouette"]

Float = NDArray[np.float64]

# Of the radius: rays that are traced pass nearer than this to the middle. Beyond it float32 knows
# no longer whether they meet the ball.
WITHIN = 0.99999

# Less coverage is no glass: light times coverage has no digits left in a half float.
LEAST = 1 / 32


def silhouette(
    solids: Sequence[Solid], eye: Float, rays: Float, pixel_radians: Float, /
) -> tuple[Float, Float]:
    """Rays (n, 3) to trace and coverage (n,) of pixels whose middles lie along unit `rays` (n, 3).

    A ball alone has a smooth outline: coverage rises over the one pixel around it, and a pixel
    whose middle passes by the ball is traced where the ball is nearest. Other bodies cover all of
    the pixels whose middles meet them.
    """
    if len(solids) != 1 or not isinstance(solids[0].shape, Ball):
        return rays, np.ones(len(rays))
    radius = solids[0].shape.radius_m
    middle = solids[0].world_from_glass[:3, 3] - eye
    along = rays @ middle
    aside = along[:, None] * rays - middle
    off = np.linalg.norm(aside, axis=-1)
    outline = np.arcsin(min(radius / float(np.linalg.norm(middle)), 1.0))
    coverage = np.clip((outline - np.arctan2(off, along)) / pixel_radians + 0.5, 0, 1)
    coverage[coverage < LEAST] = 0
    passes = off > WITHIN * radius
    nearest = middle + aside[passes] * (WITHIN * radius / off[passes, None])
    traced = rays.copy()
    traced[passes] = nearest / np.linalg.norm(nearest, axis=-1, keepdims=True)
    return traced, coverage
