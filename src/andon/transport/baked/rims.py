"""Rims that no map sees: of things with edges finer than a map's texels, a pixel or two wide.

They would be dark lines in the picture. So they take the light of what lies beside them in it,
by how near that is and how alike it faces; they still count as not covered. What is farther from
covered surface than `REACH` pixels gets nothing: that is a gap of the maps, and no rim.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.quantities import Surface

__all__ = ["REACH", "with_rims"]

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]

# Pixels, as in rims.wgsl.
REACH = 2
# What faces another way counts for so much less: across an edge there is nothing better.
LEAST_ALIKE = 0.05


def with_rims(lux: Float, covered: Bool, surface: Surface, depth_tolerance_m: float, /) -> Float:
    """The picture `lux` (H, W, 3) with the light of its rims; `covered` (H, W) pixels stay."""
    rows, columns = np.nonzero(surface.valid & ~covered)
    height, width = covered.shape
    total, weights = np.zeros((len(rows), 3)), np.zeros(len(rows))
    for down in range(-REACH, REACH + 1):
        for right in range(-REACH, REACH + 1):
            at = np.clip(rows + down, 0, height - 1), np.clip(columns + right, 0, width - 1)
            away = _away(surface, (rows, columns), at, depth_tolerance_m)
            weight = _likeness(surface, (rows, columns), at) / (1 + away**2)
            weight = np.where(covered[at], weight, 0.0)  # of a hole it is NaN
            total += weight[:, None] * lux[at]
            weights += weight
    found = weights > 0
    filled = lux.copy()
    filled[rows[found], columns[found]] = total[found] / weights[found][:, None]
    return filled


Place = tuple[NDArray[np.int64], NDArray[np.int64]]


def _likeness(surface: Surface, one: Place, other: Place) -> Float:
    cosine = np.einsum("ij,ij->i", surface.normal[one], surface.normal[other])
    return LEAST_ALIKE + np.maximum(cosine, 0)


def _away(surface: Surface, one: Place, other: Place, tolerance_m: float) -> Float:
    """Distances in tolerances; NaN of holes."""
    return np.linalg.norm(surface.position[one] - surface.position[other], axis=1) / tolerance_m
