"""Triangles cut finer where the lamp sees them large, without cracks between neighbours."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.lamps.solids import quarters

__all__ = ["cut_long", "widest_edge"]

Float = NDArray[np.float64]


def _edge_angles(corners: Float) -> Float:
    """Angles (n, 3) in rad of the edges k…k + 1 of triangles (n, 3, …), seen from the origin."""
    a = corners[..., :3]
    b = np.roll(a, -1, axis=1)
    across = np.linalg.norm(np.cross(a, b), axis=2)
    return np.arctan2(across, np.einsum("nki,nki->nk", a, b))


def widest_edge(corners: Float, /) -> float:
    """The largest angle in rad under which the origin sees an edge of triangles (n, 3, 3)."""
    return float(_edge_angles(corners).max())


def cut_long(corners: Float, /, *, radians: float, most: int) -> Float:
    """Triangles (m, 3, c) whose edges are seen from the origin under at most `radians`.

    `corners` (n, 3, c) has positions in its first three columns; the others are interpolated.
    Whether an edge is cut depends on the edge alone, so both its triangles agree. Stops before
    there are more than `most`.
    """
    while True:
        long = _edge_angles(corners) > radians
        # Every cut edge of a triangle makes one triangle more.
        if not long.any() or len(corners) + np.count_nonzero(long) > most:
            return corners
        corners = _cut(corners, long)


def _cut(corners: Float, long: NDArray[np.bool_]) -> Float:
    cuts = long.sum(axis=1)
    # Turned so that the cut edges come first: a triangle with one has it first, with two last not.
    only, spared = np.argmax(long, axis=1), np.argmin(long, axis=1)
    begin = np.asarray(np.where(cuts == 1, only, spared + 1), np.int64)
    order = (begin[:, None] + np.arange(3)) % 3
    turned = np.take_along_axis(corners, order[..., None], axis=1)
    a, b, c = (turned[:, k] for k in range(3))
    ab, bc = (a + b) / 2, (b + c) / 2
    one, two = cuts == 1, cuts == 2
    parts = [corners[cuts == 0], quarters(corners[cuts == 3])]
    parts += [np.stack(piece, axis=1)[one] for piece in ((a, ab, c), (ab, b, c))]
    parts += [np.stack(piece, axis=1)[two] for piece in ((ab, b, bc), (a, ab, bc), (a, bc, c))]
    return np.concatenate(parts)
