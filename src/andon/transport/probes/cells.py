"""Probes are joined: tetrahedra where they fill space, triangles, pieces of a line or one point.

================  ==========================================================================
the probes span   their cells
================  ==========================================================================
space             tetrahedra, and the triangles of the hull
a plane           triangles, counted as facets
a line            pieces from one probe to the next, facets (a, b, b); `facet_neighbours` has
                  the piece beyond b in place 0 and beyond a in place 1
a point           one facet (a, a, a)
================  ==========================================================================

What is thinner than `FLAT` of its extent has a dimension less. On the hull, tetrahedra lower than
the rounding of their positions are taken away again: a lattice that went through float32, as in a
file, has them on all sides, without an inside, and with weights that would be noise. The hull keeps
dents of that depth, and its closest point may jump by as much times the distance in edges.

Checked before anybody sees them: all determinants positive, every inner face of exactly two, a
closed hull, Σ volume = volume of the convex hull within `VOLUME`, every probe in use. What does
not pass is built again with a stronger lift (`delaunay.ATTEMPTS`), and then refused.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import factorial

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.volumes.model import Cells, Zone
from andon.transport.probes.delaunay import (
    ATTEMPTS,
    nearest_distances,
    simplices,
    spatial,
    volumes,
)
from andon.transport.probes.facets import Hull, Tangle, facet_neighbours, hull_of

__all__ = ["DUPLICATE", "FLAT", "SLIVER", "VOLUME", "build_cells"]

Float = NDArray[np.float64]
Int = NDArray[np.int32]

# Shares of a zone's extent.
FLAT = 1e-5
DUPLICATE = 1e-7
# Roundings of the largest coordinate that four corners have at most, each in three coordinates.
SLIVER = 4.0
# Relative; of 1e5 probes the sums agree within 1e-14.
VOLUME = 1e-9
# Metres. Farther is no place of a scene, and squares must not overflow.
FARTHEST_M = 1e9
# Metres; nearer probes are one. Of a zone of a single place nothing else is known.
NEAREST_M = 1e-9
# Keys of faces are three numbers of probes in 63 bits.
MOST_PROBES = 1 << 21


def build_cells(positions: Float, zones: Sequence[Zone] = (), /) -> Cells:
    """The cells between probes, zone by zone.

    Parameters
    ----------
    positions : (n, 3) metres, world; within a zone no two the same.
    zones : at least one probe each, numbers rising; none given: all probes are one zone.

    Raises
    ------
    InputError : no probes, a position that is not finite or beyond 1e9 m, duplicates, a zone
        without probes or with a number out of range, and what cannot be joined.
    MachineError : without SciPy, where there are more than two probes to a zone.
    """
    at = _checked(positions)
    parts = [_zone_cells(at, zone) for zone in zones or (_whole(len(at)),)]
    return _joined(parts)


def _whole(count: int) -> Zone:
    return Zone("all", np.arange(count, dtype=np.int32))


def _checked(positions: Float) -> Float:
    at = np.asarray(positions, np.float64)
    if at.ndim != 2 or at.shape[1:] != (3,) or not 0 < len(at) < MOST_PROBES:
        raise InputError(
            f"must be (n, 3) with 1 ≤ n < {MOST_PROBES}, got {at.shape}",
            field="probe positions",
            remedy="place at least one probe",
        )
    wrong = ~(np.abs(at) <= FARTHEST_M).all(axis=1)
    if wrong.any():
        number = int(wrong.argmax())
        raise InputError(
            f"must be finite and within {FARTHEST_M:g} m, got {at[number].tolist()}",
            field=f"position of probe {number}",
            remedy=f"{int(wrong.sum())} of {len(at)} probes are not there",
        )
    return at


def _zone_probes(zone: Zone, count: int) -> Int:
    probes = np.asarray(zone.probes)
    field = f"zone {zone.name!r}"
    if probes.ndim != 1 or len(probes) == 0:
        raise InputError("has no probes", field=field, remedy="place one in it, or remove it")
    if probes[0] < 0 or probes[-1] >= count or np.any(np.diff(probes) <= 0):
        raise InputError(f"must name probes 0…{count - 1} in rising order", field=field)
    return probes.astype(np.int32)


def _zone_cells(positions: Float, zone: Zone) -> Cells:
    """The cells of one zone, with the numbers that probes have in the volume."""
    probes = _zone_probes(zone, len(positions))
    at = positions[probes]
    centre = (at.min(axis=0) + at.max(axis=0)) / 2
    extent = float(np.ptp(at, axis=0).max())
    if len(probes) == 1:
        return _flat_cells(np.zeros((1, 3), np.int32), np.full((1, 3), -1, np.int32), probes)
    least = max(DUPLICATE, NEAREST_M / max(extent, NEAREST_M))
    lowest = SLIVER * _rounding(at) / max(extent, NEAREST_M)
    at = (at - centre) / max(extent, NEAREST_M)
    axes = _axes(at)
    at = at if len(axes) == 3 else at @ axes.T
    _refuse_duplicates(at, probes, least, zone)
    if len(axes) == 1:
        return _pieces(at[:, 0].argsort(kind="stable"), probes)
    return _meshed(at, probes, zone, lowest)


def _rounding(at: Float) -> float:
    """Metres by which positions may have been rounded: as float32, if they are such numbers."""
    single = np.array_equal(at.astype(np.float32), at)
    return float(np.abs(at).max()) * (2.0**-24 if single else 2.0**-53)


def _refuse_duplicates(at: Float, probes: Int, least: float, zone: Zone) -> None:
    """In the space that they span: of a thin set, also what lies above each other."""
    distances, nearest = nearest_distances(at)
    if distances.min() < least:
        one = int(distances.argmin())
        first, second = sorted((int(probes[one]), int(probes[nearest[one]])))
        raise InputError(
            f"probes {first} and {second} of zone {zone.name!r} are at one place, or so near to it "
            "that nothing is between them",
            field="probe positions",
            remedy="merge them",
        )


def _axes(at: Float) -> Float:
    """(1…3, 3) unit axes along which the points (n, 3) of extent 1 are thicker than `FLAT`."""
    middle = at - at.mean(axis=0)
    axes: Float = np.linalg.svd(middle.T @ middle)[2]
    thick = np.ptp(at @ axes.T, axis=0) > FLAT
    thick[0] = True
    return axes[thick]


def _pieces(order: NDArray[np.intp], probes: Int) -> Cells:
    """A line: from each probe to the next."""
    count = len(order) - 1
    corners = np.column_stack([order[:-1], order[1:], order[1:]]).astype(np.int32)
    own = np.arange(count, dtype=np.int32)
    after = np.where(own + 1 < count, own + 1, -1)
    around = np.column_stack([after, own - 1, np.full(count, -1)]).astype(np.int32)
    return _flat_cells(corners, around, probes)


def _flat_cells(facets: Int, around: Int, probes: Int) -> Cells:
    """A zone without volume."""
    none = np.zeros((0, 4), np.int32)
    return Cells(
        corners=none,
        neighbours=none,
        facets=probes[facets],
        facet_neighbours=around,
        facet_cells=np.full(len(facets), -1, np.int32),
        zone_cells=np.zeros((1, 2), np.int32),
        zone_facets=np.array([[0, len(facets)]], np.int32),
    )


def _meshed(at: Float, probes: Int, zone: Zone, lowest: float) -> Cells:
    """Points (n, 2 or 3) of extent about 1, joined and checked; no hull cells below `lowest`."""
    reason = ""
    for attempt in range(len(ATTEMPTS)):
        try:
            found = simplices(at, attempt=attempt)
            _check(at, found)
            if at.shape[1] == 2:
                return _flat_cells(found, facet_neighbours(found, len(at)), probes)
            hull = hull_of(found, len(at))
            return _full_cells(*_without_slivers(at, found, hull, lowest), probes)
        except (RuntimeError, Tangle) as error:
            reason = str(error).strip().partition("\n")[0]
    raise InputError(
        f"its {len(at)} probes cannot be joined to cells: {reason}",
        field=f"zone {zone.name!r}",
        remedy="move apart probes that are much closer to each other than to the rest",
    )


def _check(at: Float, found: Int) -> None:
    """Raises `Tangle` where simplices (m, d + 1) do not fill the hull of points (n, d)."""
    volume = volumes(at, found)
    if not np.all(volume > 0):
        raise Tangle("cells without volume")
    unused = np.setdiff1d(np.arange(len(at)), found)
    if len(unused):
        raise Tangle(f"{len(unused)} probes are in no cell")
    whole = float(spatial().ConvexHull(at).volume)
    if abs(float(volume.sum()) / factorial(at.shape[1]) - whole) > VOLUME * whole:
        raise Tangle("the cells do not fill the hull")


def _full_cells(corners: Int, hull: Hull, probes: Int) -> Cells:
    return Cells(
        corners=probes[corners],
        neighbours=hull.neighbours,
        facets=probes[hull.facets],
        facet_neighbours=hull.facet_neighbours,
        facet_cells=hull.facet_cells,
        zone_cells=np.array([[0, len(corners)]], np.int32),
        zone_facets=np.array([[0, len(hull.facets)]], np.int32),
    )


def _without_slivers(at: Float, corners: Int, hull: Hull, lowest: float) -> tuple[Int, Hull]:
    """Tetrahedra lower than `lowest` are taken away, from the hull inwards.

    Not where that would leave a probe alone, or open the hull.
    """
    flat = _least_heights(at, corners) < lowest
    outside = np.zeros(len(corners), bool)
    outside[hull.facet_cells] = True
    gone = flat & outside
    while True:
        beside = (gone[np.maximum(hull.neighbours, 0)] & (hull.neighbours >= 0)).any(axis=1)
        more = flat & ~gone & beside
        if not more.any():
            break
        gone |= more
    keep = ~gone
    if keep.all() or len(np.unique(corners[keep])) < len(at):
        return corners, hull
    try:
        return corners[keep], hull_of(corners[keep], len(at))
    except Tangle:
        return corners, hull


def _least_heights(at: Float, corners: Int) -> Float:
    """(m,) the lowest height of each tetrahedron: thrice its volume by its largest face."""
    p = at[corners]
    sides = [(1, 2, 3), (0, 2, 3), (0, 1, 3), (0, 1, 2)]
    areas = [np.linalg.norm(np.cross(p[:, b] - p[:, a], p[:, c] - p[:, a]), axis=1)
             for a, b, c in sides]  # fmt: skip
    return volumes(at, corners) / np.max(areas, axis=0)


def _joined(parts: list[Cells]) -> Cells:
    """The zones' cells in one list; numbers of cells and facets move by what is before them."""
    cells = np.cumsum([0, *(len(part.corners) for part in parts)])
    facets = np.cumsum([0, *(len(part.facets) for part in parts)])
    neighbours: list[Int] = []
    around: list[Int] = []
    behind: list[Int] = []
    for part, cell, facet in zip(parts, cells.tolist(), facets.tolist(), strict=False):
        neighbours.append(_moved(part.neighbours, cell, facet))
        around.append(_moved(part.facet_neighbours, facet, 0))
        behind.append(_moved(part.facet_cells, cell, 0))
    return Cells(
        corners=np.concatenate([part.corners for part in parts]),
        neighbours=np.concatenate(neighbours),
        facets=np.concatenate([part.facets for part in parts]),
        facet_neighbours=np.concatenate(around),
        facet_cells=np.concatenate(behind),
        zone_cells=np.column_stack([cells[:-1], np.diff(cells)]).astype(np.int32),
        zone_facets=np.column_stack([facets[:-1], np.diff(facets)]).astype(np.int32),
    )


def _moved(numbers: Int, by: int, below: int) -> Int:
    """Numbers ≥ 0 moved up by `by`, those < 0 down by `below`."""
    return numbers + np.where(numbers < 0, -below, by).astype(np.int32)
