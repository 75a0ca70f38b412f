"""Pairs of pixels whose light is compared."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Pairs", "pairs_of"]

Int = NDArray[np.int64]

# How far near ones lie apart, in shares of the longer side: along rows and columns, and across. The
# nearest say most of edges, the farther ones most of slow changes of light.
STEPS = (1 / 240, 1 / 80, 1 / 40, 1 / 20, 1 / 10, 1 / 5)
DIRECTIONS = ((0, 1), (1, 0), (1, 1), (1, -1))
# Beyond this, colour of light and of materials look alike.
NEAR = 1 / 10


@dataclass(frozen=True, eq=False)
class Pairs:
    """Numbers of blocks `a` and `b` (n,), and which of the pairs are `near` (n,) bool."""

    a: Int
    b: Int
    near: NDArray[np.bool_]

    def some(self, every: int, /) -> Pairs:
        """One of `every` pairs."""
        return Pairs(self.a[::every], self.b[::every], self.near[::every])


def pairs_of(number: Int, near: int, far: int, seed: int, /) -> Pairs:
    """Pairs of the blocks that `number` (h, w) counts, −1 elsewhere: chosen by chance."""
    random = np.random.default_rng(seed)
    first, second, steps = _neighbours(number)
    kept = random.permutation(len(first))[:near]
    blocks = number[number >= 0]
    a, b = random.choice(blocks, far), random.choice(blocks, far)
    return Pairs(
        np.concatenate([first[kept], a]),
        np.concatenate([second[kept], b]),
        np.concatenate([steps[kept] <= NEAR * max(number.shape), np.zeros(far, bool)]),
    )


def _neighbours(number: Int) -> tuple[Int, Int, Int]:
    """All pairs of blocks that `STEPS` lie apart, and by how many blocks they do."""
    height, width = number.shape
    found: list[tuple[Int, Int, Int]] = []
    for step in sorted({max(1, round(share * max(height, width))) for share in STEPS}):
        for down, right in DIRECTIONS:
            dy, dx = down * step, right * step
            if dy >= height or abs(dx) >= width:
                continue
            left = slice(max(0, -dx), width - max(0, dx))
            moved = slice(max(0, dx), width - max(0, -dx))
            a, b = number[: height - dy, left].ravel(), number[dy:, moved].ravel()
            both = (a >= 0) & (b >= 0)
            found.append((a[both], b[both], np.full(int(both.sum()), step)))
    first, second, steps = (np.concatenate(part) for part in zip(*found, strict=True))
    return first, second, steps
