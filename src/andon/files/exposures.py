"""Lists of the exposures of a bracket, as HDRShop's and their like: text, a line a photograph.

::

    # Filename   exposure  1/shutter_speed  f/stop  gain(db)  ND_filters
    church1.png  32        0.03125          8       0         0
    church2.png  16        0.0625           8       0         0

The first two columns are needed; lines that start with # are comments. Exposure grows with time,
falls with the square of the f-number and doubles with every 3 dB of gain (the note on units beside
the memorial series of Debevec & Malik 1997). What the last column counts, densities or filters, is
stated nowhere: only 0 is accepted.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

from andon.errors import InputError
from andon.files.limits import DEFAULT_LIMITS, Limits, check_at_most
from andon.files.paths import confined, open_bounded
from andon.files.reader import Reader

__all__ = ["EXPOSURE_READERS", "ListedExposure", "read_exposures"]

MAX_PHOTOGRAPHS = 1024
COLUMNS = 6
GAIN_DB_OF_A_STOP = 3.0


@dataclass(frozen=True)
class ListedExposure:
    """One line: the photograph, inside the list's folder, and its exposure.

    `seconds` > 0 are those at the aperture and gain of the list's first line.
    """

    path: Path
    seconds: float


def read_exposures(
    path: str | Path, *, limits: Limits = DEFAULT_LIMITS
) -> tuple[ListedExposure, ...]:
    """The photographs of a list, which need not exist, in its order.

    Raises
    ------
    InputError
        if a line has too few or too many columns, a number is none or not > 0, a name leaves the
        list's folder or stands there twice, or there is no line at all.
    """
    data = open_bounded(path, limits, max_bytes=limits.max_header_bytes)
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError("must be UTF-8 text", file=path) from error
    rows = [line.split() for line in text.splitlines() if line.strip()]
    rows = [row for row in rows if not row[0].startswith("#")]
    check_at_most(len(rows), MAX_PHOTOGRAPHS, "photographs", path)
    if not rows:
        raise InputError("must name photographs, a line each: name and seconds", file=path)
    found: list[tuple[Path, float]] = []
    for row in rows:
        name = confined(row[0], Path(path).parent, file=path)
        if name in [listed for listed, _ in found]:
            raise InputError(f"names {row[0][:60]!r} twice", file=path)
        found.append((name, _exposure(row, path)))
    first = found[0][1] / _number(rows[0][1], path)
    return tuple(ListedExposure(name, exposure / first) for name, exposure in found)


def _exposure(row: list[str], path: str | Path) -> float:
    """s·2^(gain/3 dB)/N² of a line; N = 1 where it is not stated."""
    if not 2 <= len(row) <= COLUMNS:
        raise InputError(
            f"a line must have 2 to {COLUMNS} columns, got {' '.join(row)[:60]!r}", file=path
        )
    seconds = _number(row[1], path)
    aperture = _number(row[3], path) if len(row) > 3 else 1.0
    gain = _number(row[4], path, signed=True) if len(row) > 4 else 0.0
    if len(row) > 5 and _number(row[5], path, signed=True) != 0:
        raise InputError(
            "neutral density filters are not taken into account",
            file=path,
            remedy="put their share into the second column and write 0 in the last",
        )
    exposure = seconds / aperture**2 * 2 ** (min(max(gain, -300.0), 300.0) / GAIN_DB_OF_A_STOP)
    return exposure if exposure > 0 and math.isfinite(exposure) else _refused(row[1], path)


def _number(text: str, path: str | Path, *, signed: bool = False) -> float:
    try:
        value = float(text)
    except ValueError:
        return _refused(text, path)
    return value if math.isfinite(value) and (signed or value > 0) else _refused(text, path)


def _refused(text: str, path: str | Path) -> float:
    raise InputError(f"exposures must be finite numbers > 0, got {text[:40]!r}", file=path)


EXPOSURE_READERS = (Reader("exposures.list", (".txt",), read_exposures),)
