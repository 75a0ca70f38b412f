"""What a probe volume holds, in memory as in its file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from andon.quantities import Photometry

__all__ = ["Cells", "Distances", "ProbeRole", "ProbeVolume", "Zone"]

Float = NDArray[np.float64]
Int = NDArray[np.int32]
ProbeRole = Literal["general", "sky", "bounce", "bleeding"]


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
