"""The space that placed probes are for: zones, and how far anybody will ask."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.volumes import Cells, Zone
from andon.quantities import Geometry
from andon.scene.probes import Probes
from andon.transport.probes.placement import Placed
from andon.transport.probes.zones import boxes_of, zone_of

__all__ = ["far_m", "zones_of"]

Float = NDArray[np.float64]

EVERYWHERE = "all"
# Lookups reach at most a cell's longest edge from a probe; surfaces are looked up a little beyond
# the hull as well.
REACH = 1.5
# Where there is one probe and no geometry, metres.
FARTHEST_M = 1e4


def zones_of(probes: Probes, placed: Placed, file: str, /) -> tuple[Zone, ...]:
    """The zones of the scene with the probes in their boxes; one zone where none is stated.

    A probe in boxes of several zones is of all of them; one in no box is of the nearest.
    Raises `InputError` for a zone without a probe.
    """
    count = placed.count
    if not probes.zone:
        return (Zone(EVERYWHERE, np.arange(count, dtype=np.int32)),)
    boxes: dict[str, list[tuple[tuple[float, ...], tuple[float, ...]]]] = {}
    for table in probes.zone:
        boxes.setdefault(table.name, []).append((table.low, table.high))
    empty = np.zeros(0, np.int32)
    named = [Zone(name, empty, np.array(own, float)) for name, own in boxes.items()]
    inside = np.stack([_inside(zone.boxes, placed.positions) for zone in named])
    every, numbers = boxes_of(named)
    nearest = zone_of(placed.positions, every, numbers)
    zones: list[Zone] = []
    for number, zone in enumerate(named):
        own = inside[number] | (~inside.any(axis=0) & (nearest == number))
        if not own.any():
            raise InputError(
                f"the zone {zone.name!r} has no probe in it",
                file=file,
                field="probes.zone",
                remedy="place a probe there, or leave the zone out",
            )
        zones.append(Zone(zone.name, np.flatnonzero(own).astype(np.int32), zone.boxes))
    return tuple(zones)


def _inside(boxes: Float | None, points: Float) -> NDArray[np.bool_]:
    assert boxes is not None
    inside = np.zeros(len(points), bool)
    for low, high in boxes:
        inside |= ((points >= low) & (points <= high)).all(axis=1)
    return inside


def far_m(placed: Placed, cells: Cells, geometry: Sequence[Geometry], /) -> float:
    """What no surface counts as in the distances of the probes, metres.

    The longest edge between joined probes, and some more; of a single probe the size of the scene.
    Rounded up to a power of √2, so that moving one probe leaves what others captured as it is.
    """
    joined = [cells.corners[:, [i, j]] for i in range(4) for j in range(i)]
    joined += [cells.facets[:, [i, j]] for i in range(3) for j in range(i)]
    pairs = np.concatenate(joined)
    ends = placed.positions[pairs]
    longest = float(np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1).max(initial=0.0))
    if longest > 0:
        return float(2.0 ** (np.ceil(2 * np.log2(REACH * longest)) / 2))
    points = [part.positions for part in geometry if len(part.positions)]
    if not points:
        return FARTHEST_M
    return float(np.linalg.norm(np.ptp(np.concatenate(points), axis=0))) or FARTHEST_M
