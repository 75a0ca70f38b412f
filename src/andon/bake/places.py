"""The space that placed probes are for: how far anybody will ask."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from andon.files.volumes import Cells
from andon.quantities import Geometry
from andon.transport.probes.placement import Placed

__all__ = ["far_m"]

# Lookups reach at most a cell's longest edge from a probe; surfaces are looked up a little beyond
# the hull as well.
REACH = 1.5
# Where there is one probe and no geometry, metres.
FARTHEST_M = 1e4


def far_m(placed: Placed, cells: Cells, geometry: Sequence[Geometry], /) -> float:
    """What no surface counts as in the distances of the probes, metres.

    The longest edge between joined probes, and some more; of a single probe the size of the scene.
    Rounded up to a power of √2, so that moving one probe leaves what others captured as it is.
    """
    ends = placed.positions[cells.edges]
    longest = float(np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1).max(initial=0.0))
    if longest > 0:
        return float(2.0 ** (np.ceil(2 * np.log2(REACH * longest)) / 2))
    points = [part.positions for part in geometry if len(part.positions)]
    if not points:
        return FARTHEST_M
    return float(np.linalg.norm(np.ptp(np.concatenate(points), axis=0))) or FARTHEST_M
