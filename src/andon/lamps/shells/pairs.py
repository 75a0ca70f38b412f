"""Neighbouring facets of one plane get one luminance: the edge between them then costs nothing."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["evened", "flat_pairs"]

Float = NDArray[np.float64]

# Corners closer than this share of the shell are one; planes whose normals agree so well are one.
SAME_CORNER, SAME_PLANE = 1e-5, 1e-6


def flat_pairs(corners: Float, /) -> NDArray[np.int32]:
    """(n,) a number for each facet (n, 3, 3), shared by two that make a flat quadrilateral.

    Pairs share their longest edges first, as the halves of a rectangle do. From the form alone:
    what shines alike is then the same for every beam and at all times.
    """
    number = np.arange(len(corners), dtype=np.int32)
    paired = np.zeros(len(corners), bool)
    for first, second in _neighbours(corners):
        if not (paired[first] or paired[second]):
            paired[[first, second]] = True
            number[second] = first
    return number


def evened(luminance: Float, area: Float, number: NDArray[np.int32], /) -> Float:
    """(n, c) luminance, made one for facets of one `number` (n,) by their `area` (n,).

    Flux is kept.
    """
    share = area / np.bincount(number, area)[number]
    columns = [np.bincount(number, share * column)[number] for column in luminance.T]
    return np.stack(columns, axis=1, dtype=np.float64)


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
