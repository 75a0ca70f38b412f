"""Which zone a point belongs to: the first whose boxes hold it, else that of the nearest box."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError, nearest_name
from andon.files.volumes.model import Zone

__all__ = ["beyond_box", "boxes_of", "chosen_zones", "zone_of"]

Float = NDArray[np.float64]
Int = NDArray[np.int32]

EVERYWHERE = np.array([[[-np.inf] * 3, [np.inf] * 3]])


def chosen_zones(zones: Sequence[Zone], names: Sequence[str], /) -> list[int]:
    """Numbers of the zones named, in their order in the volume; of none named, all.

    Raises
    ------
    InputError : a name that no zone has.
    """
    known = [zone.name for zone in zones]
    for name in names:
        if name not in known:
            near = nearest_name(name, known)
            raise InputError(
                f"no zone is called {name!r}",
                field="probes.zones",
                remedy=f"did you mean {near!r}?" if near else f"there are {known}",
            )
    return [number for number, name in enumerate(known) if not names or name in names]


def boxes_of(zones: Sequence[Zone], /) -> tuple[Float, Int]:
    """All boxes (b, 2, 3) in metres, zone by zone, and (b,) the number of each one's zone."""
    boxes = [EVERYWHERE if zone.boxes is None else np.asarray(zone.boxes) for zone in zones]
    numbers = [np.full(len(box), number, np.int32) for number, box in enumerate(boxes)]
    return np.concatenate(boxes).astype(np.float64).reshape(-1, 2, 3), np.concatenate(numbers)


def beyond_box(points: Float, box: Float, /) -> Float:
    """(q,) the square of the distance from points (q, 3) to a box (2, 3); 0 inside."""
    beyond = np.maximum(np.maximum(box[0] - points, points - box[1]), 0.0)
    return np.einsum("qi,qi->q", beyond, beyond)


def zone_of(points: Float, boxes: Float, box_zones: Int, /) -> Int:
    """(q,) the number of the zone of each point (q, 3); of a point with a NaN, any."""
    best = np.zeros(len(points), np.int32)
    if len(boxes) == 1:
        return best
    least = np.full(len(points), np.inf)
    for number, box in enumerate(boxes):
        square = beyond_box(points, box)
        nearer = square < least
        least[nearer], best[nearer] = square[nearer], number
    return box_zones[best]
