"""What must hold in every probe volume: checked before one is written and after one is read."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, get_args

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.limits import DEFAULT_LIMITS, Limits, check_at_most
from andon.files.volumes.check_cells import check_cells
from andon.files.volumes.layout import MAX_SQUARE_PX, MAX_STATES, MAX_ZONES, ROLES
from andon.files.volumes.model import ProbeVolume, Zone
from andon.quantities import Photometry

__all__ = ["check_volume"]

MAX_ORDER = 4  # of the harmonics
Refuse = Callable[[str, str], InputError]


def check_volume(
    volume: ProbeVolume, *, file: str | None = None, limits: Limits = DEFAULT_LIMITS
) -> None:
    """Refuses a volume that a lookup could fail in, or whose light is none.

    Parameters
    ----------
    volume : in the terms of `ProbeVolume`.
    file : for the message.
    limits : `max_probes` of them.

    Raises
    ------
    InputError
        names the place in the terms of the format (``states[0]``, ``cells.corners[17]``), and the
        rule.
    """

    def refuse(field: str, rule: str) -> InputError:
        return InputError(rule, file=file, field=field)

    if volume.count < 1:
        raise refuse("positions", "a volume must have a probe or more")
    check_at_most(volume.count, limits.max_probes, "probes", file or "the volume")
    _check_probes(volume, refuse)
    _check_states(volume, refuse)
    _check_zones(volume, refuse)
    _check_distances(volume, refuse)
    if volume.photometry not in get_args(Photometry):
        raise refuse("photometry", "must be absolute or relative")
    if volume.cells is not None:
        check_cells(volume.cells, volume.positions, volume.zones, file)


def _check_array(
    values: NDArray[Any], shape: tuple[int, ...], field: str, refuse: Refuse, low: float = -np.inf
) -> None:
    """Shape, then finite, then ≥ low."""
    if values.shape != shape:
        raise refuse(field, f"must have the shape {shape}, has {values.shape}")
    wrong = ~(np.isfinite(values) & (values >= low))
    if wrong.any():
        at = int(np.flatnonzero(wrong.reshape(len(values), -1).any(axis=1))[0])
        rule = "must be finite" if low == -np.inf else f"must be finite and ≥ {low:g}"
        raise refuse(f"{field}[{at}]", rule)


def _check_probes(volume: ProbeVolume, refuse: Refuse) -> None:
    count = volume.count
    _check_array(volume.positions, (count, 3), "positions", refuse)
    _check_array(volume.capture_positions, (count, 3), "capturePositions", refuse)
    if volume.ranges_m.shape != (count,) or not (volume.ranges_m > 0).all():
        raise refuse("ranges", f"must be {count} distances > 0 m")
    for field, found in (("names", volume.names), ("roles", volume.roles)):
        if len(found) != count:
            raise refuse(field, f"must be {count}, one for each probe, are {len(found)}")
    if not set(volume.roles) <= set(ROLES):
        raise refuse("roles", f"must be of {', '.join(ROLES)}")


def _check_states(volume: ProbeVolume, refuse: Refuse) -> None:
    if not 1 <= len(volume.states) <= MAX_STATES:
        raise refuse("states", f"must be 1…{MAX_STATES}, are {len(volume.states)}")
    for number, values in enumerate(volume.states.values()):
        if values.ndim != 3:
            raise refuse(f"states[{number}]", f"must have three axes, has {values.ndim}")
    if not 0 <= volume.order <= MAX_ORDER:
        raise refuse("order", f"must be 0…{MAX_ORDER}, is {volume.order}")
    terms = (volume.order + 1) ** 2
    for number, (name, values) in enumerate(volume.states.items()):
        if not name:
            raise refuse(f"states[{number}].name", "must not be empty")
        place = f"states[{number}].coefficients"
        _check_array(values, (volume.count, terms, 3), place, refuse)
        dark = np.flatnonzero((values[:, 0] < 0).any(axis=1))
        if len(dark):
            raise refuse(
                place, f"probe {dark[0]} must have a mean luminance ≥ 0, its L00 is negative"
            )


def _check_zones(volume: ProbeVolume, refuse: Refuse) -> None:
    zones = volume.zones
    if not 1 <= len(zones) <= MAX_ZONES:
        raise refuse("zones", f"must be 1…{MAX_ZONES}, are {len(zones)}")
    names = [zone.name for zone in zones]
    if len(set(names)) < len(names):
        raise refuse("zones", "must have different names")
    for number, zone in enumerate(zones):
        _check_zone(zone, f"zones[{number}]", volume.count, refuse)
        if zone.boxes is None and len(zones) > 1:
            raise refuse(f"zones[{number}]", "must have boxes, since there are other zones")


def _check_zone(zone: Zone, place: str, count: int, refuse: Refuse) -> None:
    if not zone.name:
        raise refuse(f"{place}.name", "must not be empty")
    probes = zone.probes
    if probes.ndim != 1 or not len(probes) or not (np.diff(probes) > 0).all():
        raise refuse(f"{place}.probes", "must be rising numbers of probes, one or more")
    if probes[0] < 0 or probes[-1] >= count:
        wrong = int(probes[0] if probes[0] < 0 else probes[-1])
        raise refuse(f"{place}.probes", f"must be 0…{count - 1}, names the probe {wrong}")
    if zone.boxes is not None:
        if not len(zone.boxes):
            raise refuse(f"{place}.boxes", "must be one or more, or absent")
        _check_array(zone.boxes, (len(zone.boxes), 2, 3), f"{place}.boxes", refuse)
        if not (zone.boxes[:, 0] < zone.boxes[:, 1]).all():
            raise refuse(f"{place}.boxes", "the first corner must be below the second in x, y, z")


def _check_distances(volume: ProbeVolume, refuse: Refuse) -> None:
    distances = volume.distances
    if distances is None:
        return
    side = distances.mean_m.shape[-1]
    if not 1 <= side <= MAX_SQUARE_PX:
        raise refuse("distances.size", f"must be 1…{MAX_SQUARE_PX}, is {side}")
    for values in (distances.mean_m, distances.mean_square_m2):
        _check_array(values, (volume.count, side, side), "distances.moments", refuse, 0.0)
    if not (np.isfinite(distances.far_m) and distances.far_m > 0):
        raise refuse("distances.far", f"must be > 0 m, is {distances.far_m}")
