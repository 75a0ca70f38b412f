"""A stranger's triangles as one clean layer: welded, once each, wound alike, with its rims."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.lamps.triangles import WELD, connected, triangle_areas, welded

__all__ = ["Layer", "clean_layer", "rims"]

Float = NDArray[np.float64]
Int = NDArray[np.int64]

FIELD = "shell.mesh"


@dataclass(frozen=True)
class Layer:
    """Triangles without repeats, wound alike within each part.

    Attributes
    ----------
    positions : (n, 3) metres, welded.
    triangles : (m, 3) indices into `positions`.
    source : (m,) index of each triangle in the mesh that it comes from.
    flipped : (m,) bool, runs the other way round than in that mesh.
    part : (m,) number of the edge-connected part, from 0.
    """

    positions: Float
    triangles: Int
    source: Int
    flipped: NDArray[np.bool_]
    part: Int

    @property
    def corners(self) -> Float:
        """(m, 3, 3) metres."""
        return self.positions[self.triangles]

    def turned(self, triangles: NDArray[np.bool_], /) -> Layer:
        """The same layer with these (m,) triangles wound the other way round."""
        wound = np.where(triangles[:, None], self.triangles[:, ::-1], self.triangles)
        return Layer(self.positions, wound, self.source, self.flipped ^ triangles, self.part)


def clean_layer(positions: Float, triangles: NDArray[np.integer], /) -> Layer:  # pyright: ignore[reportMissingTypeArgument]
    """The layer of a mesh; triangles without area and second copies are left out.

    Raises `InputError` if nothing is left, a position is not finite, an edge belongs to more than
    two triangles, or the layer has only one side (a Möbius strip).
    """
    if not len(triangles) or not np.isfinite(positions).all():
        fault = "has no triangles" if not len(triangles) else "has a position that is not finite"
        raise InputError(fault, field=FIELD)
    size = float(np.ptp(positions, axis=0).max())
    points, index = welded(np.asarray(positions, np.float64), WELD * size)
    wound = index[triangles]
    a, b, c = wound.T
    area = triangle_areas(points[wound])
    keep = (a != b) & (b != c) & (c != a) & (area > (WELD * size) ** 2)
    # Models for engines without two-sided faces hold each triangle twice.
    _, first = np.unique(np.sort(wound, axis=1), axis=0, return_index=True)
    keep &= np.isin(np.arange(len(wound)), first)
    source = np.flatnonzero(keep)
    if not len(source):
        raise InputError("has no triangle with an area", field=FIELD)
    wound = wound[source].astype(np.int64)
    pairs, same_way = _neighbours(wound)
    part = connected(len(wound), pairs)
    layer = Layer(points, wound, source, np.zeros(len(wound), np.bool_), part)
    return layer.turned(_turns(len(wound), pairs, same_way)) if same_way.any() else layer


def _edges(triangles: Int) -> tuple[Int, Int]:
    """Directed edges (3m, 2) and the triangle (3m,) of each."""
    edges = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    return edges, np.repeat(np.arange(len(triangles)), 3)


def _neighbours(triangles: Int) -> tuple[Int, NDArray[np.bool_]]:
    """Pairs (k, 2) of triangles with a common edge, and whether both run along it one way."""
    edges, owner = _edges(triangles)
    low, high = edges.min(axis=1), edges.max(axis=1)
    order = np.lexsort((high, low))
    low, high = low[order], high[order]
    same = (low[1:] == low[:-1]) & (high[1:] == high[:-1])
    if (same[1:] & same[:-1]).any():
        raise InputError(
            "has an edge that belongs to more than two triangles",
            field=FIELD,
            remedy="a shell is one layer of triangles, without ribs or walls inside",
        )
    at = np.flatnonzero(same)
    first, second = order[at], order[at + 1]
    one_way = edges[first, 0] == edges[second, 0]
    return np.stack([owner[first], owner[second]], axis=1), one_way


def _turns(count: int, pairs: Int, same_way: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Which triangles to turn, so that neighbours run along their edge in opposite ways."""
    links: dict[int, list[tuple[int, bool]]] = defaultdict(list)
    for (one, other), odd in zip(pairs.tolist(), same_way.tolist(), strict=True):
        links[one].append((other, odd))
        links[other].append((one, odd))
    turn: dict[int, bool] = {}
    for start in range(count):
        if start in turn:
            continue
        turn[start] = False
        waiting = [start]
        while waiting:
            here = waiting.pop()
            for there, odd in links[here]:
                wanted = turn[here] ^ odd
                if there not in turn:
                    turn[there] = wanted
                    waiting.append(there)
                elif turn[there] != wanted:
                    raise InputError("has only one side", field=FIELD, remedy="cut it open")
    return np.array([turn[i] for i in range(count)])


def rims(layer: Layer, /) -> list[Float]:
    """Loops (k, 3) along which a lid would close the layer, wound like the layer."""
    edges, _ = _edges(layer.triangles)
    known = {(a, b) for a, b in edges.tolist()}
    after: dict[int, list[int]] = defaultdict(list)
    for a, b in known:
        if (b, a) not in known:
            after[b].append(a)
    loops: list[Float] = []
    while after:
        start = next(iter(after))
        loop, here = [start], _step(after, start)
        while here != start:
            loop.append(here)
            here = _step(after, here)
        loops.append(layer.positions[loop])
    return loops


def _step(after: dict[int, list[int]], here: int) -> int:
    # Every vertex has as many rim edges that arrive as leave, so a walk ends where it began.
    there = after[here].pop()
    if not after[here]:
        del after[here]
    return there
