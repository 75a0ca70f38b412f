"""From a scene's [probes] table and its geometry to places."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import count

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.volumes.model import ProbeRole
from andon.files.volumes.rounded import in_single
from andon.quantities import Geometry
from andon.scene import Scene
from andon.scene.probes import ProbePlace, Probes
from andon.transport.probes.placement.clearance import nearest_within
from andon.transport.probes.placement.generate import (
    MAX_PROBES,
    Generated,
    from_vertices,
    lattice,
    random_places,
)
from andon.transport.probes.placement.model import Panorama, Placed, Tally
from andon.transport.probes.placement.nodes import from_nodes
from andon.transport.probes.placement.spread import Spread, spread
from andon.transport.probes.placement.walls import Walls, winding_faults
from andon.transport.probes.placement.written import nearest_distances_m

__all__ = ["place_probes"]

Float = NDArray[np.float64]

# Probes nearer than this are one, metres: light does not differ over a millimetre, but the cells
# between such probes are slivers.
SAME_PLACE_M = 1e-3
# Probes by hand nearer to a surface than this see little else in half of all directions, metres.
NEAR_WALL_M = 0.01
# Names that a warning lists before it goes on with "…".
SHOWN_NAMES = 5


@dataclass(frozen=True, eq=False)
class _Entry:
    """One probe that is asked for."""

    name: str
    position: Float
    capture_position: Float
    role: ProbeRole
    range_m: float
    panorama: Panorama | None = None
    by_hand: bool = True


def place_probes(scene: Scene, geometry: Geometry, /) -> Placed:
    """Where the probes of `scene` go: its [[probes.place]], then those of probes.placement.

    Parameters
    ----------
    scene : has a [probes] table.
    geometry : what stands still in the scene, metres, world; surfaces that light comes from, that
        probes keep off, and whose vertices and bounds are used. May be empty.

    Raises
    ------
    InputError
        where there is no [probes], no probe comes out, a file is at fault, the kind of placement
        is not built yet, or float32 does not tell the probes apart.
    """
    probes = _table(scene)
    walls = Walls(geometry)
    entries = [_by_hand(place, index) for index, place in enumerate(probes.place)]
    nodes = _nodes(scene, probes) if probes.placement.kind == "nodes" else []
    made = _generated(scene, probes, walls)
    entries += [*nodes, *_entries(made, probes)]
    if not entries:
        raise _nothing(scene, probes, made.tally)
    if len(entries) > MAX_PROBES:
        raise InputError(f"more than {MAX_PROBES} probes", file=scene.file, field="probes")
    _check_precision(entries, scene.file)
    entries = [_in_file(entry) for entry in entries]
    kept = _apart(entries)
    left_out = [entries[index] for index in sorted(set(range(len(entries))) - set(kept))]
    entries = _uniquely_named(entries[index] for index in kept)
    in_walls, near_walls = _at_walls(entries, walls)
    tally = replace(made.tally, merged=len(left_out), in_walls=in_walls, near_walls=near_walls)
    return Placed(
        np.array([entry.position for entry in entries]),
        np.array([entry.capture_position for entry in entries]),
        tuple(entry.name for entry in entries),
        tuple(entry.role for entry in entries),
        np.array([entry.range_m for entry in entries]),
        tuple(entry.panorama for entry in entries),
        tally,
        _warnings(probes, geometry, tally, left_out, len(made.positions)),
    )


def _table(scene: Scene) -> Probes:
    if scene.probes is None:
        raise InputError("needs a [probes] table", file=scene.file, remedy="add probes.volume")
    if scene.probes.placement.kind == "automatic":
        raise InputError(
            "'automatic' is in the schema but not built yet",
            file=scene.file,
            field="probes.placement.kind",
            remedy="use lattice, vertices, random, nodes or hand",
        )
    return scene.probes


def _by_hand(place: ProbePlace, index: int) -> _Entry:
    panorama = None
    if place.panorama is not None:
        panorama = Panorama(
            place.panorama,
            f"probes.place[{index}].panorama",
            place.heading_degrees,
            place.luminance_per_unit,
            place.white,
        )
    return _Entry(
        place.name,
        np.array(place.position),
        np.array(place.position if place.capture_position is None else place.capture_position),
        place.role,
        _range(place.range_m),
        panorama,
    )


def _range(range_m: float | None) -> float:
    return float("inf") if range_m is None else range_m


def _nodes(scene: Scene, probes: Probes) -> list[_Entry]:
    placement = probes.placement
    assert placement.file is not None  # the table's own rule
    found = from_nodes(scene, placement.file)
    return [
        _Entry(name, position, capture, role or placement.role, _range(placement.range_m))
        for name, position, capture, role in zip(
            found.names, found.positions, found.capture_positions, found.roles, strict=True
        )
    ]


def _generated(scene: Scene, probes: Probes, walls: Walls) -> Generated:
    placement, file = probes.placement, scene.file
    if placement.kind == "vertices":
        return from_vertices(placement, walls, file)
    if placement.kind == "lattice":
        return lattice(placement, walls, file)
    if placement.kind == "random":
        return random_places(placement, walls, scene.scene.seed, file)
    return Generated(np.zeros((0, 3)), ())


def _entries(made: Generated, probes: Probes) -> list[_Entry]:
    role, reach = probes.placement.role, _range(probes.placement.range_m)
    return [
        _Entry(name, position, position, role, reach, by_hand=False)
        for name, position in zip(made.names, made.positions, strict=True)
    ]


def _nothing(scene: Scene, probes: Probes, tally: Tally) -> InputError:
    if probes.placement.kind == "hand":
        return InputError(
            "there is no probe to place",
            file=scene.file,
            field="probes",
            remedy="add [[probes.place]], or another probes.placement.kind",
        )
    return InputError(
        f"no probe is left: {tally.dropped_in_walls} places lie inside walls, {tally.hidden} "
        f"behind one, {tally.too_near} nearer to one than offset_m",
        file=scene.file,
        field="probes.placement",
        remedy="choose another box; or the surface is wound clockwise, and all of space is behind "
        "it: turn its faces round",
    )


def _apart(entries: list[_Entry]) -> list[int]:
    """Numbers of the entries that do not lie where one before them does."""
    points = np.array([entry.position for entry in entries])
    return spread(points, Spread(SAME_PLACE_M), most=len(points))[0].tolist()


def _in_file(entry: _Entry) -> _Entry:
    """The entry where a volume's file will have it: what is captured and joined is what is read."""
    return replace(
        entry,
        position=in_single(entry.position),
        capture_position=in_single(entry.capture_position),
    )


def _check_precision(entries: list[_Entry], file: str) -> None:
    """Refuses probes that are nearer to each other than float32 tells places apart there."""
    points = np.array([entry.position for entry in entries])
    farthest = float(np.abs(points).max())
    precision = float(np.spacing(np.float32(farthest)))
    if precision <= SAME_PLACE_M:
        return
    points = points[_apart(entries)]
    nearest = float(nearest_distances_m(points).min()) if len(points) > 1 else np.inf
    if nearest < precision:
        raise InputError(
            f"too far from the origin for float32: places of {farthest:.3g} m are {precision:.2g} "
            f"m apart there, and probes {nearest:.2g} m",
            file=file,
            field="probes",
            remedy="move the scene to the origin",
        )


def _uniquely_named(entries: Iterable[_Entry]) -> list[_Entry]:
    """The entries; a name that is taken gets the first free number."""
    entries = list(entries)
    reserved = {entry.name for entry in entries}
    taken: set[str] = set()
    numbers: dict[str, count[int]] = {}
    named: list[_Entry] = []
    for entry in entries:
        name = entry.name
        if name in taken:
            counter = numbers.setdefault(name, count(2))
            name = next(n for i in counter if (n := f"{entry.name}-{i}") not in reserved | taken)
        taken.add(name)
        named.append(replace(entry, name=name))
    return named


def _at_walls(entries: list[_Entry], walls: Walls) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names of those by hand that are captured inside a wall, and of others that are nearly.

    Panoramas are captured nowhere.
    """
    judged = [entry for entry in entries if entry.by_hand and entry.panorama is None]
    if not judged or len(walls.geometry.triangles) == 0:
        return (), ()
    points = np.array([entry.capture_position for entry in judged])
    buried = walls.sight(points).buried
    near = nearest_within(points, walls.geometry, NEAR_WALL_M).distance_m < NEAR_WALL_M
    inside, close = np.flatnonzero(buried), np.flatnonzero(near & ~buried)
    return tuple(judged[i].name for i in inside), tuple(judged[i].name for i in close)


def _warnings(
    probes: Probes, geometry: Geometry, tally: Tally, left_out: list[_Entry], made: int
) -> tuple[str, ...]:
    found: list[str] = []
    if tally.merged:
        names = _listed([entry.name for entry in left_out])
        found.append(
            f"{_probes(tally.merged)} within {SAME_PLACE_M * 1e3:g} mm of another, left out: "
            f"{names}"
        )
    if tally.in_walls:
        found.append(
            f"{_probes(len(tally.in_walls))} inside a wall or behind it: {_listed(tally.in_walls)}"
        )
    if tally.near_walls:
        found.append(
            f"{_probes(len(tally.near_walls))} nearer than {NEAR_WALL_M * 1e2:g} cm to a surface: "
            f"{_listed(tally.near_walls)}"
        )
    found += _of_generated(probes, tally, made)
    odd, turned = winding_faults(geometry)
    if odd + turned:
        found.append(
            f"the surface has {odd} edges of three triangles or more and {turned} whose "
            "triangles are wound against each other: what is inside a wall is told by majority"
        )
    return tuple(found)


def _of_generated(probes: Probes, tally: Tally, made: int) -> list[str]:
    kind = probes.placement.kind
    if kind == "lattice" and tally.moved + tally.dropped_in_walls + tally.too_near:
        return [
            f"of the lattice, {_probes(tally.moved)} moved out of walls or away from surfaces, "
            f"{tally.dropped_in_walls} inside walls and {tally.too_near} too near to one left out"
        ]
    if kind == "random" and made < probes.placement.count:
        return [
            f"only {made} of {probes.placement.count} random probes have room: "
            f"{tally.crowded} places were too near to one, {tally.dropped_in_walls} in walls, "
            f"{tally.too_near} too near to a surface"
        ]
    return []


def _probes(number: int) -> str:
    return f"{number} probe" if number == 1 else f"{number} probes"


def _listed(names: Iterable[str]) -> str:
    names = list(names)
    return ", ".join(names[:SHOWN_NAMES]) + (", …" if len(names) > SHOWN_NAMES else "")
