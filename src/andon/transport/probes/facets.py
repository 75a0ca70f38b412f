"""How simplices and facets hang together: who is behind which face, around which edge.

Faces of a tetrahedron, seen from outside counter-clockwise, by the corner opposite::

          p3            opposite 0: 1 3 2
         /|\\           opposite 1: 0 2 3
        / | \\          opposite 2: 0 3 1
      p0--|--p1         opposite 3: 0 1 2
        \\ | /
          p2
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.files.volumes.model import FACES

__all__ = ["Hull", "Tangle", "face_neighbours", "facet_neighbours", "hull_of", "rings"]

Int = NDArray[np.int32]


class Tangle(ValueError):
    """Not a mesh: a face of three tetrahedra, or an edge of more than two facets."""


@dataclass(frozen=True, eq=False)
class Hull:
    """The outside of tetrahedra.

    Attributes
    ----------
    neighbours : (m, 4) of the tetrahedra; −1 − f: the facet f.
    facets : (f, 3) counter-clockwise from outside.
    facet_neighbours : (f, 3) beyond the edge opposite each corner.
    facet_cells : (f,) the tetrahedron behind.
    """

    neighbours: Int
    facets: Int
    facet_neighbours: Int
    facet_cells: Int


def _partners(sides: NDArray[np.integer], count: int) -> Int:
    """(k,) for each side (k, s), the other side with the same corners; −1: none.

    Raises `Tangle` where more than two have them, or one side twice the same corner.
    """
    ordered = np.sort(sides, axis=1).astype(np.int64)
    key = ordered[:, 0]
    for column in ordered.T[1:]:
        key = key * count + column
    order = np.argsort(key, kind="stable")
    same = key[order][1:] == key[order][:-1]
    if np.any(same[1:] & same[:-1]):
        raise Tangle("more than two share a side")
    partner = np.full(len(sides), -1, np.int32)
    first, second = order[:-1][same], order[1:][same]
    partner[first], partner[second] = second, first
    return partner


def face_neighbours(corners: Int, count: int, /) -> Int:
    """(m, 4) the tetrahedron of `corners` (m, 4) beyond the face opposite each corner; −1: none.

    `count`: how many points there are, below 2²¹.
    """
    partner = _partners(corners[:, FACES].reshape(-1, 3), count)
    return np.where(partner < 0, -1, partner // 4).reshape(-1, 4).astype(np.int32)


def facet_neighbours(facets: Int, count: int, /) -> Int:
    """(f, 3) the triangle of `facets` (f, 3) beyond the edge opposite each corner; −1: none."""
    edges = facets[:, [[1, 2], [2, 0], [0, 1]]].reshape(-1, 2)
    partner = _partners(edges, count)
    return np.where(partner < 0, -1, partner // 3).reshape(-1, 3).astype(np.int32)


def hull_of(corners: Int, count: int, /) -> Hull:
    """Neighbours and hull of tetrahedra (m, 4) among `count` points.

    Raises
    ------
    Tangle : where they are not one closed surface with an inside.
    """
    neighbours = face_neighbours(corners, count)
    cell, face = np.nonzero(neighbours < 0)
    facets = corners[cell[:, None], FACES[face]]
    around = facet_neighbours(facets, count)
    if np.any(around < 0):
        raise Tangle("the hull is not closed")
    neighbours[cell, face] = -1 - np.arange(len(cell))
    return Hull(neighbours, facets.astype(np.int32), around, cell.astype(np.int32))


def rings(facets: Int, zones: Int, count: int, /) -> tuple[NDArray[np.int64], Int]:
    """Which facets touch which: those of its zone that share a corner, itself included.

    Parameters
    ----------
    facets, zones : (f, 3) numbers of `count` probes, (f,) of zones.

    Returns
    -------
    first : (f + 1,) where the list of each facet begins, and the last ends.
    members : (e,) all lists, one after the other.
    """
    own = np.repeat(np.arange(len(facets)), 3)
    _, corner = np.unique(zones[own].astype(np.int64) * count + facets.ravel(), return_inverse=True)
    order = np.argsort(corner, kind="stable")
    size = np.bincount(corner)
    begin = np.cumsum(size) - size
    # Each corner of each facet brings all facets of that corner.
    many = size[corner]
    owner = np.repeat(own, many)
    within = np.arange(len(owner)) - np.repeat(np.cumsum(many) - many, many)
    member = own[order][np.repeat(begin[corner], many) + within]
    pairs = np.unique(owner * len(facets) + member)
    first = np.searchsorted(pairs, np.arange(len(facets) + 1) * len(facets))
    return first, (pairs % len(facets)).astype(np.int32)
