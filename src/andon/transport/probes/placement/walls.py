"""Which points lie inside walls, and where the nearest way out is.

A point inside a solid sees the backs of its faces all around, and so does a point in the rock
behind the walls of a room. Rays tell by the winding of what they hit first; where nothing is hit
the sky is open. Majercik et al. 2021 judge and move probes by the backs that they see, too.

Two-sided sheets (curtains, leaves, and all surfaces of files that do not say) may show their back
to free space. A point behind one sheet sees at most half of the directions end on it: only more
than half is a fault. Surfaces that have one side only are not seen from behind by anybody who
stands in free space: there half as much is one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.quantities import Geometry
from andon.rays import RayScene

__all__ = ["Sight", "Walls", "winding_faults"]

Float = NDArray[np.float64]

# Directions a point is judged by: a share of 0.5 is met within 0.06 (standard deviation of 64
# independent ones; evenly spread ones do better).
DIRECTIONS = 64
# Inside a wall is what sees backs in more than this share of all directions, …
BURIED_SHARE = 0.5
# … or backs of surfaces that have one side only in more than this.
BURIED_SHARE_ONE_SIDED = 0.25
_GOLDEN = (1 + 5**0.5) / 2
# Corners of triangles count as one within this share of the geometry's size: glTF stores float32.
WELD = 1e-6


def _all_around(count: int) -> Float:
    """(count, 3) unit directions, evenly spread (a Fibonacci lattice), none along an axis."""
    index = np.arange(count) + 0.5
    height, turn = 1 - 2 * index / count, 2 * np.pi * index / _GOLDEN
    radius = np.sqrt(1 - height**2)
    return np.column_stack([radius * np.cos(turn), height, radius * np.sin(turn)])


@dataclass(frozen=True, eq=False)
class Sight:
    """What points see all around.

    Attributes
    ----------
    backs : (n,) share of the directions in which the first surface shows its back, 0…1.
    one_sided_backs : (n,) the same of surfaces that have one side only.
    nearest_m : (n,) metres to the nearest surface that a ray met; inf: none did.
    way_out : (n, 3) to the nearest surface whose back is seen, metres; NaN: no back is seen.
    """

    backs: Float
    one_sided_backs: Float
    nearest_m: Float
    way_out: Float

    @property
    def buried(self) -> NDArray[np.bool_]:
        """(n,) inside a wall."""
        return (self.backs > BURIED_SHARE) | (self.one_sided_backs > BURIED_SHARE_ONE_SIDED)


class Walls:
    """Triangles that points may be inside of; none at all is open space."""

    def __init__(self, geometry: Geometry) -> None:
        self.geometry = geometry
        self.rays = RayScene(geometry)
        corners = geometry.positions[geometry.triangles]
        self._normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        one_sided = np.array([not material.two_sided for material in geometry.materials])
        ids = geometry.material_ids
        self._one_sided = one_sided[np.zeros(len(corners), np.int32) if ids is None else ids]

    def sight(self, points: Float, /) -> Sight:
        """What `points` (n, 3) see."""
        around = _all_around(DIRECTIONS)
        count = len(points)
        directions = np.tile(around, (count, 1))
        hits = self.rays.first_hits(np.repeat(points, DIRECTIONS, axis=0), directions)
        hit = hits.triangle >= 0
        facing = np.full(len(directions), -1.0)
        facing[hit] = np.einsum("ij,ij->i", directions[hit], self._normals[hits.triangle[hit]])
        backs = (hit & (facing > 0)).reshape(count, DIRECTIONS)
        one_sided = np.zeros(len(directions), np.bool_)
        one_sided[hit] = self._one_sided[hits.triangle[hit]]
        one_sided_backs = backs & one_sided.reshape(count, DIRECTIONS)
        distance = hits.distance.reshape(count, DIRECTIONS)
        to_back = np.where(backs, distance, np.inf)
        nearest = to_back.argmin(axis=1)
        reach = to_back[np.arange(count), nearest]
        with np.errstate(invalid="ignore"):
            way_out = np.where(np.isfinite(reach), reach, np.nan)[:, None] * around[nearest]
        return Sight(
            backs.mean(axis=1), one_sided_backs.mean(axis=1), distance.min(axis=1), way_out
        )

    def is_free(self, points: Float, /) -> NDArray[np.bool_]:
        """(n,) `points` (n, 3) lie outside of walls."""
        return ~self.sight(points).buried

    def sees(self, points: Float, targets: Float, /) -> NDArray[np.bool_]:
        """(n,) nothing stands between `points` (n, 3) and `targets` (n, 3)."""
        return self.rays.is_visible(points, targets)


def winding_faults(geometry: Geometry, /) -> tuple[int, int]:
    """Edges of three, five, … triangles, and edges whose triangles are wound against each other.

    Corners at one place are one, whatever a file calls them. Edges of one triangle (open sheets)
    are no fault, nor are those of four where two solids touch.
    """
    if len(geometry.triangles) == 0:
        return 0, 0
    size = float(np.ptp(geometry.positions, axis=0).max())
    grid = np.round(geometry.positions / max(size * WELD, 1e-300))
    _, corner = np.unique(grid, axis=0, return_inverse=True)
    triangles = corner.reshape(-1)[geometry.triangles]
    starts, ends = triangles.ravel(), triangles[:, [1, 2, 0]].ravel()
    edges = starts != ends
    starts, ends = starts[edges], ends[edges]
    low, high = np.minimum(starts, ends), np.maximum(starts, ends)
    _, edge, uses = np.unique(
        low * (corner.max() + 1) + high, return_inverse=True, return_counts=True
    )
    balance = np.bincount(edge.reshape(-1), np.where(starts < ends, 1, -1))
    is_odd = uses % 2 == 1
    odd = np.count_nonzero(is_odd & (uses > 1))
    return int(odd), int(np.count_nonzero(~is_odd & (balance != 0)))
