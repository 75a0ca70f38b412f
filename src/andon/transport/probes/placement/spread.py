"""Points that keep their distance from each other."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product

import numpy as np
from numpy.typing import NDArray

__all__ = ["Spread", "spread"]

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]
Cell = tuple[int, int, int]

NEIGHBOURS: tuple[Cell, ...] = tuple(product((-1, 0, 1), repeat=3))  # type: ignore[assignment]
# Candidates that are judged together: large enough for rays in bulk, small enough that few are
# judged in vain.
BATCH = 2048


class Spread:
    """Accepted points in a hash of cubes as wide as the least distance (metres, ≥ 0)."""

    def __init__(self, distance: float) -> None:
        self.distance = distance
        self.count = 0
        self._cells: dict[Cell, list[tuple[float, float, float]]] = {}

    def _cell(self, point: Float) -> Cell:
        # Python's integers: far places over small distances overflow 64 bits.
        x, y, z = (int(v) for v in np.floor(point / self.distance).tolist())
        return x, y, z

    def is_near(self, point: Float, /) -> bool:
        """An accepted point is nearer to `point` (3,) than the least distance."""
        if self.distance <= 0:
            return False
        i, j, k = self._cell(point)
        x, y, z = point.tolist()
        limit = self.distance**2
        return any(
            (x - a) ** 2 + (y - b) ** 2 + (z - c) ** 2 < limit
            for u, v, w in NEIGHBOURS
            for a, b, c in self._cells.get((i + u, j + v, k + w), ())
        )

    def add(self, point: Float, /) -> None:
        """Accepts `point` (3,)."""
        self.count += 1
        if self.distance > 0:
            x, y, z = point.tolist()
            self._cells.setdefault(self._cell(point), []).append((x, y, z))


def spread(
    candidates: Float,
    accepted: Spread,
    /,
    *,
    allowed: Callable[[Float], Bool] | None = None,
    most: int,
) -> tuple[NDArray[np.int64], int]:
    """Numbers of the candidates (n, 3) that are taken in turn, and how many came too near.

    A candidate is taken where `allowed` (of (k, 3) points) and no nearer to an accepted one than
    the least distance: the first come are served first, so the outcome depends on nothing but
    their order. It ends when `accepted` has `most` points.
    """
    taken: list[int] = []
    crowded = 0
    for start in range(0, len(candidates), BATCH):
        batch = candidates[start : start + BATCH]
        near = np.array([accepted.is_near(point) for point in batch], np.bool_)
        crowded += int(np.count_nonzero(near))
        left = np.flatnonzero(~near)
        if allowed is not None and len(left):
            left = left[allowed(batch[left])]
        for index in left.tolist():
            if accepted.count >= most:
                return np.array(taken, np.int64), crowded
            if accepted.is_near(batch[index]):
                crowded += 1
                continue
            accepted.add(batch[index])
            taken.append(start + index)
    return np.array(taken, np.int64), crowded
