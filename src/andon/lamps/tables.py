"""What all tables of lamps have in common, as numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from andon.lamps.colour import rgb_factors

if TYPE_CHECKING:
    from andon.scene.lamp_base import LampTable

__all__ = ["colour_of", "unit"]

Float = NDArray[np.float64]


def unit(direction: tuple[float, float, float], /) -> Float:
    """(3,) unit vector of a direction of any length > 0."""
    vector = np.array(direction, dtype=np.float64)
    vector /= np.abs(vector).max()  # first, so that squares neither overflow nor vanish
    return vector / np.linalg.norm(vector)


def colour_of(table: LampTable, /) -> Float:
    """(3,) linear Rec.709 factors of photometric value 1."""
    return rgb_factors(
        chromaticity_xy=table.chromaticity_xy,
        temperature_k=table.temperature_k,
        daylight=table.daylight,
        rgb=table.rgb,
    )
