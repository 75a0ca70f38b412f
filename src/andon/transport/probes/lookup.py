"""The tetrahedron around each point, in NumPy: all points walk at once.

A step goes through a face that the point lies beyond, the one with the most negative barycentric
coordinate. Such a walk cannot come back to a cell, whichever face it takes, since the cells are a
regular triangulation (Edelsbrunner 1990); rounding can make it, so steps are counted, and who has
used them up is looked for everywhere. A walk leaves the hull only where no other face is left.

    [a b c]ᵀ = [p0−p3 p1−p3 p2−p3]⁻¹ (p−p3),  d = 1−a−b−c          (the probes paper)
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from andon.transport.probes.space import ProbeSpace

__all__ = ["INSIDE", "barycentric", "search_cells", "step_limit", "walk_cells"]

Float = NDArray[np.float64]
Int = NDArray[np.int32]

# A coordinate is negative below this: rounding of coordinates is some 1e-15.
INSIDE = -1e-13
# No cell, and no facet either.
NOBODY = np.iinfo(np.int32).min


def step_limit(count: int, /) -> int:
    """Steps of a walk among `count` cells: several times straight through."""
    return 64 + 8 * round(count ** (1 / 3))


def barycentric(space: ProbeSpace, points: Float, cells: Int, /) -> Float:
    """(q, 4) coordinates of points (q, 3) in tetrahedra (q,); they sum to 1."""
    first = np.einsum("qij,qj->qi", space.inverses[cells], points - space.origins[cells])
    return np.column_stack([first, 1 - first.sum(axis=1)])


def walk_cells(space: ProbeSpace, points: Float, start: Int, limit: int, /) -> tuple[Int, Int]:
    """Walks from the tetrahedra `start` (q,) to points (q, 3).

    Returns
    -------
    cells : (q,) the last tetrahedron of each.
    exits : (q,) −1: it holds the point; f ≥ 0: the walk has left the hull through the facet f;
        −2: `limit` steps were not enough.
    """
    cells = np.array(start, np.int32)
    before = np.full(len(cells), NOBODY, np.int32)
    exits = np.full(len(cells), -2, np.int32)
    walking = np.arange(len(cells))
    for _ in range(limit):
        if not len(walking):
            break
        here = cells[walking]
        beyond = space.neighbours[here]
        weights = barycentric(space, points[walking], here)
        # Whoever came through a face lies on this side of it, whatever rounding says.
        weights[beyond == before[walking][:, None]] = 1.0
        inner = np.where(beyond >= 0, weights, 1.0)
        rows, face = np.arange(len(walking)), inner.argmin(axis=1)
        last = inner[rows, face] >= INSIDE
        face[last] = weights[last].argmin(axis=1)
        negative, ahead = weights[rows, face] < INSIDE, beyond[rows, face]
        goes = negative & (ahead >= 0)
        exits[walking[~goes]] = np.where(negative, -1 - ahead, -1)[~goes]
        before[walking[goes]] = here[goes]
        walking = walking[goes]
        cells[walking] = ahead[goes]
    return cells, exits


def search_cells(space: ProbeSpace, points: Float, first: int, count: int, /) -> tuple[Int, Float]:
    """Among `count` tetrahedra from `first` on, the one that holds each point (q, 3) best.

    Returns
    -------
    cells : (q,).
    least : (q,) the smallest of its coordinates there; ≥ 0 inside.
    """
    own = slice(first, first + count)
    cells, least = np.zeros(len(points), np.int32), np.full(len(points), -np.inf)
    for number, point in enumerate(points):
        three = np.einsum("mij,mj->mi", space.inverses[own], point - space.origins[own])
        worst = np.minimum(three.min(axis=1), 1 - three.sum(axis=1))
        cells[number], least[number] = first + worst.argmax(), worst.max()
    return cells, least
