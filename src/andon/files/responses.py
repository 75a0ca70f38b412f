"""Measured responses as CSV: of a camera, and of a surface that a camera sees.

::

    encoded,linear_r,linear_g,linear_b        illuminance_lux,linear_r,linear_g,linear_b
    0.0,0.0,0.0,0.0                           0,0.0011,0.0010,0.0013
    0.5,0.21,0.20,0.22                        120,0.061,0.048,0.030
    1.0,1.0,1.0,1.0                           480,0.236,0.190,0.113

Columns rise strictly, and between the rows a curve is linear. Of a camera all values are shares of
its range, 0…1; of a surface the light on it in lx, and the *linear* camera values (1 is the
sensor's white) that the camera delivers of it. Lines that begin with # are not read.
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
from andon.responses import Response, SurfaceCurve

__all__ = [
    "RESPONSE_READERS",
    "read_response",
    "read_surface_response",
    "write_response",
    "write_surface_response",
]

COLUMNS = ("encoded", "linear_r", "linear_g", "linear_b")
SURFACE_COLUMNS = ("illuminance_lux", "linear_r", "linear_g", "linear_b")
# One row for each code of 16 bits.
MAX_ROWS = 65536


def read_response(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> Response:
    """The ``curve`` response of a CSV file.

    Raises
    ------
    InputError
        if the columns are others, a number is none, or a column does not rise strictly.
    """
    table = _read_table(path, COLUMNS, limits, most=1.0)
    encoded = np.repeat(table[:, :1], 3, axis=1)
    try:
        return Response("curve", linear=table[:, 1:].copy(), encoded=encoded)
    except InputError as error:
        raise InputError(error.rule, file=path, field=error.field) from error


def read_surface_response(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> SurfaceCurve:
    """The illuminance–RGB curve of a surface from a CSV file, 2 rows at least.

    Raises
    ------
    InputError
        if the columns are others, a number is none or < 0, or a column does not rise strictly.
    """
    table = _read_table(path, SURFACE_COLUMNS, limits, most=float(np.finfo(np.float32).max))
    try:
        return SurfaceCurve(table[:, 0].copy(), table[:, 1:].copy())
    except InputError as error:
        raise InputError(
            error.rule,
            file=path,
            field=error.field,
            remedy="andon calibrate surface writes such a file",
        ) from error


def _read_table(
    path: str | Path, columns: tuple[str, ...], limits: Limits, *, most: float
) -> NDArray[np.float64]:
    """(rows, columns) numbers of 0…most under a header that names the columns."""
    data = open_bounded(path, limits, max_bytes=limits.max_text_bytes)
    try:
        lines = data.decode("utf-8-sig").splitlines()
    except UnicodeDecodeError as error:
        raise InputError("must be UTF-8 text", file=path) from error
    rows = [line for line in lines if line.strip() and not line.lstrip().startswith("#")]
    header = tuple(name.strip() for name in rows[0].split(",")) if rows else ()
    if header != columns:
        came = repr(rows[0][:60]) if rows else "nothing"
        raise InputError(f"the first line must be {','.join(columns)}, got {came}", file=path)
    check_at_most(len(rows) - 1, MAX_ROWS, "rows", path)
    return np.array([_numbers(row, path, most) for row in rows[1:]]).reshape(-1, len(columns))


def _numbers(row: str, path: str | Path, most: float) -> list[float]:
    parts = row.split(",")
    try:
        values = [float(part) for part in parts]
    except ValueError:
        values = []
    if len(values) != len(COLUMNS) or not all(0 <= value <= most for value in values):
        wanted = "four numbers of 0…1" if most == 1 else "four finite numbers ≥ 0"
        raise InputError(f"a row must be {wanted}, got {row[:60]!r}", file=path)
    return values


def write_response(path: str | Path, response: Response, /) -> Path:
    """Write a ``curve`` response whose channels share their encoded values, as it is read."""
    assert response.encoded is not None
    assert response.linear is not None
    return _write_table(path, COLUMNS, np.column_stack([response.encoded[:, 0], response.linear]))


def write_surface_response(path: str | Path, curve: SurfaceCurve, /) -> Path:
    """Write a surface's curve as `read_surface_response` takes it."""
    rows = np.column_stack([curve.illuminance_lux, curve.linear])
    return _write_table(path, SURFACE_COLUMNS, rows)


def _write_table(path: str | Path, columns: tuple[str, ...], rows: NDArray[np.float64]) -> Path:
    # 12 digits keep apart what differs by a millionth of a millionth of the range: rows rise.
    lines = [",".join(f"{value:.12g}" for value in row) for row in rows.tolist()]
    return write_bytes(path, "\n".join([",".join(columns), *lines, ""]).encode())


RESPONSE_READERS = (
    Reader("response.csv", (".csv",), read_response),
    Reader("surface-response.csv", (".csv",), read_surface_response),
)
