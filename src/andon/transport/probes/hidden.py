"""Probes that walls hide from a point lose their weight; visible ones of the neighbourhood step in.

Every hidden probe hands its weight on to the probes that it is joined to, by inverse squared
distance from the point; and only where hardly any weight of the cell itself is left::

    W_j = w_j·v_j + f·Σ_i w_i·g_ij·v_j + ε·w_j        f = max(0, 1 − Σ w·v / ENOUGH)

with weights w of the cell, visibility v, and g_ij the shares of i's neighbours, which sum to 1.
w is continuous across faces of cells, since a probe that leaves or enters has weight 0 there, and
g belongs to a probe, not to a cell: so W is continuous, too. ε decides where all is hidden: then
the cell's own mix is given, as without walls.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from andon.files.volumes.model import Cells, Distances, ProbeVolume
from andon.transport.probes.space import Mix
from andon.transport.probes.visibility import visible

__all__ = ["ENOUGH", "LEAST", "NEIGHBOURS", "Walls", "hidden_mix", "neighbours_of", "walls_of"]

Float = NDArray[np.float64]
Int = NDArray[np.int32]

# Share of a cell's weight above which its visible probes need no help. A point at a tenth of the
# way from a wall to the only probe on its side has that share left.
ENOUGH = 0.05
# ε: what a hidden probe keeps of its weight; its share of the light is this over ENOUGH at most,
# unless there is no visible one at all.
LEAST = 1e-5
# Of each probe: the nearest that it shares an edge with; a tetrahedral lattice has 14 such.
NEIGHBOURS = 8


@dataclass(frozen=True, eq=False)
class Walls:
    """What is needed to tell hidden probes from visible ones.

    Attributes
    ----------
    distances : what each probe sees.
    capture_positions : (n, 3) where from, metres, world.
    positions : (n, 3) where probes count, metres, world.
    neighbours : (n, 8) the nearest probes that share an edge of a cell with each; −1: no more.
    """

    distances: Distances
    capture_positions: Float
    positions: Float
    neighbours: Int


def walls_of(volume: ProbeVolume, cells: Cells, /) -> Walls | None:
    """The walls that a volume knows of, or None."""
    if volume.distances is None:
        return None
    around = neighbours_of(cells, volume.positions)
    return Walls(volume.distances, volume.capture_positions, volume.positions, around)


def neighbours_of(cells: Cells, positions: Float, /) -> Int:
    """(n, 8) the nearest probes that share an edge with each of n, near to far; −1: no more."""
    edges = np.concatenate([cells.edges, cells.edges[:, ::-1]])
    length = np.linalg.norm(positions[edges[:, 0]] - positions[edges[:, 1]], axis=1)
    order = np.lexsort((edges[:, 1], length, edges[:, 0]))
    edges = edges[order]
    rank = np.arange(len(edges)) - np.searchsorted(edges[:, 0], edges[:, 0])
    near = rank < NEIGHBOURS
    found = np.full((len(positions), NEIGHBOURS), -1, np.int32)
    found[edges[near, 0], rank[near]] = edges[near, 1]
    return found


def hidden_mix(walls: Walls, mix: Mix, points: Float, normals: Float | None = None, /) -> Mix:
    """`mix` without what walls hide; of 4 or, where neighbours step in, of 36 probes a point.

    Parameters
    ----------
    walls : from `walls_of`.
    mix : of the same points, (q, 4).
    points : (q, 3) metres, world.
    normals : (q, 3) unit, of the surfaces that the points lie on; None: in free air.

    Returns
    -------
    Weights ≥ 0 that sum to 1.
    """
    seen = visible(walls.distances, walls.capture_positions, mix.probes, points, normals)
    own = mix.weights * seen
    share = own.sum(axis=1)
    # Weights that add up to 1 only nearly must not call for neighbours where all is visible.
    helped = np.maximum(1 - share / ENOUGH, 0)
    weights = own + LEAST * mix.weights
    probes = mix.probes
    few = np.flatnonzero(helped > 0)
    if len(few):
        near, lent = _lent(
            walls,
            mix.probes[few],
            mix.weights[few],
            points[few],
            None if normals is None else normals[few],
        )
        extra = np.zeros((len(points), near.shape[1]))
        extra[few] = helped[few, None] * lent
        extra_probes = np.zeros((len(points), near.shape[1]), np.int32)
        extra_probes[few] = near
        weights = np.concatenate([weights, extra], axis=1)
        probes = np.concatenate([probes, extra_probes], axis=1)
    return replace(mix, probes=probes, weights=weights / weights.sum(axis=1, keepdims=True))


def _lent(
    walls: Walls, probes: Int, weights: Float, points: Float, normals: Float | None
) -> tuple[Int, Float]:
    """Neighbours (q, 32) of the probes (q, 4), and the weights that they take over."""
    near = walls.neighbours[probes]
    exists = near >= 0
    near = np.maximum(near, 0)
    away = points[:, None, None] - walls.positions[near]
    closeness = exists / np.maximum(np.einsum("qkni,qkni->qkn", away, away), 1e-12)
    total = closeness.sum(axis=-1, keepdims=True)
    shares = np.divide(closeness, total, out=np.zeros_like(closeness), where=total > 0)
    flat = near.reshape(len(points), -1)
    seen = visible(walls.distances, walls.capture_positions, flat, points, normals)
    return flat, (weights[..., None] * shares).reshape(len(points), -1) * seen
