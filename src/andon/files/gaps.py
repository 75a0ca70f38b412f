"""Lists of gaps between leaves: where each is, and how large.

::

    azimuth_degrees,elevation_degrees,diameter_degrees        [{"azimuth_degrees": 3.5,
    3.5,12.0,0.2                                                "elevation_degrees": 12.0,
    -4.0,9.5,0.35                                               "diameter_degrees": 0.2}, …]

CSV or JSON. Azimuth grows to the right of straight ahead, elevation upwards.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.gaze.table import Table
from andon.files.limits import DEFAULT_LIMITS, Limits, check_at_most
from andon.files.paths import open_bounded
from andon.files.reader import Reader, choose_reader
from andon.files.tree import Tree, check_complexity

__all__ = ["GAP_READERS", "read_gap_list"]

Float = NDArray[np.float64]

COLUMNS = ("azimuth_degrees", "elevation_degrees", "diameter_degrees")
RANGES = ((-180.0, 180.0), (-90.0, 90.0), (0.0, 90.0))
MOST_GAPS = 100_000


def read_gap_list(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> Float:
    """(n, 3) azimuth, elevation, diameter > 0 in degrees of n ≥ 1 gaps.

    Raises
    ------
    InputError
        if the suffix is unknown, a column is missing, or a number is none or out of range.
    """
    found: Float = choose_reader(path, GAP_READERS, "list of gaps").read(path, limits=limits)
    return found


def _read_csv(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> Float:
    table = Table(path, limits)
    for name in COLUMNS:
        if name not in table.names:
            raise InputError(f"must have a column {name}", file=path, field="line 1")
    return _checked(table.columns(COLUMNS), path)


def _read_json(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> Float:
    data = open_bounded(path, limits, max_bytes=limits.max_mesh_text_bytes)
    try:
        value: Any = json.loads(data.decode("utf-8-sig"))
    except (ValueError, RecursionError) as error:
        raise InputError("must be sound JSON", file=path) from error
    check_complexity(value, str(path), limits)
    entries = Tree(value, "", str(path)).elements()
    check_at_most(len(entries), MOST_GAPS, "gaps", path)
    rows: list[list[float]] = []
    for entry in entries:
        entry.only(COLUMNS)
        rows.append([entry.at(name).number() for name in COLUMNS])
    return _checked(np.array(rows, np.float64).reshape(-1, 3), path)


def _checked(gaps: Float, path: str | Path) -> Float:
    check_at_most(len(gaps), MOST_GAPS, "gaps", path)
    if not len(gaps):
        raise InputError("must have at least one gap", file=path)
    for values, name, (low, high) in zip(gaps.T, COLUMNS, RANGES, strict=True):
        wrong = ~((values >= low) & (values <= high))
        if name == "diameter_degrees":
            wrong |= values <= 0
        if wrong.any():
            number = int(np.argmax(wrong))
            rule = f"must be in {low:g}…{high:g}°, got {values[number]:g}"
            raise InputError(rule, file=path, field=f"gap {number + 1}, {name}")
    return gaps


GAP_READERS = (
    Reader("gaps.csv", (".csv",), _read_csv),
    Reader("gaps.json", (".json",), _read_json),
)
