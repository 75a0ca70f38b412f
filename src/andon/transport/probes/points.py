"""What somebody gives as points."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError

__all__ = ["points_of"]


def points_of(values: Any, name: str, /) -> NDArray[np.float64]:
    """(q, 3) float64, in one piece of memory. Raises `InputError` for what is not (q, 3) of reals.

    One point is (1, 3): a (3,) might as well be three numbers of three points.
    """
    given = np.asarray(values)
    shape = given.shape
    if given.dtype.kind not in "fiu" or given.ndim != 2 or shape[1] != 3:
        remedy = "of one point: points[None]" if shape == (3,) else None
        raise InputError(
            f"must be real numbers of shape (q, 3), got {given.dtype} of {shape}",
            field=name,
            remedy=remedy,
        )
    return np.ascontiguousarray(given, np.float64)
