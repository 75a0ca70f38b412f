"""Which probes belong to the zones that a scene states."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.volumes.model import Zone
from andon.files.volumes.rounded import in_single
from andon.scene import Scene
from andon.transport.probes.zones import beyond_box

__all__ = ["zones_of"]

Float = NDArray[np.float64]
WHOLE = "all"


def zones_of(scene: Scene, positions: Float, /) -> tuple[Zone, ...]:
    """The zones of [[probes.zone]] with their probes, of those at `positions` (n, 3).

    A probe belongs to every zone that has it in a box, and one in no box to the zone whose box is
    nearest. A scene without zones has one, which is all of space.

    Raises `InputError` for a zone without a probe.
    """
    tables = () if scene.probes is None else scene.probes.zone
    if not tables:
        return (Zone(WHOLE, np.arange(len(positions), dtype=np.int32)),)
    names = tuple(dict.fromkeys(table.name for table in tables))
    numbers = np.array([names.index(table.name) for table in tables])
    boxes = np.array([(table.low, table.high) for table in tables])
    # Probes lie where float32 has them: one on the side of a box is judged by that side's float32.
    away = np.stack([beyond_box(positions, in_single(box)) for box in boxes], axis=1)
    belongs = away <= away.min(axis=1, keepdims=True)
    found: list[Zone] = []
    for number, name in enumerate(names):
        probes = np.flatnonzero(belongs[:, numbers == number].any(axis=1)).astype(np.int32)
        if len(probes) == 0:
            index = int(np.flatnonzero(numbers == number)[0])
            raise InputError(
                f"no probe lies in the zone {name!r}",
                file=scene.file,
                field=f"probes.zone[{index}]",
                remedy="place one in it, or leave the zone out",
            )
        found.append(Zone(name, probes, boxes[numbers == number]))
    return tuple(found)
