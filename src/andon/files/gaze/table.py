"""Tables of gaze: rows of comma-separated numbers under a header, with gaps."""

from __future__ import annotations

import csv
import math
from array import array
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.limits import Limits, check_at_most
from andon.files.paths import open_bounded

__all__ = ["MAX_SAMPLES", "Table", "first", "rising", "to_cell"]

Float = NDArray[np.float64]

# 4.6 hours at 250 Hz, over an hour at 1000 Hz.
MAX_SAMPLES = 2**22
# Metres, pixels and areas stay far below; times of a Unix clock in seconds are 2·10⁹.
LARGEST = 1e12


class Table:
    """The columns of a CSV file that somebody asks for.

    Attributes
    ----------
    names : of the header, in its order.
    """

    def __init__(self, path: str | Path, limits: Limits) -> None:
        data = open_bounded(path, limits, max_bytes=limits.max_mesh_text_bytes)
        try:
            text = data.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            raise InputError("must be UTF-8 text", file=path) from error
        if "\0" in text:
            raise InputError("must be text, has zero bytes", file=path)
        self.path = path
        lines = enumerate(text.splitlines(), start=1)
        self._lines = ((n, line) for n, line in lines if line.strip() and line[0] != "#")
        first = next(self._lines, None)
        self.names = [] if first is None else [name.strip() for name in _cells(first, path)]

    def columns(self, wanted: Sequence[str]) -> Float:
        """(rows, wanted) numbers, NaN where a cell is empty. Reads the file to its end, once."""
        if len(set(self.names)) < len(self.names):
            raise InputError("must not name a column twice", file=self.path, field="line 1")
        places = [self.names.index(name) for name in wanted]
        numbers, rows = array("d"), 0
        for numbered in self._lines:
            cells, place = _cells(numbered, self.path), f"line {numbered[0]}"
            if len(cells) != len(self.names):
                raise InputError(
                    f"must have {len(self.names)} cells as the header has, has {len(cells)}",
                    file=self.path,
                    field=place,
                    remedy="if the recording broke off there, cut the line away",
                )
            rows += 1
            check_at_most(rows, MAX_SAMPLES, "rows", self.path)
            numbers.extend(
                to_cell(cells[at], self.path, f"{place}, {name}")
                for at, name in zip(places, wanted, strict=True)
            )
        return np.array(numbers, np.float64).reshape(rows, len(wanted))


def _cells(numbered: tuple[int, str], path: str | Path) -> list[str]:
    try:
        return next(csv.reader([numbered[1]]))
    except csv.Error as error:
        raise InputError(f"is no CSV: {error}", file=path, field=f"line {numbered[0]}") from error


def to_cell(cell: str, file: str | Path, field: str) -> float:
    """The number of a cell; NaN if it is empty, ``nan`` or ``.``, as trackers write a gap."""
    word = cell.strip()
    if not word or word == "." or word.lower() == "nan":
        return math.nan
    try:
        # float() also takes underscores and digits of other scripts, which no tracker writes.
        number = float(word) if word.isascii() and "_" not in word else math.inf
    except ValueError:
        number = math.inf
    if not abs(number) <= LARGEST:
        shown = repr(word if len(word) <= 40 else word[:39] + "…")
        raise InputError(f"must be a number of ±1e12 or empty, got {shown}", file=file, field=field)
    return number


def rising(times: Float) -> tuple[NDArray[np.bool_], dict[str, int]]:
    """Which rows are samples: later than all before. And how many are not, by reason."""
    timed = np.isfinite(times)
    filled = np.where(timed, times, -np.inf)
    latest = np.concatenate([[-np.inf], np.maximum.accumulate(filled)[:-1]])
    keep = timed & (filled > latest)
    counts = {
        "no time": ~timed,
        "time repeated": timed & (filled == latest),
        "time went back": timed & (filled < latest),
    }
    return keep, {reason: int(rows.sum()) for reason, rows in counts.items() if rows.any()}


def first(times: Float, file: str | Path) -> float:
    """The time that is called 0. Refuses a recording without a sample."""
    if not len(times):
        raise InputError("must have at least one sample", file=file)
    return float(times[0])
