"""States of light of one volume, as day and night: chosen, mixed, added.

Light adds, so between two states lies their weighted mean, coefficient by coefficient: it is
exactly the light of both states' lamps, each dimmed.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError, nearest_name
from andon.files.volumes import ProbeVolume

__all__ = ["state_coefficients", "with_state"]

Float = NDArray[np.float64]


def state_coefficients(
    volume: ProbeVolume,
    state: str | None = None,
    blend_state: str | None = None,
    blend: float = 0.0,
) -> Float:
    """The light of a volume in one state, or between two.

    Parameters
    ----------
    volume : whose light.
    state : None: its first.
    blend_state : a second state.
    blend : 0: `state` … 1: `blend_state`.

    Returns
    -------
    (n, k, 3) coefficients, cd/m²; of one state alone the volume's own array.

    Raises
    ------
    InputError
        if there is no such state, or `blend` is not in 0…1 or has no second state.
    """
    if not 0 <= blend <= 1:
        raise InputError(f"must be 0…1, got {blend:g}", field="blend")
    first = _state(volume, next(iter(volume.states)) if state is None else state, "state")
    if blend_state is None:
        if blend > 0:
            raise InputError("needs blend_state", field="blend")
        return first
    second = _state(volume, blend_state, "blend_state")
    if blend == 0:
        return first
    return (1 - blend) * first + blend * second


def _state(volume: ProbeVolume, name: str, field: str) -> Float:
    if name in volume.states:
        return volume.states[name]
    known = list(volume.states)
    near = nearest_name(name, known)
    raise InputError(
        f"there is no state {name!r}, there is {', '.join(map(repr, known))}",
        field=field,
        remedy=f"did you mean {near!r}?" if near else None,
    )


def with_state(volume: ProbeVolume, name: str, coefficients: NDArray[Any]) -> ProbeVolume:
    """The volume with a state more, or with that one replaced; the first stays the first.

    Raises
    ------
    InputError
        if the name is empty, or `coefficients` are not (n, k, 3) as those of the other states.
    """
    if not name:
        raise InputError("a state must have a name", field="state")
    values = np.asarray(coefficients, np.float64)
    shape = (volume.count, (volume.order + 1) ** 2, 3)
    if values.shape != shape:
        raise InputError(
            f"must have the shape {shape} as the volume's other states, has {values.shape}",
            field=f"state {name!r}",
            remedy="bake it with the same probes and order",
        )
    return replace(volume, states={**volume.states, name: values})
