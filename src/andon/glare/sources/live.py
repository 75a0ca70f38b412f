"""Sources in a frame, found anew in each: only bright pixels are looked at."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from andon.glare.model import Source
from andon.glare.sources.moments import pixel_moments, sources_of
from andon.glare.sources.regions import connected_regions
from andon.quantities import photometric
from andon.spaces import View

__all__ = ["sources_of_bright"]

Float = NDArray[np.float64]


def sources_of_bright(
    bright: NDArray[np.bool_],
    light_of: Callable[[NDArray[np.intp], NDArray[np.intp]], Float],
    solid_angles_sr: Float,
    view: View,
    /,
    *,
    most: int,
) -> list[Source]:
    """The `most` strongest regions of touching bright pixels, strongest first.

    Regions are not merged, so that a source does not jump to its neighbour when they come near.

    Parameters
    ----------
    bright : (H, W) bool.
    light_of : rows (n,), columns (n,) → luminance (n, 3) cd/m² ≥ 0 of these pixels.
    solid_angles_sr : (H, W) of the view's pixels.
    """
    if not bright.any():
        return []
    regions, count = connected_regions(bright, view)
    rows, columns = np.nonzero(regions)
    light, solid = light_of(rows, columns), solid_angles_sr[rows, columns]
    region = regions[rows, columns] - 1
    power = np.bincount(region, photometric(light) * solid, count)
    strongest = np.argsort(-power, kind="stable")[:most]
    place = np.full(count, -1)
    place[strongest] = np.arange(len(strongest))
    kept = place[region] >= 0
    directions = view.directions_at(np.stack([columns[kept], rows[kept]], axis=-1))
    found = place[region[kept]]
    return sources_of(
        pixel_moments(directions, light[kept], solid[kept], found, len(strongest)), name="frame"
    )
