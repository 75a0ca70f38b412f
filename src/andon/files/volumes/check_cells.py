"""What must hold between the tetrahedra, facets and zones of a probe volume.

A lookup walks from cell to cell without asking whether they fit together, so everything that it
takes for granted is checked once, here.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.volumes.model import FACES, Cells, Zone

__all__ = ["check_cells"]

Int = NDArray[np.int64]
Refuse = Callable[[str, str], InputError]
# Corners of the edge opposite each corner of a facet.
EDGES = np.array([[1, 2], [0, 2], [0, 1]])


def check_cells(
    cells: Cells, positions: NDArray[np.float64], zones: tuple[Zone, ...], file: str | None = None
) -> None:
    """Refuses cells that a lookup could get lost in.

    Parameters
    ----------
    cells : in the terms of `Cells`.
    positions : (n, 3) of the probes, metres.
    zones : whose cells these are.
    file : for the message.

    Raises
    ------
    InputError
        names the first tetrahedron or facet that breaks a rule, and the rule.
    """

    def refuse(field: str, rule: str) -> InputError:
        return InputError(rule, file=file, field=f"cells.{field}")

    _check_shapes(cells, len(positions), len(zones), refuse)
    _check_zones(cells, zones, refuse)
    _check_volumes(cells, positions, refuse)
    _check_neighbours(cells, refuse)
    _check_hull(cells, positions, refuse)
    _check_facet_neighbours(cells, refuse)


def _first(wrong: NDArray[np.bool_]) -> int | None:
    """The number of the first row with something wrong in it."""
    if not wrong.any():
        return None
    return int(np.flatnonzero(wrong.reshape(len(wrong), -1).any(axis=1))[0])


def _check_shapes(cells: Cells, probes: int, zones: int, refuse: Refuse) -> None:
    count, facets = len(cells.corners), len(cells.facets)
    bounds: dict[str, tuple[NDArray[Any], tuple[int, ...], int, int]] = {
        "corners": (cells.corners, (count, 4), 0, probes),
        "neighbours": (cells.neighbours, (count, 4), -facets, count),
        "facets": (cells.facets, (facets, 3), 0, probes),
        "facetNeighbours": (cells.facet_neighbours, (facets, 3), -1, facets),
        "facetCells": (cells.facet_cells, (facets,), -1, count),
        "zoneCells": (cells.zone_cells, (zones, 2), 0, count + 1),
        "zoneFacets": (cells.zone_facets, (zones, 2), 0, facets + 1),
    }
    for name, (values, shape, low, below) in bounds.items():
        if values.shape != shape:
            raise refuse(name, f"must have the shape {shape}, has {values.shape}")
        row = _first((values < low) | (values >= below))
        if row is not None:
            raise refuse(f"{name}[{row}]", f"must be {low}…{below - 1}, is {values[row].tolist()}")


def _check_zones(cells: Cells, zones: tuple[Zone, ...], refuse: Refuse) -> None:
    """Each zone has its own run of tetrahedra and of facets, between its own probes."""
    lists = (
        ("zoneCells", cells.zone_cells, "corners", cells.corners),
        ("zoneFacets", cells.zone_facets, "facets", cells.facets),
    )
    for name, runs, members, corners in lists:
        ends = np.cumsum(runs[:, 1])
        if not np.array_equal(runs[:, 0], ends - runs[:, 1]) or ends[-1] != len(corners):
            raise refuse(name, f"must be runs that follow one another and cover all {members}")
        for number, (first, count) in enumerate(runs):
            row = _first(~np.isin(corners[first : first + count], zones[number].probes))
            if row is not None:
                raise refuse(
                    f"{members}[{first + row}]", f"has a probe outside its zone, zones[{number}]"
                )
    number = _first(cells.zone_facets[:, 1:] == 0)
    if number is not None:
        raise refuse(f"zoneFacets[{number}]", "a zone must have a facet or more")
    _check_borders(cells, refuse)


def _check_borders(cells: Cells, refuse: Refuse) -> None:
    """No neighbour lies in another zone."""
    zones = len(cells.zone_cells)
    owner = np.repeat(np.arange(zones), cells.zone_cells[:, 1])
    facet_owner = np.repeat(np.arange(zones), cells.zone_facets[:, 1])
    inside = cells.neighbours >= 0
    beyond = np.where(
        inside,
        owner[np.where(inside, cells.neighbours, 0)] if len(owner) else 0,
        facet_owner[np.where(inside, 0, -1 - cells.neighbours)],
    )
    row = _first(beyond != owner[:, None])
    if row is not None:
        raise refuse(f"neighbours[{row}]", "must lie in the same zone")
    across = facet_owner[np.maximum(cells.facet_neighbours, 0)] != facet_owner[:, None]
    row = _first(across & (cells.facet_neighbours >= 0))
    if row is not None:
        raise refuse(f"facetNeighbours[{row}]", "must lie in the same zone")


def _check_volumes(cells: Cells, positions: NDArray[np.float64], refuse: Refuse) -> None:
    row = _first(~(_determinants(positions[cells.corners]) > 0))
    if row is not None:
        raise refuse(
            f"corners[{row}]",
            "p0−p3, p1−p3, p2−p3 must have a positive determinant: the tetrahedron is flat or "
            "turned round",
        )


def _determinants(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """(m,) six times the signed volumes of (m, 4, 3) corners."""
    a, b, c = (corners[:, i] - corners[:, 3] for i in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c))


def _check_neighbours(cells: Cells, refuse: Refuse) -> None:
    """Whoever has a neighbour beyond a face is its neighbour beyond the same face."""
    faces = np.sort(cells.corners[:, FACES], axis=-1)
    cell, side = np.nonzero(cells.neighbours >= 0)
    other = cells.neighbours[cell, side]
    same = (faces[other] == faces[cell, side][:, None, :]).all(axis=-1)
    agreed = (same & (cells.neighbours[other] == cell[:, None])).any(axis=1)
    row = _first(~agreed)
    if row is not None:
        raise refuse(
            f"neighbours[{cell[row]}][{side[row]}]",
            f"must agree: tetrahedra {cell[row]} and {other[row]} do not share that face",
        )


def _check_hull(cells: Cells, positions: NDArray[np.float64], refuse: Refuse) -> None:
    """Facets and the tetrahedra behind them name each other; facets look outwards."""
    cell, side = np.nonzero(cells.neighbours < 0)
    facet = -1 - cells.neighbours[cell, side]
    faces = np.sort(cells.corners[cell[:, None], FACES[side]], axis=-1)
    same = (np.sort(cells.facets[facet], axis=-1) == faces).all(axis=-1)
    row = _first(~(same & (cells.facet_cells[facet] == cell)))
    if row is not None:
        raise refuse(
            f"neighbours[{cell[row]}][{side[row]}]", f"must agree with the facet {facet[row]}"
        )
    named = np.bincount(facet, minlength=len(cells.facets))
    row = _first(named != (cells.facet_cells >= 0))
    if row is not None:
        raise refuse(f"facetCells[{row}]", "must be the one tetrahedron that has that facet, or −1")
    apex = cells.corners[cell, side]
    corners = np.concatenate([cells.facets[facet], apex[:, None]], axis=1)
    row = _first(~(_determinants(positions[corners]) > 0))
    if row is not None:
        raise refuse(f"facets[{facet[row]}]", "must run counter-clockwise, seen from outside")


def _check_facet_neighbours(cells: Cells, refuse: Refuse) -> None:
    """Neighbouring facets name each other and share the edge; pieces of a line share a corner."""
    facet, side = np.nonzero(cells.facet_neighbours >= 0)
    other = cells.facet_neighbours[facet, side]
    back = (cells.facet_neighbours[other] == facet[:, None]).any(axis=1)
    edge = cells.facets[facet[:, None], EDGES[side]]
    shared = (cells.facets[other][:, None, :] == edge[:, :, None]).any(axis=-1)
    triangles = np.array([len(set(corners)) == 3 for corners in cells.facets.tolist()], bool)
    fits = shared.all(axis=1) | (shared.any(axis=1) & ~triangles[facet])
    row = _first(~(back & fits))
    if row is not None:
        raise refuse(
            f"facetNeighbours[{facet[row]}][{side[row]}]",
            f"must agree: facets {facet[row]} and {other[row]} do not share that edge",
        )
