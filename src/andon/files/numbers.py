"""One conversion that all readers of numbers share."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["to_float64"]


def to_float64(values: NDArray[Any]) -> NDArray[np.float64]:
    """A float64 copy. Signalling NaNs, which damaged files hold, become plain NaNs silently."""
    with np.errstate(invalid="ignore"):
        return values.astype(np.float64)
