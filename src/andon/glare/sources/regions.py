"""Regions of bright pixels that touch on the sphere."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.spaces import View

__all__ = ["connected_regions"]


def connected_regions(bright: NDArray[np.bool_], view: View, /) -> tuple[NDArray[np.int32], int]:
    """(H, W) int32 numbers from 1 of the regions of `bright` (H, W) that touch, also diagonally.

    And how many there are. Latlong pictures have no border at their seam and their poles.
    """
    import cv2

    count, found = cv2.connectedComponents(bright.astype(np.uint8), connectivity=8)
    labels = np.asarray(found, np.int32)
    if view.projection != "latlong":
        return labels, count - 1
    pairs: list[tuple[int, int]] = []
    for shift in (-1, 0, 1):
        pairs += zip(labels[:, 0].tolist(), np.roll(labels[:, -1], shift).tolist(), strict=True)
    # The pixels of the first row all touch at the pole, and those of the last row at the other.
    for row in (labels[0], labels[-1]):
        lit = row[row > 0].tolist()
        pairs += [(lit[0], other) for other in lit[1:]]
    return _united(labels, count, pairs)


def _united(
    labels: NDArray[np.int32], count: int, pairs: list[tuple[int, int]]
) -> tuple[NDArray[np.int32], int]:
    """The labels with the pairs made one, numbered anew without gaps."""
    parent = list(range(count))

    def root(label: int) -> int:
        while parent[label] != label:
            parent[label] = parent[parent[label]]
            label = parent[label]
        return label

    for first, second in pairs:
        if first > 0 and second > 0:
            parent[max(root(first), root(second))] = min(root(first), root(second))
    roots = np.array([root(label) for label in range(count)])
    names, numbers = np.unique(roots, return_inverse=True)
    return numbers.astype(np.int32)[labels], len(names) - 1
