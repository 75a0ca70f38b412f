"""Measured camera responses: a CSV of encoded values and the linear light of each channel.

::

    encoded,linear_r,linear_g,linear_b
    0.0,0.0,0.0,0.0
    0.5,0.21,0.20,0.22
    1.0,1.0,1.0,1.0

Both sides are shares of the range, 0…1, and rise strictly; between the rows the curve is linear.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.atomic import write_bytes
from andon.files.limits import DEFAULT_LIMITS, Limits, check_at_most
from andon.files.paths import open_bounded
from andon.files.reader import Reader
from andon.responses import Response

__all__ = ["RESPONSE_READERS", "read_response", "write_response"]

COLUMNS = ("encoded", "linear_r", "linear_g", "linear_b")
# One row for each code of 16 bits.
MAX_ROWS = 65536


def read_response(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> Response:
    """The ``curve`` response of a CSV file.

    Raises
    ------
    InputError
        if the columns are others, a number is none, or a column does not rise strictly.
    """
    data = open_bounded(path, limits, max_bytes=limits.max_text_bytes)
    try:
        lines = data.decode("utf-8-sig").splitlines()
    except UnicodeDecodeError as error:
        raise InputError("must be UTF-8 text", file=path) from error
    rows = [line for line in lines if line.strip() and not line.lstrip().startswith("#")]
    header = tuple(name.strip() for name in rows[0].split(",")) if rows else ()
    if header != COLUMNS:
        came = repr(rows[0][:60]) if rows else "nothing"
        raise InputError(f"the first line must be {','.join(COLUMNS)}, got {came}", file=path)
    check_at_most(len(rows) - 1, MAX_ROWS, "rows", path)
    table = np.array([_numbers(row, path) for row in rows[1:]]).reshape(-1, len(COLUMNS))
    encoded = np.repeat(table[:, :1], 3, axis=1)
    try:
        return Response("curve", linear=table[:, 1:].copy(), encoded=encoded)
    except InputError as error:
        raise InputError(error.rule, file=path, field=error.field) from error


def _numbers(row: str, path: str | Path) -> list[float]:
    parts = row.split(",")
    try:
        values = [float(part) for part in parts]
    except ValueError:
        values = []
    if len(values) != len(COLUMNS) or not all(0 <= value <= 1 for value in values):
        raise InputError(f"a row must be four numbers of 0…1, got {row[:60]!r}", file=path)
    return values


def write_response(path: str | Path, response: Response, /) -> Path:
    """Write a ``curve`` response whose channels share their encoded values, as it is read."""
    assert response.encoded is not None
    assert response.linear is not None
    return _write_table(path, COLUMNS, np.column_stack([response.encoded[:, 0], response.linear]))


def _write_table(path: str | Path, columns: tuple[str, ...], rows: NDArray[np.float64]) -> Path:
    # 12 digits keep apart what differs by a millionth of a millionth of the range: rows rise.
    lines = [",".join(f"{value:.12g}" for value in row) for row in rows.tolist()]
    return write_bytes(path, "\n".join([",".join(columns), *lines, ""]).encode())


RESPONSE_READERS = (Reader("response.csv", (".csv",), read_response),)
