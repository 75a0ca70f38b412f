"""Neighbouring facets of one plane get one luminance: the edge between them then costs nothing."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.lamps.coarse import triangle_areas

__all__ = ["evened"]

Float = NDArray[np.float64]

# Corners closer than this share of the shell are one; planes whose normals agree so well are one.
SAME_CORNER, SAME_PLANE = 1e-5, 1e-6


def evened(corners: Float, luminance: Float, /) -> Float:
    """(n, c) luminance of facets (n, 3, 3), paired where two make a flat quadrilateral.

    Pairs share their longest edges first, as the halves of a rectangle do; flux is kept.
    """
    area = triangle_areas(corners)
    values = luminance.copy()
    paired = np.zeros(len(corners), bool)
    for first, second in _neighbours(corners):
        if paired[first] or paired[second]:
            continue
        both = [first, second]
        values[both] = np.average(luminance[both], axis=0, weights=area[both])
        paired[both] = True
    return values


def _neighbours(corners: Float) -> list[tuple[int, int]]:
    """Pairs of coplanar facets with a common edge, the longest edge first."""
    size = float(np.ptp(corners.reshape(-1, 3), axis=0).max())
    grid = np.rint(corners.reshape(-1, 3) / (SAME_CORNER * size))
    ids = np.unique(grid, axis=0, return_inverse=True)[1].reshape(-1, 3)
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal = across / np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-300)
    start, end = ids.ravel(), np.roll(ids, -1, axis=1).ravel()
    length = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2).ravel()
    owner = {(a, b): i for i, (a, b) in enumerate(zip(start.tolist(), end.tolist(), strict=True))}
    found: list[tuple[float, int, int]] = []
    for (a, b), here in owner.items():
        there = owner.get((b, a))
        if there is None or a > b:
            continue
        first, second = here // 3, there // 3
        if normal[first] @ normal[second] > 1 - SAME_PLANE:
            found.append((-float(length[here]), first, second))
    return [(first, second) for _, first, second in sorted(found)]
