"""Places for probes from geometry, from a box, and by chance."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.quantities import Geometry
from andon.scene.probes import Placement
from andon.transport.probes.placement.clearance import clear_of, nearest_within, off_surfaces
from andon.transport.probes.placement.model import Tally
from andon.transport.probes.placement.spread import Spread, spread
from andon.transport.probes.placement.walls import WELD, Walls

__all__ = ["MAX_PROBES", "Generated", "from_vertices", "lattice", "random_places"]

Float = NDArray[np.float64]

# Each probe is six pictures and nine triples: more than this is a mistaken unit or spacing.
MAX_PROBES = 100_000
# Rays from a vertex start this share of its offset above it, so as not to hit its own triangles.
LIFT = 1e-2
# Random places are sought this many times as often as they are asked for; what is dense is full.
TRIES_PER_PROBE = 200
# Moved probes stay within this share of the lattice's smallest step of where they were.
MOVE_SHARE = 0.45
# Places off a vertex keep less than the offset where walls meet: 1/√3 of it in a corner of three.
# Nearer than this share of it they are on another surface.
VERTEX_SHARE = 0.1


@dataclass(frozen=True, eq=False)
class Generated:
    """Positions (n, 3) in metres with a name each, and what became of the others."""

    positions: Float
    names: tuple[str, ...]
    tally: Tally = field(default_factory=Tally)


def box_of(placement: Placement, geometry: Geometry, file: str) -> tuple[Float, Float]:
    """Lowest and highest corner (3,) of the placement's box: its own, else the surface's."""
    if (placement.low is None or placement.high is None) and len(geometry.triangles) == 0:
        raise InputError(
            f"kind {placement.kind!r} needs a box, and there is no surface to take it from",
            file=file,
            field="probes.placement",
            remedy="give low and high, or a [surface]",
        )
    used = geometry.positions[geometry.triangles.ravel()]
    low = used.min(axis=0) if placement.low is None else np.array(placement.low)
    high = used.max(axis=0) if placement.high is None else np.array(placement.high)
    if not (low <= high).all():
        raise InputError(
            f"must be above low, which is {_triple(low)}, in x, y and z, got {_triple(high)}",
            file=file,
            field="probes.placement.high",
        )
    return low, high


def _triple(point: Float) -> str:
    return ", ".join(f"{value:g}" for value in point)


def from_vertices(placement: Placement, walls: Walls, file: str) -> Generated:
    """Off the vertices of the surface, along their normals, no nearer than the least distance.

    A vertex's normal is the mean of its triangles' weighted by their areas, corners at one place
    counting as one. Places in the file's order; those inside or behind another wall are dropped,
    and those outside of the placement's box, if it states one, do not count at all.
    """
    geometry = walls.geometry
    if len(geometry.triangles) == 0:
        raise InputError(
            "kind 'vertices' needs a surface",
            file=file,
            field="probes.placement.kind",
            remedy="give a [surface], or another kind",
        )
    low = -np.inf if placement.low is None else np.array(placement.low)
    high = np.inf if placement.high is None else np.array(placement.high)
    corners, normals = _welded(geometry)
    length = np.linalg.norm(normals, axis=1)
    # Sheets with two sides of triangles have no outside: the sum is nothing but rounding.
    has_side = length > 1e-9 * max(float(length.max(initial=0.0)), 1e-300)
    corners, normals = corners[has_side], normals[has_side] / length[has_side, None]
    places = corners + normals * placement.offset_m
    inside = ((places >= low) & (places <= high)).all(axis=1)
    corners, normals, places = corners[inside], normals[inside], places[inside]
    hidden = np.zeros(len(places), np.bool_)
    if placement.offset_m > 0:
        hidden = ~walls.sees(corners + normals * placement.offset_m * LIFT, places)
    least = VERTEX_SHARE * placement.offset_m
    tight = ~hidden & (nearest_within(places, geometry, least).distance_m < least)
    free = np.flatnonzero(~hidden & ~tight)
    judge = _Judge(walls)
    taken, crowded = spread(
        places[free],
        Spread(placement.min_distance_m),
        allowed=judge if placement.offset_m > 0 else None,
        most=MAX_PROBES + 1,
    )
    _check_count(len(taken), file, "min_distance_m", "ask for more distance between them")
    numbers = free[taken]
    return Generated(
        places[numbers],
        tuple(f"vertex-{number}" for number in numbers.tolist()),
        Tally(
            hidden=int(np.count_nonzero(hidden)),
            dropped_in_walls=judge.refused,
            too_near=int(np.count_nonzero(tight)),
            crowded=crowded,
        ),
    )


class _Judge:
    """Lets free places pass and counts the others."""

    def __init__(self, walls: Walls, clearance_m: float = 0.0) -> None:
        self._walls, self._clearance = walls, clearance_m
        self.refused = self.too_near = 0

    def __call__(self, points: Float) -> NDArray[np.bool_]:
        free = self._walls.is_free(points)
        self.refused += int(np.count_nonzero(~free))
        if self._clearance > 0:
            near = nearest_within(points[free], self._walls.geometry, self._clearance)
            tight = near.distance_m < self._clearance
            self.too_near += int(np.count_nonzero(tight))
            free[free] = ~tight
        return free


def _welded(geometry: Geometry) -> tuple[Float, Float]:
    """Corners (k, 3) in the order they are first used, and their normals times areas (k, 3)."""
    size = float(np.ptp(geometry.positions, axis=0).max(initial=0.0))
    grid = np.round(geometry.positions / max(size * WELD, 1e-300))
    _, first, corner = np.unique(grid, axis=0, return_index=True, return_inverse=True)
    triangles = corner.reshape(-1)[geometry.triangles]
    a, b, c = (geometry.positions[geometry.triangles[:, i]] for i in range(3))
    twice_areas = np.cross(b - a, c - a)
    normals = np.zeros((len(first), 3))
    for side in range(3):
        np.add.at(normals, triangles[:, side], twice_areas)
    used = np.unique(triangles)
    order = used[np.argsort(first[used], kind="stable")]
    return geometry.positions[first[order]], normals[order]


def lattice(placement: Placement, walls: Walls, file: str) -> Generated:
    """Corners of equal boxes that fill the placement's box, less its margin.

    A place inside a wall is moved to the nearest free one that rays find in the box within half a
    step, and one nearer to a surface than the margin away from it; where there is none it is left
    out. Where no place at all is free, none is moved.
    """
    low, high = box_of(placement, walls.geometry, file)
    counts = _counts(placement, high - low - 2 * placement.offset_m)
    _check_count(
        counts[0] * counts[1] * counts[2], file, "spacing_m", "ask for larger steps", of="lattice"
    )
    axes = [_steps(low[i], high[i], placement.offset_m, counts[i]) for i in range(3)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    numbers = np.indices(counts).reshape(3, -1).T.tolist()
    names = tuple(f"lattice-{i}-{j}-{k}" for i, j, k in numbers)
    steps = [float(axis[1] - axis[0]) for axis in axes if len(axis) > 1]
    reach = MOVE_SHARE * min(steps, default=float("inf"))
    # Out of a box without thickness a place may move, or it could not move at all.
    flat = high <= low
    box = np.where(flat, -np.inf, low), np.where(flat, np.inf, high)
    off = off_surfaces(walls.geometry, points, placement.offset_m)
    places, free = _out_of_walls(off, walls, box, reach, placement.offset_m)
    kept, near = free.copy(), np.flatnonzero(free)
    places[near], kept[near] = clear_of(walls.geometry, places[near], placement.offset_m)
    gone = np.linalg.norm(places - points, axis=1)
    kept[near] &= (gone[near] <= max(reach, placement.offset_m)) & walls.is_free(places[near])
    tally = Tally(
        moved=int(np.count_nonzero(kept & (gone > 0))),
        dropped_in_walls=int(np.count_nonzero(~free)),
        too_near=int(np.count_nonzero(free & ~kept)),
    )
    return Generated(
        places[kept], tuple(n for n, keep in zip(names, kept, strict=True) if keep), tally
    )


def _counts(placement: Placement, extent: Float) -> tuple[int, int, int]:
    if placement.counts is not None:
        return placement.counts
    assert placement.spacing_m is not None  # the table's own rule
    x, y, z = (max(round(float(side) / placement.spacing_m), 0) + 1 for side in extent)
    return x, y, z


def _steps(low: float, high: float, margin: float, count: int) -> Float:
    """(count,) coordinates; the middle where there is one, or no room for the margins."""
    if count == 1 or high - low <= 2 * margin:
        return np.full(1 if count == 1 else count, (low + high) / 2)
    return np.linspace(low + margin, high - margin, count)


def _out_of_walls(
    points: Float, walls: Walls, box: tuple[Float, Float], reach_m: float, margin_m: float
) -> tuple[Float, NDArray[np.bool_]]:
    """The points with those in walls moved out, and which of them are free."""
    kept = walls.is_free(points)
    if not kept.any():  # a surface that is inside out: the way out would lead out of the room
        return points.copy(), kept
    stuck = np.flatnonzero(~kept)
    ways = walls.ways_out(points[stuck], *box, margin_m)
    near = np.linalg.norm(ways, axis=1) <= reach_m  # not so where there is none: NaN
    stuck, targets = stuck[near], points[stuck[near]] + ways[near]
    free = walls.is_free(targets)
    places = points.copy()
    places[stuck[free]] = targets[free]
    kept[stuck[free]] = True
    return places, kept


def random_places(placement: Placement, walls: Walls, seed: int, file: str) -> Generated:
    """Places by chance in the free space of the box, no nearer than the least distance.

    Dart throwing (Cook 1986): places are drawn evenly in the box and taken in turn where they are
    free, as far from surfaces as the margin, and not too near to one that was taken.
    """
    low, high = box_of(placement, walls.geometry, file)
    generator = np.random.default_rng([seed, *b"probes"])
    margin = np.minimum(placement.offset_m, (high - low) / 2)
    accepted = Spread(placement.min_distance_m)
    judge = _Judge(walls, placement.offset_m)
    parts: list[Float] = []
    crowded = 0
    for _ in range(TRIES_PER_PROBE):
        darts = generator.uniform(low + margin, high - margin, (placement.count, 3))
        taken, near = spread(darts, accepted, allowed=judge, most=placement.count)
        parts.append(darts[taken])
        crowded += near
        if accepted.count >= placement.count:
            break
    positions = np.concatenate(parts)
    names = tuple(f"random-{number}" for number in range(1, len(positions) + 1))
    return Generated(positions, names, _counted(judge, crowded))


def _counted(judge: _Judge, crowded: int) -> Tally:
    return Tally(dropped_in_walls=judge.refused, too_near=judge.too_near, crowded=crowded)


def _check_count(count: int, file: str, key: str, remedy: str, *, of: str = "placement") -> None:
    if count > MAX_PROBES:
        raise InputError(
            f"the {of} has more than {MAX_PROBES} probes",
            file=file,
            field=f"probes.placement.{key}",
            remedy=remedy,
        )
