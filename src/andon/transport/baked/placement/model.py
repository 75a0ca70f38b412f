"""What a suggestion of cameras says."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from andon.spaces import View

__all__ = ["Ended", "Suggested"]

Float = NDArray[np.float64]

# Why no further camera was added.
Ended = Literal["reached", "nothing gained", "most cameras"]


@dataclass(frozen=True, eq=False)
class Suggested:
    """Cameras for illuminance maps, and what they see of the surface.

    Attributes
    ----------
    views : those of the frame first, then those that were found, in the order of their gain.
    coverage : share of the reachable surface that the views see well, 0…1.
    reachable_area_m2 : of the sides of surface that anything in free space sees.
    adds_m2 : for each view, what it sees well and none before it does.
    ended : why there is no further camera.
    frame_count : that many of the views are the frame's own.
    candidates : (p, 3) metres, all places in free space that cameras were looked for at.
    points, normals : (n, 3) samples of the reachable surface, all of equal area; normals are
        unit, of the side that is seen.
    first_seen_by : (n,) number of the first view that sees a sample well, −1: none does.
    """

    views: tuple[View, ...]
    coverage: float
    reachable_area_m2: float
    adds_m2: tuple[float, ...]
    ended: Ended
    frame_count: int
    candidates: Float
    points: Float
    normals: Float
    first_seen_by: NDArray[np.int64]

    @property
    def covered_area_m2(self) -> float:
        """What the views see well."""
        return self.coverage * self.reachable_area_m2

    @property
    def coverage_so_far(self) -> tuple[float, ...]:
        """Share of the reachable surface after each view."""
        whole = max(self.reachable_area_m2, 1e-300)
        return tuple(float(area) / whole for area in np.cumsum(self.adds_m2))
