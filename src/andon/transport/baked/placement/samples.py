"""Points on triangles that stand for equal areas."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.quantities import Geometry

__all__ = ["Samples", "surface_samples"]

Float = NDArray[np.float64]

# Steps of the plane's most even additive sequence: 1/g and 1/g², g³ = g + 1 (Roberts 2018).
EVEN_STEPS = (0.7548776662466927, 0.5698402909980532)


@dataclass(frozen=True, eq=False)
class Samples:
    """Points of a surface. Each has two sides: number k is the front of point k, n + k its back.

    Attributes
    ----------
    points, normals : (n, 3) metres; unit, of the front.
    area_m2 : that each side stands for.
    """

    points: Float
    normals: Float
    area_m2: float

    def side_points(self, sides: NDArray[np.int64], /) -> Float:
        """(m, 3) where sides (m,) lie."""
        return self.points[sides % len(self.points)]

    def side_normals(self, sides: NDArray[np.int64], /) -> Float:
        """(m, 3) unit, away from sides (m,)."""
        count = len(self.points)
        sign = np.where(sides < count, 1.0, -1.0)
        return sign[:, None] * self.normals[sides % count]


def surface_samples(geometry: Geometry, count: int, seed: int, /) -> Samples:
    """`count` points, one in each `count`-th of the area, evenly spread within large triangles.

    All stand for the same area, so that gains are whole numbers and no sum rounds. No samples at
    all where the surface has no area.
    """
    corners = geometry.positions[geometry.triangles]
    a, b, c = np.moveaxis(corners, 1, 0)
    crosses = np.cross(b - a, c - a)
    double = np.sqrt((crosses * crosses).sum(axis=1))
    ends = np.cumsum(double / 2)
    total = float(ends[-1]) if len(ends) else 0.0
    if not total > 0:
        return Samples(np.zeros((0, 3)), np.zeros((0, 3)), 0.0)
    random = np.random.default_rng(seed)
    places = (np.arange(count) + random.random(count)) * (total / count)
    triangle = np.minimum(np.searchsorted(ends, places, side="right"), len(ends) - 1)
    # The last stratum may round past the last triangle that has an area.
    triangle = np.where(double[triangle] > 0, triangle, np.flatnonzero(double)[-1])
    u, v = ((np.arange(count) * step + random.random()) % 1 for step in EVEN_STEPS)
    root = np.sqrt(u)
    weights = np.stack([1 - root, root * (1 - v), root * v], axis=1)
    points = (corners[triangle] * weights[:, :, None]).sum(axis=1)
    return Samples(points, crosses[triangle] / double[triangle, None], total / count)
