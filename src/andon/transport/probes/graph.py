"""The probes as a graph: what a path finder, or a picture of the cells, starts from.

The probes paper remarks that its tetrahedra, being a partition of the space that can be walked in,
would serve path finding too. `edges` are ways from probe to probe, `Cells.neighbours` from cell to
cell.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.files.volumes.model import Cells

__all__ = ["cell_adjacency", "centres", "edges"]

Float = NDArray[np.float64]
Int = NDArray[np.int32]

TETRAHEDRON_EDGES = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]
FACET_EDGES = [[0, 1], [1, 2], [2, 0]]


def edges(cells: Cells, /) -> Int:
    """(e, 2) pairs of probes that an edge joins, each once, the lower number first, in order."""
    pairs = np.concatenate(
        [
            cells.corners[:, TETRAHEDRON_EDGES].reshape(-1, 2),
            cells.facets[:, FACET_EDGES].reshape(-1, 2),
        ]
    )
    pairs = np.sort(pairs, axis=1)
    found: Int = np.unique(pairs[pairs[:, 0] != pairs[:, 1]], axis=0)
    return found.astype(np.int32)


def cell_adjacency(cells: Cells, /) -> Int:
    """(e, 2) pairs of tetrahedra with a common face, each once, the lower number first."""
    own = np.repeat(np.arange(len(cells.corners), dtype=np.int32), 4)
    pairs = np.column_stack([own, cells.neighbours.ravel()])
    return pairs[pairs[:, 0] < pairs[:, 1]].astype(np.int32)


def centres(cells: Cells, positions: Float, /) -> Float:
    """(m, 3) the middles of the tetrahedra between `positions` (n, 3), metres."""
    middles: Float = np.asarray(positions, np.float64)[cells.corners].mean(axis=1)
    return middles
