"""What a probe volume holds, in memory as in its file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from andon.quantities import Photometry

__all__ = [
    "FACES",
    "Cells",
    "Distances",
    "ProbeRole",
    "ProbeVolume",
    "Zone",
    "plain_volume",
    "simplex_edges",
]

Float = NDArray[np.float64]
Int = NDArray[np.int32]
ProbeRole = Literal["general", "sky", "bounce", "bleeding"]

# Corners of the face opposite each corner of a tetrahedron, counter-clockwise from outside.
FACES = np.array([[1, 3, 2], [0, 2, 3], [0, 3, 1], [0, 1, 2]])


@dataclass(frozen=True, eq=False)
class Zone:
    """A part of space whose light comes from its own probes only.

    Attributes
    ----------
    name : unique in its volume.
    probes : (k,) rising numbers of its probes; a probe at a door may be in two zones.
    boxes : (b, 2, 3) lowest and highest corners, metres; their union is the zone. None: all of
        space, of the only zone of a volume.
    """

    name: str
    probes: Int
    boxes: Float | None = None


@dataclass(frozen=True, eq=False)
class Cells:
    """Space between probes: tetrahedra, and the hull around them. All zones in one list.

    Zones without volume have no tetrahedra: where all probes lie in a plane, `facets` are the
    triangles between them; on a line, its pieces (a, b, b); of one probe, (a, a, a).

    Attributes
    ----------
    corners : (m, 4) numbers of probes; p0−p3, p1−p3, p2−p3 have a positive determinant.
    neighbours : (m, 4) the tetrahedron beyond the face opposite each corner; −1 − f: none, and
        that face is the facet f of the hull.
    facets : (f, 3) numbers of probes, counter-clockwise from outside.
    facet_neighbours : (f, 3) the facet beyond the edge opposite each corner; −1: none.
    facet_cells : (f,) the tetrahedron behind it; −1: none.
    zone_cells, zone_facets : (z, 2) first and count of each zone.
    """

    corners: Int
    neighbours: Int
    facets: Int
    facet_neighbours: Int
    facet_cells: Int
    zone_cells: Int
    zone_facets: Int

    @property
    def edges(self) -> Int:
        """(e, 2) pairs of probes that an edge joins, each once, the lower number first, in order.

        Ways from probe to probe: the probes paper remarks that its tetrahedra would serve path
        finding too.
        """
        return _pairs(np.concatenate([simplex_edges(self.corners), simplex_edges(self.facets)]))

    @property
    def adjacent(self) -> Int:
        """(e, 2) pairs of tetrahedra with a common face, each once, the lower number first."""
        own = np.repeat(np.arange(len(self.corners), dtype=np.int32), 4)
        pairs = np.column_stack([own, self.neighbours.ravel()])
        return pairs[pairs[:, 0] < pairs[:, 1]].astype(np.int32)


def simplex_edges(corners: Int, /) -> Int:
    """(e, 2) the different edges of simplices (m, k), each once, rising, in order."""
    pairs = [corners[:, [i, j]] for j in range(corners.shape[1]) for i in range(j)]
    return _pairs(np.concatenate(pairs))


def _pairs(pairs: Int) -> Int:
    """Those of two different numbers, each once, rising, in order."""
    ends = np.sort(pairs, axis=1).astype(np.int64)
    # Pieces of a line have an edge of no length.
    ends = ends[ends[:, 0] < ends[:, 1]]
    count = int(ends.max(initial=0)) + 1
    first, second = np.divmod(np.unique(ends[:, 0] * count + ends[:, 1]), count)
    return np.column_stack([first, second]).astype(np.int32)


@dataclass(frozen=True, eq=False)
class Distances:
    """How far each probe sees, as octahedral pictures.

    Attributes
    ----------
    mean_m, mean_square_m2 : (n, s, s) of the distances in the directions of each texel, metres
        and square metres; no surface counts as `far_m`.
    far_m : what infinity is cut at.
    """

    mean_m: NDArray[np.float32]
    mean_square_m2: NDArray[np.float32]
    far_m: float


@dataclass(frozen=True, eq=False, repr=False)
class ProbeVolume:
    """Light probes: where, for what, with which light, and the space between them.

    Attributes
    ----------
    positions : (n, 3) where they count, metres, world.
    capture_positions : (n, 3) where they were captured.
    names, roles : n of each.
    ranges_m : (n,) farthest surface captured; inf: no limit.
    states : name → (n, (order + 1)², 3) spherical harmonics of the luminance that arrives, cd/m²,
        world axes, order and sign of `andon.harmonics`; raw: neither windowed nor convolved. The
        first state is the default one.
    zones : at least one; all of space by default.
    cells : None where nobody joined the probes yet.
    distances : None where walls hide nothing.
    photometry : ``absolute`` or ``relative``, of every number of light.
    notes : (what, text): the generator, the scene, the settings of the bake.
    """

    positions: Float
    capture_positions: Float
    names: tuple[str, ...]
    roles: tuple[ProbeRole, ...]
    ranges_m: Float
    states: Mapping[str, Float]
    zones: tuple[Zone, ...]
    cells: Cells | None = None
    distances: Distances | None = None
    photometry: Photometry = "absolute"
    notes: Mapping[str, str] = field(default_factory=dict[str, str])

    def __repr__(self) -> str:
        """Counts and names, without the arrays."""
        parts = [
            f"{self.count} probes",
            f"order {self.order}" if self.states else "no light",
            f"states {', '.join(map(repr, self.states))}" if self.states else "",
            f"zones {', '.join(repr(zone.name) for zone in self.zones)}",
            "not joined" if self.cells is None else f"{len(self.cells.corners)} cells",
            "no distances" if self.distances is None else "distances",
            self.photometry,
        ]
        return f"ProbeVolume({'; '.join(part for part in parts if part)})"

    @property
    def count(self) -> int:
        """Probes."""
        return len(self.positions)

    @property
    def order(self) -> int:
        """Highest band of the harmonics."""
        first = next(iter(self.states.values()))
        return round(first.shape[1] ** 0.5) - 1


def plain_volume(
    positions: Float,
    coefficients: Float,
    /,
    *,
    state: str = "default",
    zones: tuple[Zone, ...] = (),
    cells: Cells | None = None,
    distances: Distances | None = None,
    photometry: Photometry = "absolute",
) -> ProbeVolume:
    """A volume of light (n, k, 3) in cd/m² at `positions` (n, 3) in metres: one state, no roles.

    Probes count where they were captured, without a limit; of no zones stated there is one, which
    is all of space.
    """
    count = len(positions)
    return ProbeVolume(
        positions=positions,
        capture_positions=positions,
        names=tuple(f"probe {number}" for number in range(count)),
        roles=("general",) * count,
        ranges_m=np.full(count, np.inf),
        states={state: coefficients},
        zones=zones or (Zone("all", np.arange(count, dtype=np.int32)),),
        cells=cells,
        distances=distances,
        photometry=photometry,
    )
