"""The three CSV tables of gaze: Pupil Labs Core's, our own with rays, our own with a distance.

========================= ==================================================== ==================
table                     columns that it is known by                          frame
========================= ==================================================== ==================
Pupil Labs Core, 3-D      ``gaze_timestamp, eye_center0_3d_x, gaze_normal0_x…`` camera: x right,
export of `gaze_positions` eye 0 is the right one, millimetres                  y down, z forward
ours, rays                ``time_seconds, left_origin_x_m, left_direction_x…`` any; both eyes in
                                                                               the same
ours, distance            ``time_seconds`` and ``distance_m`` or ``dioptres``   from between the
                                                                               eyes
========================= ==================================================== ==================

Other columns are passed over. An empty cell is a gap: monocular rows have the other eye's cells
empty. ``confidence`` is optional in ours, one number for both eyes.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.gaze.model import DistanceRecording, GazeRecording
from andon.files.gaze.table import Table, first, rising
from andon.files.limits import DEFAULT_LIMITS, Limits

__all__ = ["FARTHEST_EYE_M", "OWN_COLUMNS", "PUPIL_COLUMNS", "eye_rays", "read_gaze_table"]

Float = NDArray[np.float64]

# Left eye, then right; of each the origin, then the direction.
OWN_COLUMNS = tuple(
    f"{eye}_{what}_{axis}{unit}"
    for eye in ("left", "right")
    for what, unit in (("origin", "_m"), ("direction", ""))
    for axis in "xyz"
)
PUPIL_COLUMNS = tuple(
    f"{name}_{axis}"
    for eye in (1, 0)
    for name in (f"eye_center{eye}_3d", f"gaze_normal{eye}")
    for axis in "xyz"
)
METRES_PER_PUPIL_UNIT = 1e-3
# Programs round; beyond this it is another quantity.
CONFIDENCE_TOLERANCE = 1e-3
# From the origin of the frame: more is millimetres where metres are meant.
FARTHEST_EYE_M = 20.0
MOST_DIOPTRES = 100.0


def read_gaze_table(
    path: str | Path, *, limits: Limits = DEFAULT_LIMITS
) -> GazeRecording | DistanceRecording:
    """The recording of a CSV file, by its columns.

    Raises
    ------
    InputError
        if the columns are of none of the three tables, a row has another number of cells than the
        header, a cell is neither a number nor empty, or a number is impossible.
    """
    table = Table(path, limits)
    names = set(table.names)
    if {"gaze_timestamp", *PUPIL_COLUMNS} <= names:
        return _rays(table, "gaze_timestamp", PUPIL_COLUMNS, METRES_PER_PUPIL_UNIT)
    if {"time_seconds", *OWN_COLUMNS} <= names:
        return _rays(table, "time_seconds", OWN_COLUMNS, 1.0)
    quantity = [name for name in ("distance_m", "dioptres") if name in names]
    if "time_seconds" in names and len(quantity) == 1:
        return _distances(table, quantity[0])
    raise InputError(
        "must have the columns of Pupil Labs Core's gaze_positions.csv (3-D), or time_seconds with "
        f"left_origin_x_m…right_direction_z, distance_m or dioptres; has {_shown(table.names)}",
        file=path,
        remedy="docs/gaze.md lists them",
    )


def _shown(names: list[str]) -> str:
    text = ", ".join(names) or "none"
    return repr(text if len(text) <= 80 else text[:79] + "…")


def _read(
    table: Table, time: str, wanted: tuple[str, ...]
) -> tuple[Float, Float, Float, dict[str, int]]:
    """Times from the first, confidence, the wanted columns, and what was dropped."""
    has = "confidence" in table.names
    numbers = table.columns((time, *(("confidence",) if has else ()), *wanted))
    keep, dropped = rising(numbers[:, 0])
    kept = numbers[keep]
    times = kept[:, 0] - first(kept[:, 0], table.path)
    confidence = kept[:, 1] if has else np.ones(len(kept))
    # Not stated of this sample: it is trusted as little as can be.
    confidence = np.where(np.isnan(confidence), 0.0, confidence)
    _check(confidence, 0, 1 + CONFIDENCE_TOLERANCE, "confidence", table.path)
    return times, np.minimum(confidence, 1.0), kept[:, 1 + has :], dropped


def _check(values: Float, low: float, high: float, what: str, path: str | Path) -> None:
    outside = values[(values < low) | (values > high)]
    if len(outside):
        raise InputError(f"must be {low:g}…{high:g}, got {outside[0]:g}", file=path, field=what)


def eye_rays(numbers: Float, /, metres_per_unit: float = 1.0) -> tuple[Float, Float]:
    """(n, 2, 3) origins in metres and (n, 2, 3) unit directions of (n, 12) numbers.

    The order is that of `OWN_COLUMNS`. What of an eye is NaN, or is no direction (trackers write
    (0, 0, 0) for one that they do not have), makes all of that eye NaN.
    """
    rays = numbers.reshape(-1, 2, 2, 3)
    origins = rays[:, :, 0] * metres_per_unit
    lengths = np.linalg.norm(rays[:, :, 1], axis=-1, keepdims=True)
    directions = np.divide(
        rays[:, :, 1], lengths, out=np.full_like(origins, np.nan), where=lengths > 0
    )
    gone = np.isnan(origins).any(axis=-1) | np.isnan(directions).any(axis=-1)
    origins[gone], directions[gone] = np.nan, np.nan
    return origins, directions


def _rays(table: Table, time: str, wanted: tuple[str, ...], metres: float) -> GazeRecording:
    times, confidence, numbers, dropped = _read(table, time, wanted)
    origins, directions = eye_rays(numbers, metres)
    farthest = np.abs(origins[np.isfinite(origins)])
    _check(farthest, 0, FARTHEST_EYE_M, "origin of an eye, metres", table.path)
    return GazeRecording(times, origins, directions, confidence, dropped)


def _distances(table: Table, quantity: str) -> DistanceRecording:
    times, confidence, numbers, dropped = _read(table, "time_seconds", (quantity,))
    values = numbers[:, 0]
    if quantity == "distance_m":
        _check(values, 1 / MOST_DIOPTRES, np.inf, quantity, table.path)
        values = 1 / values
    _check(values, 0, MOST_DIOPTRES, quantity, table.path)
    return DistanceRecording(times, values, confidence, dropped)
