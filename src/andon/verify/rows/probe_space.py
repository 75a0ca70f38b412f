"""Probes: between them light is linear and whole, beyond them constant, and no set is too odd."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError, MachineError
from andon.files.volumes.model import FACES, Zone
from andon.transport.probes.cells import build_cells
from andon.transport.probes.lookup import barycentric
from andon.transport.probes.space import ProbeSpace
from andon.verify.probe_sets import degenerate_sets, full_sets, uniform, volume_of
from andon.verify.registry import NotShown, Row

__all__ = [
    "ROWS",
    "engines_difference",
    "face_difference",
    "hull_difference",
    "linear_error",
    "not_refused",
    "weight_error",
]

Float = NDArray[np.float64]

POINTS = 20_000
# Of the row with as many probes as a volume may have in practice.
MANY = 100_000
# Extents between a point of the hull and one outside with the same light.
AWAY = (1e-9, 1e-6, 1e-3, 0.1, 1.0, 10.0)
# What no lookup may trip over.
WILD = np.array(
    [[np.nan, 0, 0], [0, np.inf, 0], [0, 0, -np.inf], [1e308, -1e308, 1e308], [1e-308, 0, -1e200]]
)


@cache
def _space(name: str) -> ProbeSpace:
    """Of a set of `probe_sets`, compiled once for all rows."""
    positions = {**full_sets(), **degenerate_sets()}[name]
    try:
        return ProbeSpace(volume_of(positions))
    except MachineError as error:
        raise NotShown(str(error)) from error


def _light(space: ProbeSpace) -> Float:
    """(n, 27) as of `volume_of`."""
    return np.random.default_rng(27).uniform(size=(len(space.positions), 27))


def _points(space: ProbeSpace, reach: float) -> Float:
    """(q, 3) in the box around the probes and `reach` extents beyond; also all probes."""
    at, extent = space.positions, space.zone_extents[0]
    low, high = at.min(axis=0) - reach * extent, at.max(axis=0) + reach * extent
    return np.concatenate([np.random.default_rng(3).uniform(low, high, (POINTS, 3)), at])


@cache
def linear_error() -> float:
    """Largest error of a linear field with a unit gradient inside the hull, in extents."""
    worst = 0.0
    for name in full_sets():
        space = _space(name)
        points = _points(space, 0.0)
        mix = space.locate(points, engine="numpy")
        inside = mix.cells >= 0
        error = space.mixed(mix, space.positions) - points
        worst = max(worst, float(np.abs(error[inside]).max() / space.zone_extents[0]))
    return worst


@cache
def face_difference() -> float:
    """Largest difference of light on a face, seen from the cells on both its sides.

    Of 27 coefficients in [0, 1), at the middle of each inner face and at two more of its points.
    """
    worst = 0.0
    for name in full_sets():
        space = _space(name)
        light = _light(space)
        cell, face = np.nonzero(space.neighbours >= 0)
        corners = space.positions[space.corners[cell[:, None], FACES[face]]]
        for shares in ((1 / 3, 1 / 3, 1 / 3), (0.7, 0.3, 0.0), (0.05, 0.05, 0.9)):
            points = np.einsum("k,fki->fi", shares, corners)
            sides = [
                _mixed_in(space, points, c, light) for c in (cell, space.neighbours[cell, face])
            ]
            worst = max(worst, float(np.abs(sides[0] - sides[1]).max(initial=0.0)))
    return worst


def _mixed_in(space: ProbeSpace, points: Float, cells: NDArray[np.integer], light: Float) -> Float:
    """(q, 27) by the coordinates in given cells, even if they are beside them."""
    weights = barycentric(space, points, cells.astype(np.int32))
    return np.einsum("qk,qkc->qc", weights, light[space.corners[cells]])


@cache
def hull_difference() -> float:
    """Largest difference between light on the hull, from within, and along its normals outside.

    At points of facets along their normal, of edges along a mean of two normals, and of corners
    along a mean of all: the closest point of the hull is then known.
    """
    worst = 0.0
    for name in full_sets():
        space = _space(name)
        light = _light(space)
        for points, outward, cells in _hull_points(space):
            within = _mixed_in(space, points, cells, light)
            for away in AWAY:
                mix = space.locate(points + away * space.zone_extents[0] * outward, engine="numpy")
                worst = max(worst, float(np.abs(space.mixed(mix, light) - within).max()))
    return worst


def _hull_points(space: ProbeSpace) -> list[tuple[Float, Float, NDArray[np.int32]]]:
    """Points (q, 3) of the hull, unit vectors out of it, cells behind: facets, edges, corners."""
    corners = space.positions[space.facets]
    normals, cells = space.facet_normals, space.facet_cells
    middle = np.einsum("k,fki->fi", (0.2, 0.3, 0.5), corners)
    beyond = normals[space.facet_neighbours[:, 2]]
    edge = 0.4 * corners[:, 0] + 0.6 * corners[:, 1]
    around = np.zeros_like(space.positions)
    np.add.at(around, space.facets.ravel(), np.repeat(normals, 3, axis=0))
    found = [(middle, normals), (edge, 0.3 * normals + 0.7 * beyond)]
    found.append((corners[:, 0], around[space.facets[:, 0]]))
    return [(p, n / np.linalg.norm(n, axis=1, keepdims=True), cells) for p, n in found]


@cache
def weight_error() -> float:
    """Largest |Σ weights − 1| of all sets, 1e5 probes too, near, far, and at points like 1e308.

    inf where a weight is negative or not finite; a lookup that raises ends the row.
    """
    worst = 0.0
    for name in (*full_sets(), *degenerate_sets()):
        worst = max(worst, _weight_error(_space(name)))
    return max(worst, _weight_error(ProbeSpace(volume_of(uniform(MANY)))))


def _weight_error(space: ProbeSpace) -> float:
    worst = 0.0
    for reach in (0.0, 1.0, 1e3, 1e12):
        points = np.concatenate([_points(space, reach), WILD])
        mix = space.locate(points, engine="numpy")
        valid = np.isfinite(points).all(axis=1)
        weights = mix.weights[valid]
        right = np.isfinite(weights).all() and weights.min() >= 0
        right &= bool(np.isnan(mix.weights[~valid]).all())
        error = float(np.abs(weights.sum(axis=1) - 1).max())
        worst = max(worst, error if right else np.inf)
    return worst


@cache
def engines_difference() -> float:
    """Largest difference of light between NumPy and Numba, everywhere."""
    worst = 0.0
    for name in (*full_sets(), *degenerate_sets()):
        space = _space(name)
        light = _light(space)
        for reach in (0.0, 1.0, 100.0):
            points = _points(space, reach)
            slow = space.lookup(points, light, engine="numpy")
            try:
                fast = space.lookup(points, light, engine="numba")
            except MachineError as error:
                raise NotShown(str(error)) from error
            worst = max(worst, float(np.abs(fast - slow).max()))
    return worst


def not_refused() -> float:
    """How many of the sets that nothing can be made of are not refused with an `InputError`."""
    one, two = np.zeros((1, 3)), uniform(9)
    first, none = np.arange(9, dtype=np.int32), np.zeros(0, np.int32)
    wrong: list[tuple[Float, tuple[Zone, ...]]] = [
        (np.zeros((0, 3)), ()),
        (np.zeros((4, 2)), ()),
        (one * np.nan, ()),
        (np.vstack([two, [[0, np.inf, 0]]]), ()),
        (np.vstack([two, [[0, 0, 1e12]]]), ()),
        (np.vstack([two, two[4:5]]), ()),
        (np.vstack([two, two[4:5] + 1e-9]), ()),
        (np.vstack([one, one]), ()),
        (two, (Zone("all", first), Zone("none", none))),
        (two, (Zone("all", first + 1),)),
        (two, (Zone("all", first[::-1]),)),
    ]
    return float(sum(not _refused(*case) for case in wrong))


def _refused(positions: Float, zones: tuple[Zone, ...]) -> bool:
    try:
        build_cells(positions, zones)
    except InputError:
        return True
    return False


ROWS: tuple[Row, ...] = (
    Row("probes.interpolation.linear", "probes", 1e-9, "extents",
        "linear fields in nine sets of probes, lattices among them", linear_error),
    Row("probes.interpolation.faces", "probes", 1e-9, "of the light",
        "the cell on the other side of each face", face_difference),
    Row("probes.interpolation.hull", "probes", 1e-9, "of the light",
        "the hull from within, and outside along its normals", hull_difference),
    Row("probes.degenerate.weights", "probes", 1e-12, "of 1",
        "sum of weights: 17 sets from one probe to 1e5, points to 1e308, NaN", weight_error),
    Row("probes.degenerate.refused", "probes", 0.0, "sets not refused",
        "none, not finite, duplicate, wrong zones", not_refused),
    Row("probes.lookup.engines", "probes", 1e-9, "of the light",
        "NumPy against Numba on all sets", engines_difference),
)  # fmt: skip
