"""A probe volume as its file holds it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.files.volumes.model import Cells, ProbeVolume, Zone

__all__ = ["in_single", "rounded"]


def rounded(volume: ProbeVolume) -> ProbeVolume:
    """The volume with positions, ranges and coefficients rounded to float32, in float64 arrays.

    glTF has no float64. Writing and reading again gives exactly this. Whoever joins probes to
    cells does it with the rounded positions, or a thin tetrahedron may turn over when it is
    written. Boxes of zones and `far_m` are JSON numbers and stay as they are.
    """
    cells = volume.cells
    return replace(
        volume,
        positions=in_single(volume.positions),
        capture_positions=in_single(volume.capture_positions),
        ranges_m=in_single(volume.ranges_m),
        states={name: in_single(values) for name, values in volume.states.items()},
        zones=tuple(
            Zone(zone.name, np.asarray(zone.probes, np.int32), _boxes(zone))
            for zone in volume.zones
        ),
        cells=None if cells is None else _indices(cells),
    )


def in_single(values: NDArray[Any], /) -> NDArray[np.float64]:
    """The values rounded to float32, as float64."""
    with np.errstate(over="ignore", invalid="ignore"):  # what is too large is refused as inf
        return np.asarray(values, np.float32).astype(np.float64)


def _boxes(zone: Zone) -> NDArray[np.float64] | None:
    return None if zone.boxes is None else np.asarray(zone.boxes, np.float64)


def _indices(cells: Cells) -> Cells:
    return Cells(**{name: np.asarray(values, np.int32) for name, values in vars(cells).items()})
