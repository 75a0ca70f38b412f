"""How much of a surface no map sees: what a report says of a bake, and a search for cameras asks.

Light is not guessed where no map is valid: such points get none, and are counted here.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.quantities import Geometry, Surface
from andon.transport.baked.model import BakedLight
from andon.transport.baked.reference import illuminance_at

__all__ = ["area_points", "uncovered_area", "uncovered_pixels"]

Float = NDArray[np.float64]


def uncovered_pixels(
    light: BakedLight, surface: Surface, time_seconds: float = 0.0, /
) -> NDArray[np.bool_]:
    """(H, W) pixels that show a surface which no map sees; their mean is the uncovered share."""
    shown = surface.valid
    uncovered = np.zeros(shown.shape, bool)
    position, normal = surface.position[shown], surface.normal[shown]
    uncovered[shown] = ~illuminance_at(light, time_seconds, position, normal)[1]
    return uncovered


def uncovered_area(
    light: BakedLight,
    geometry: Geometry,
    time_seconds: float = 0.0,
    /,
    *,
    samples: int = 4096,
    seed: int = 0,
) -> float:
    """Share of a surface's area, 0…1, that no map sees from either side.

    Triangles of strangers face anywhere, so a point counts as seen if one of its sides is. The
    standard error of `samples` points is at most half of one by their root.
    """
    position, normal = area_points(geometry, samples, seed)
    seen = np.zeros(len(position), bool)
    for side in (normal, -normal):
        seen |= illuminance_at(light, time_seconds, position, side)[1]
    return float(np.mean(~seen)) if len(seen) else 0.0


def area_points(geometry: Geometry, samples: int, seed: int = 0, /) -> tuple[Float, Float]:
    """Points (n, 3) spread evenly over triangles by area, and the triangles' unit normals (n, 3).

    One point in each n-th of the area, in the order of the triangles; none where there is no area.
    """
    corners: Float = np.asarray(geometry.positions, np.float64)[geometry.triangles]
    across: Float = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    doubled: Float = np.linalg.norm(across, axis=1)
    total = float(doubled.sum())
    if not total > 0:
        return np.zeros((0, 3)), np.zeros((0, 3))
    generator = np.random.default_rng(seed)
    at = (np.arange(samples) + generator.uniform(size=samples)) * (total / samples)
    chosen: NDArray[Any] = np.searchsorted(np.cumsum(doubled), at, side="right")
    chosen = np.minimum(chosen, np.flatnonzero(doubled > 0)[-1])
    # Uniform in a triangle: fold the unit square over its diagonal.
    parts = generator.uniform(size=(samples, 2))
    parts = np.where(parts.sum(axis=1, keepdims=True) > 1, 1 - parts, parts)
    weights = np.column_stack([1 - parts.sum(axis=1), parts])
    position: Float = np.einsum("nk,nkc->nc", weights, corners[chosen])
    return position, across[chosen] / doubled[chosen, None]
