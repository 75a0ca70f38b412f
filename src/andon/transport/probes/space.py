"""A probe volume made ready for looking light up: flat arrays, for NumPy, Numba and shaders."""

from __future__ import annotations

import importlib
import importlib.util
from collections.abc import Sequence
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError, MachineError
from andon.files.volumes.model import Cells, ProbeVolume
from andon.transport.probes.cells import build_cells
from andon.transport.probes.delaunay import volumes
from andon.transport.probes.grid import start_grid
from andon.transport.probes.locate import Mix, locate
from andon.transport.probes.points import points_of
from andon.transport.probes.zones import boxes_of, chosen_zones

__all__ = ["LookupEngine", "Mix", "ProbeSpace"]

Float = NDArray[np.float64]
Int = NDArray[np.int32]

LookupEngine = Literal["auto", "numpy", "numba"]

# Points from which on it pays to start Numba, which takes half a second.
MANY = 1 << 15


class ProbeSpace:
    """The space between the probes of a volume, compiled.

    Parameters
    ----------
    volume : its cells are built where nobody did.
    zones : names of those in use; none given: all.

    Attributes
    ----------
    positions : (n, 3) float64 of all probes of the volume, metres.
    corners : (m, 4) int32 probes of tetrahedra, of all zones, also of those not in use.
    neighbours : (m, 4) int32 tetrahedron beyond the face opposite each corner; −1 − f: facet f.
    origins : (m, 3) float64 position of corner 3.
    inverses : (m, 3, 3) float64 of [p0−p3 p1−p3 p2−p3]; row k · (p − origin) is the weight of
        corner k, corner 3 has the rest.
    facets : (f, 3) int32 probes, counter-clockwise from outside; (a, b, b), (a, a, a) in zones
        without volume.
    facet_neighbours : (f, 3) int32 the facet beyond the edge opposite each corner; −1: none.
    facet_cells : (f,) int32 the tetrahedron behind; −1: of a zone without volume, has two sides.
    facet_zones : (f,) int32 place of its zone in the arrays below; −1: not in use.
    facet_normals : (f, 3) float64 unit, outward; 0 where it is no triangle.
    facet_gradients : (f, 2, 3) float64: row k · (p − p_a) is the weight of corner 1 + k at the
        point of the facet's plane below p; 0 where it is no triangle.
    zone_names : of the z zones in use; what follows is of these.
    zone_cells, zone_facets : (z, 2) int32 first and count.
    zone_middles : (z, 3) float64 of the box around its probes, metres.
    zone_extents : (z,) float64 its longest side, metres; 1 of a single probe.
    boxes : (b, 2, 3) float64 lowest, highest corner, metres, maybe ±inf; `box_zones` (b,) int32.
        A point takes the zone of the first box with the least distance to it.
    grid_origins, grid_steps : (z, 3) float64 lowest corner and size of the boxes, metres.
    grid_shapes : (z, 3) int32 boxes along x, y, z.
    grid_firsts : (z,) int32 place of the zone's first box in `grid_starts`.
    grid_starts : int32, x fastest, then y: a tetrahedron near the middle of the box; −1 − f: the
        facet f, in a zone without volume. A point outside takes the nearest box.

    Raises
    ------
    InputError : what `build_cells` refuses; cells that name no probe, or have no volume; zones
        that are not there.
    """

    def __init__(self, volume: ProbeVolume, zones: Sequence[str] = ()) -> None:
        self.positions = np.asarray(volume.positions, np.float64)
        cells = volume.cells or build_cells(self.positions, volume.zones)
        _check(cells, len(self.positions), len(volume.zones))
        chosen = chosen_zones(volume.zones, zones)
        self.corners, self.neighbours = cells.corners, cells.neighbours
        self.facets, self.facet_neighbours = cells.facets, cells.facet_neighbours
        self.facet_cells = cells.facet_cells
        self._compile_cells()
        self._compile_facets()
        self._compile_zones(volume, cells, chosen)
        self._compile_grids()

    def _compile_cells(self) -> None:
        at = self.positions[self.corners]
        flat = np.flatnonzero(~(volumes(self.positions, self.corners) > 0))
        if len(flat):
            raise InputError(
                f"cell {flat[0]} has no volume or is inside out, as {len(flat)} in all",
                field="cells",
                remedy="join the probes anew",
            )
        self.origins = np.ascontiguousarray(at[:, 3])
        edges = at[:, :3] - at[:, 3:]
        self.inverses: Float = np.asarray(np.linalg.inv(edges.transpose(0, 2, 1)), np.float64)

    def _compile_facets(self) -> None:
        a, b, c = (self.positions[self.facets[:, i]] for i in range(3))
        normal = np.cross(b - a, c - a)
        square = np.einsum("fi,fi->f", normal, normal)[:, None]
        flat = square == 0
        dual = np.stack([np.cross(c - a, normal), np.cross(normal, b - a)], axis=1)
        self.facet_normals = np.where(flat, 0.0, normal / np.sqrt(np.where(flat, 1, square)))
        self.facet_gradients = dual / np.where(flat, np.inf, square)[:, None]

    def _compile_zones(self, volume: ProbeVolume, cells: Cells, chosen: list[int]) -> None:
        zones = [volume.zones[number] for number in chosen]
        self.zone_names = tuple(zone.name for zone in zones)
        self.zone_cells, self.zone_facets = cells.zone_cells[chosen], cells.zone_facets[chosen]
        self.boxes, self.box_zones = boxes_of(zones)
        self.facet_zones = np.full(len(self.facets), -1, np.int32)
        middles, extents = np.zeros((len(zones), 3)), np.ones(len(zones))
        for number, (first, count) in enumerate(self.zone_facets):
            self.facet_zones[first : first + count] = number
            at = self.positions[self.facets[first : first + count]].reshape(-1, 3)
            low, high = at.min(axis=0), at.max(axis=0)
            middles[number] = (low + high) / 2
            extents[number] = (high - low).max() or 1.0
        self.zone_middles, self.zone_extents = middles, extents

    def _compile_grids(self) -> None:
        grids = [start_grid(self, number) for number in range(len(self.zone_names))]
        self.grid_origins = np.stack([grid.origin for grid in grids])
        self.grid_steps = np.stack([grid.step for grid in grids])
        self.grid_shapes = np.stack([grid.shape for grid in grids])
        sizes = [len(grid.starts) for grid in grids]
        self.grid_firsts = np.cumsum([0, *sizes[:-1]]).astype(np.int32)
        self.grid_starts = np.concatenate([grid.starts for grid in grids])

    @cached_property
    def facet_rings(self) -> tuple[NDArray[np.int64], Int]:
        """(f + 1,) first and last of each facet in (e,): facets of its zone that share a probe."""
        from andon.transport.probes.facets import rings

        return rings(self.facets, self.facet_zones, len(self.positions))

    @cached_property
    def _packed(self) -> Any:
        """`lookup_numba.Compiled`."""
        return _numba().compiled(self)

    def locate(
        self, points: Float, start: Int | None = None, /, *, engine: LookupEngine = "auto"
    ) -> Mix:
        """The probes around points (q, 3) in metres, world, and their weights.

        Inside the hull of a point's zone, the barycentric coordinates in a tetrahedron; outside,
        the coordinates of the closest point of the hull. Points with a NaN or an infinity get
        weights of NaN, and so light of NaN. Raises `InputError` for what is no (q, 3) of numbers.

        Parameters
        ----------
        start : (q,) `Mix.cells` of last time, where points have moved little; of another zone, or
            no cells at all, they are not used.
        engine : numpy, numba, or auto: Numba if it is installed and there are many points. Both
            give the same light within rounding; on a face, they may name either cell.
        """
        at = points_of(points, "points")
        if not _compile(engine, len(at)):
            return locate(self, at, start)
        first = np.zeros(0, np.int32) if start is None else np.ascontiguousarray(start, np.int32)
        mix = Mix(
            np.zeros((len(at), 4), np.int32), np.zeros((len(at), 4)), np.zeros(len(at), np.int32)
        )
        _numba().locate_all(self._packed, at, first, mix.probes, mix.weights, mix.cells)
        return mix

    def lookup(
        self, points: Float, values: NDArray[np.floating], /, *, engine: LookupEngine = "auto"
    ) -> NDArray[np.floating]:
        """(q, …) the mix of `values` (n, …) at points (q, 3): `locate` and `mixed` in one.

        Faster than both with Numba, above all where points follow each other closely; computed and
        returned as float32 if `values` are, else as float64.
        """
        kind = np.float32 if values.dtype == np.float32 else np.float64
        at = points_of(points, "points")
        if not _compile(engine, len(at)):
            return self.mixed(locate(self, at, None), values).astype(kind)
        flat = np.ascontiguousarray(values, kind).reshape(len(values), -1)
        result = np.empty((len(at), flat.shape[1]), kind)
        _numba().lookup_all(self._packed, at, flat, result)
        return result.reshape(len(at), *values.shape[1:])

    def mixed(self, mix: Mix, values: NDArray[np.floating], /) -> Float:
        """(q, …) the mix of `values` (n, …), one of each probe: any unit, any linear quantity.

        Of any number of probes a point: 4 as `locate` gives them, 36 where walls hide some.
        """
        shape = values.shape[1:]
        result = np.zeros((len(mix.probes), *shape))
        for probes, weights in zip(mix.probes.T, mix.weights.T, strict=True):
            result += weights.reshape(-1, *[1] * len(shape)) * values[probes]
        return result


def _numba() -> Any:
    return importlib.import_module("andon.transport.probes.lookup_numba")


def _compile(engine: LookupEngine, count: int) -> bool:
    """Whether Numba takes `count` points.

    Raises
    ------
    MachineError : it is asked for, and not installed.
    """
    if engine == "numpy" or (engine == "auto" and count < MANY):
        return False
    if importlib.util.find_spec("numba") is not None:
        return True
    if engine == "numba":
        raise MachineError("Numba is not installed", remedy="pip install andon[probes]")
    return False


def _check(cells: Cells, probes: int, zones: int) -> None:
    """Refuses cells that point beyond the end of something."""
    count, facets = len(cells.corners), len(cells.facets)
    ranges = {
        "corners": (cells.corners, 0, probes),
        "neighbours": (cells.neighbours, -facets, count),
        "facets": (cells.facets, 0, probes),
        "facet_neighbours": (cells.facet_neighbours, -1, facets),
        "facet_cells": (cells.facet_cells, -1, count),
    }
    for name, (numbers, low, high) in ranges.items():
        if numbers.size and not (low <= numbers.min() and numbers.max() < high):
            raise InputError(
                f"must be in {low}…{high - 1}, got {numbers.min()}…{numbers.max()}",
                field=f"cells.{name}",
                remedy="join the probes anew",
            )
    for name, numbers, size in (
        ("zone_cells", cells.zone_cells, count),
        ("zone_facets", cells.zone_facets, facets),
    ):
        inside = numbers.shape == (zones, 2) and numbers.min() >= 0
        if not inside or numbers.astype(np.int64).sum(axis=1).max() > size:
            raise InputError(f"must be in {size} of {zones} zones", field=f"cells.{name}")
    if zones == 0 or cells.zone_facets[:, 1].min() < 1:
        raise InputError("a zone without facets", field="cells.zone_facets")
