"""What becomes of the states that a volume has when one more is baked into it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from andon.errors import InputError
from andon.files.volumes import ProbeVolume, Zone, read_volume, rounded
from andon.scene import Scene
from andon.scene.probes import Probes
from andon.transport.probes.placement import Placed, unlit_volume
from andon.transport.probes.states import with_state

__all__ = ["check_states", "differences", "joined", "planned"]


def planned(scene: Scene, probes: Probes, placed: Placed, state: str, /) -> ProbeVolume:
    """The volume that a bake will write, without cells, and dark."""
    dark = np.zeros((placed.count, (probes.order + 1) ** 2, 3))
    return replace(unlit_volume(scene, placed), states={state: dark})


def check_states(path: Path, volume: ProbeVolume, /, *, replaces: bool) -> tuple[str, ...]:
    """In what the probes of the file at `path` differ from those of `volume`; empty: in nothing.

    Raises `InputError` where there is a file that is no volume, and, unless `replaces`, where
    states of it would be lost that `volume` has not.
    """
    if not path.exists():
        return ()
    old = _read(path)
    found = differences(old, rounded(volume))
    lost = [name for name in old.states if name not in volume.states]
    if found and lost and not replaces:
        names = ", ".join(map(repr, lost))
        raise InputError(
            f"its {'state' if len(lost) == 1 else 'states'} {names} would be lost: it has "
            + "; ".join(found),
            file=path,
            remedy="bake with the same probes, name another probes.volume, or give --replace",
        )
    return found


def joined(path: Path, volume: ProbeVolume, /) -> ProbeVolume:
    """The volume with the other states of the file, if its probes are the same."""
    if not path.exists():
        return volume
    old = _read(path)
    if differences(old, rounded(volume)):
        return volume
    for name, coefficients in volume.states.items():
        old = with_state(old, name, coefficients)
    return replace(volume, states=old.states, notes={**old.notes, **volume.notes})


def _read(path: Path) -> ProbeVolume:
    try:
        return read_volume(path)
    except InputError as error:
        raise InputError(
            error.rule,
            file=error.file or path,
            field=error.field,
            remedy="a bake would write a probe volume there: move this file away, or name another "
            "probes.volume",
        ) from error


def differences(old: ProbeVolume, new: ProbeVolume, /) -> tuple[str, ...]:
    """In what two volumes' probes differ, as "old, not new"; light and cells do not count."""
    if old.count != new.count:
        return (f"{old.count} probes, not {new.count}",)
    found: list[str] = []
    if old.order != new.order:
        found.append(f"order {old.order}, not {new.order}")
    if old.photometry != new.photometry:
        found.append(f"{old.photometry} light, not {new.photometry}")
    places = (old.positions, new.positions), (old.capture_positions, new.capture_positions)
    for (a, b), what in zip(places, ("at other places", "captured elsewhere"), strict=True):
        moved = np.flatnonzero((a != b).any(axis=1))
        if len(moved):
            found.append(f"{len(moved)} probes {what}, as {old.names[moved[0]]!r}")
    words = (
        ("names", old.names == new.names),
        ("roles", old.roles == new.roles),
        ("ranges", np.array_equal(old.ranges_m, new.ranges_m)),
        ("zones", _same_zones(old.zones, new.zones)),
    )
    return (*found, *(f"other {what}" for what, is_same in words if not is_same))


def _same_zones(old: tuple[Zone, ...], new: tuple[Zone, ...]) -> bool:
    return len(old) == len(new) and all(
        a.name == b.name and np.array_equal(a.probes, b.probes) and _same_boxes(a, b)
        for a, b in zip(old, new, strict=True)
    )


def _same_boxes(a: Zone, b: Zone) -> bool:
    if a.boxes is None or b.boxes is None:
        return a.boxes is b.boxes
    return np.array_equal(a.boxes, b.boxes)
