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


AROUND = _all_around(DIRECTIONS)


@dataclass(frozen=True, eq=False)
class Sight:
    """What points see all around.

    Attributes
    ----------
    backs : (n,) share of the directions in which the first surface shows its back, 0…1.
    one_sided_backs : (n,) the same of surfaces that have one side only.
    nearest_m : (n,) metres to the nearest surface that a ray met; inf: none did.
    """

    backs: Float
    one_sided_backs: Float
    nearest_m: Float

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
        distance, backs, one_sided = self._around(points)
        return Sight(backs.mean(axis=1), (backs & one_sided).mean(axis=1), distance.min(axis=1))

    def _around(self, points: Float) -> tuple[Float, NDArray[np.bool_], NDArray[np.bool_]]:
        """(n, d) metres to the first surface in each direction; it shows its back; has one side."""
        count = len(points)
        directions = np.tile(AROUND, (count, 1))
        hits = self.rays.first_hits(np.repeat(points, DIRECTIONS, axis=0), directions)
        hit = hits.triangle >= 0
        backs, one_sided = np.zeros_like(hit), np.zeros_like(hit)
        normals = self._normals[hits.triangle[hit]]
        backs[hit] = np.einsum("ij,ij->i", directions[hit], normals) > 0
        one_sided[hit] = self._one_sided[hits.triangle[hit]]
        shape = count, DIRECTIONS
        return hits.distance.reshape(shape), backs.reshape(shape), one_sided.reshape(shape)

    def ways_out(self, points: Float, low: Float, high: Float, margin_m: float, /) -> Float:
        """(n, 3) from `points` (n, 3) through the nearest back to `margin_m` beyond it, metres.

        Of the places that lie in the box from `low` to `high` (3,); NaN where none does.
        """
        distance, backs, _ = self._around(points)
        length = np.where(backs, distance + margin_m, np.inf)
        ends = points[:, None] + np.where(np.isfinite(length), length, 0)[..., None] * AROUND
        length[~((ends >= low) & (ends <= high)).all(axis=2)] = np.inf
        nearest = length.argmin(axis=1)
        reach = length[np.arange(len(points)), nearest]
        return np.where(np.isfinite(reach), reach, np.nan)[:, None] * AROUND[nearest]

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
