"""Dashed lines: Pillow draws none."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["dash_mask"]


def dash_mask(points: NDArray[np.float64], dash_px: float, /) -> NDArray[np.bool_]:
    """(n − 1,) which pieces of a line through `points` (n, 2) are drawn.

    Dashes and gaps are of equal length on the paper, whatever the steps of the points: 1.2·dash_px
    and 0.8·dash_px.
    """
    lengths = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    return lengths[:-1] / dash_px % 2 < 1.2
