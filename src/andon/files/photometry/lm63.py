"""IES LM-63: the photometric files of North America, all versions from 1986 to 2019.

::

    IESNA:LM-63-2002                    1986 has no such line, 1991 says IESNA91, 2019 IES:…
    [MANUFAC] a maker                   labels; [MORE] continues the one before
    TILT=NONE | INCLUDE | <file>        INCLUDE: the table follows
    lamps lumens multiplier n_v n_h type units width length height
    ballast_factor future_use watts
    n_v vertical angles                 numbers from here on, over any number of lines
    n_h horizontal angles
    n_v candela of the first horizontal angle, of the second, …

Candela are the numbers times multiplier times ballast factor. The second number of the factors'
line was the ballast-lamp photometric factor in 1986 and 1991 and counts there; since 1995 it is 1
or, in 2019, a code of how the file was made, and does not. Lumens of −1 are absolute photometry:
the candela are the luminaire's own, whatever lamp is in it.

Source: ANSI/IES LM-63-19 and ANSI/IESNA LM-63-02.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.limits import DEFAULT_LIMITS, Limits, check_at_most
from andon.files.paths import confined
from andon.files.photometry.model import Distribution, PhotometricType, Tilt
from andon.files.photometry.planes import (
    checked_angles,
    checked_candela,
    full_circle,
    is_angle,
    mirrored,
)
from andon.files.photometry.text import MAX_ANGLES, MAX_VALUES, Words, lines_of, to_number

__all__ = ["read_ies"]

Float = NDArray[np.float64]

TYPES: dict[int, PhotometricType] = {1: "C", 2: "B", 3: "A"}
METRES = {1: 0.3048, 2: 1.0}
VERSIONS = {
    "IESNA91": 1991,
    "IESNA:LM-63-1995": 1995,
    "IESNA:LM-63-2002": 2002,
    "IES:LM-63-2019": 2019,
}
# Since this version the second factor is no factor any more.
PFACTOR_UNTIL = 1991
# The standard allows 132 characters in a line and has no end of labels.
MAX_LABELS = 10_000
MAX_TILT_ANGLES = 1000
LUMEN_LABELS = ("_ABSOLUTELUMENS", "ABSOLUTELUMENS", "_LUMINAIRELUMENS", "LUMINAIRELUMENS")

_LABEL = re.compile(r"\s*\[([^\]]*)\]\s*(.*)")


class _Header(NamedTuple):
    """The ten and the three numbers before the angles."""

    lamps: int
    lumens: float
    multiplier: float
    verticals: int
    horizontals: int
    photometry: PhotometricType
    size_m: tuple[float, float, float]
    ballast: float
    second_factor: float
    watts: float


def read_ies(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> Distribution:
    """The distribution of an IES LM-63 file.

    Raises
    ------
    InputError
        for a file that is no such file, is cut short, or holds impossible numbers; a TILT file is
        read only from the folder of `path`.
    """
    lines = lines_of(path, limits)
    tilt_line = next((i for i, line in enumerate(lines) if line.startswith("TILT=")), None)
    if tilt_line is None:
        raise InputError(
            "must have a line TILT=…", file=path, remedy="is it an IES LM-63 photometric file?"
        )
    version = VERSIONS.get(lines[0].strip().upper(), 1986)
    labels = _labels(lines[:tilt_line], path)
    words = Words(lines[tilt_line + 1 :], tilt_line + 2, path)
    tilt = _tilt(lines[tilt_line], tilt_line + 1, words, limits)
    header = _header(words)
    scale = header.multiplier * header.ballast
    if version <= PFACTOR_UNTIL:
        scale *= header.second_factor
    horizontal, vertical, candela = _grid(words, header, scale)
    along, across, height = header.size_m[1], header.size_m[0], header.size_m[2]
    return Distribution(
        header.photometry,
        horizontal,
        vertical,
        candela,
        name=_first(labels, "LUMCAT", "LUMINAIRE"),
        manufacturer=_first(labels, "MANUFAC"),
        stated_lumens=_stated(labels, path),
        lamp_lumens=None if header.lumens < 0 else header.lamps * header.lumens,
        watts=header.watts or None,
        opening_m=(abs(along), abs(across), abs(height)),
        is_round=along < 0 or across < 0,
        tilt=tilt,
        keywords=labels,
    )


def _labels(lines: list[str], path: str | Path) -> tuple[tuple[str, str], ...]:
    """(key, value) of the labels, [MORE] joined to what it continues."""
    check_at_most(len(lines), MAX_LABELS, "lines of labels", path)
    found: list[tuple[str, str]] = []
    for line in lines:
        match = _LABEL.match(line)
        if match is None:
            continue
        key, value = match[1].strip().upper(), match[2].strip()
        if key == "MORE" and found:
            found[-1] = (found[-1][0], f"{found[-1][1]} {value}".strip())
        else:
            found.append((key, value))
    return tuple(found)


def _first(labels: tuple[tuple[str, str], ...], *keys: str) -> str:
    """The value of the first of `keys` that is there and not empty."""
    values = dict(reversed(labels))
    return next((values[key] for key in keys if values.get(key)), "")


def _stated(labels: tuple[tuple[str, str], ...], path: str | Path) -> float | None:
    text = _first(labels, *LUMEN_LABELS)
    if not text:
        return None
    # A label is free text: "9217 LUMENS" and "9,217" are lumens, "SEE NOTE" is none.
    word = text.split()[0].replace(",", "")
    try:
        lumens = to_number(word, path, "absolute lumens")
    except InputError:
        return None
    return lumens if lumens > 0 else None


def _tilt(line: str, number: int, words: Words, limits: Limits) -> Tilt | None:
    kind = line.removeprefix("TILT=").strip()
    if kind == "NONE":
        return None
    if kind == "INCLUDE":
        return _tilt_table(words)
    folder = Path(words.file).parent
    try:
        path = confined(kind, folder, file=words.file)
    except InputError as error:
        raise InputError(
            error.rule, file=words.file, field=f"line {number}, TILT", remedy=error.remedy
        ) from error
    table = Words(lines_of(path, limits), 1, path)
    tilt = _tilt_table(table)
    table.end()
    return tilt


def _tilt_table(words: Words) -> Tilt:
    geometry = words.integer("lamp-to-luminaire geometry", 1, 3)
    count = words.integer("count of tilt angles", 1, MAX_TILT_ANGLES)
    angles = words.numbers(count, "tilt angle")
    factors = words.numbers(count, "tilt factor", 0)
    checked = checked_angles(angles, 0, 180, "tilt angles", words.file)
    return Tilt(geometry, checked, np.array(factors))


def _header(words: Words) -> _Header:
    lamps = words.integer("number of lamps", 1, 100_000)
    lumens = words.number("lumens per lamp")
    if lumens < 0 and lumens != -1:
        raise words.error(f"must be ≥ 0, or −1 for absolute photometry, got {lumens:g}", "lumens")
    multiplier = _factor(words, "multiplier")
    verticals = words.integer("count of vertical angles", 1, MAX_ANGLES)
    horizontals = words.integer("count of horizontal angles", 1, MAX_ANGLES)
    check_at_most(verticals * horizontals, MAX_VALUES, "candela values", words.file)
    photometry = TYPES[words.integer("photometric type", 1, 3)]
    metres = METRES[words.integer("unit of lengths", 1, 2)]
    # A luminaire of more than 1000 feet is a mistake; negative lengths are diameters.
    width, length, height = (
        words.number(name, -1000, 1000) * metres for name in ("width", "length", "height")
    )
    return _Header(
        lamps,
        lumens,
        multiplier,
        verticals,
        horizontals,
        photometry,
        (width, length, height),
        _factor(words, "ballast factor"),
        words.number("future use"),
        words.number("watts", 0),
    )


def _factor(words: Words, what: str) -> float:
    factor = words.number(what, 0)
    if factor == 0:
        raise words.error("must be > 0, got 0", what)
    return factor


def _grid(words: Words, header: _Header, scale: float) -> tuple[Float, Float, Float]:
    """Horizontal and vertical angles and candela (c, g), unfolded."""
    file = str(words.file)
    if not scale > 0:
        raise InputError("the product of the factors must be > 0", file=file, field="multiplier")
    verticals = words.numbers(header.verticals, "vertical angle")
    horizontals = words.numbers(header.horizontals, "horizontal angle")
    shape = (header.horizontals, header.verticals)
    values = words.numbers(shape[0] * shape[1], "candela value", 0)
    words.end()
    candela = checked_candela(values, scale, shape, file)
    if header.photometry != "C":
        return _sideways(header.photometry, horizontals, verticals, candela, file)
    vertical = checked_angles(verticals, 0, 180, "vertical angles", file)
    if len(vertical) < 2 or not (is_angle(vertical[0], 0) or is_angle(vertical[0], 90)):
        raise InputError(
            f"must begin with 0 or 90 and be two or more, begin with {vertical[0]:g}",
            file=file,
            field="vertical angles",
        )
    horizontal = checked_angles(horizontals, 0, 360, "horizontal angles", file)
    horizontal, candela = full_circle(horizontal, candela, file)
    return horizontal, vertical, candela


def _sideways(
    photometry: PhotometricType,
    horizontals: list[float],
    verticals: list[float],
    candela: Float,
    file: str,
) -> tuple[Float, Float, Float]:
    """The grid of types A and B; a half that begins with 0 is mirrored."""
    # Type A turns about the vertical, type B about a horizontal axis: the angle that goes round
    # is the horizontal one of A and the vertical one of B.
    limits = (180, 90) if photometry == "A" else (90, 180)
    horizontal = checked_angles(horizontals, -limits[0], limits[0], "horizontal angles", file)
    vertical = checked_angles(verticals, -limits[1], limits[1], "vertical angles", file)
    for angles, what in ((horizontal, "horizontal"), (vertical, "vertical")):
        if len(angles) < 2:
            raise InputError("types A and B need two or more", file=file, field=f"{what} angles")
    if is_angle(horizontal[0], 0):
        horizontal, candela = mirrored(horizontal, candela, 0.0)
    if is_angle(vertical[0], 0):
        vertical, turned = mirrored(vertical, candela.T, 0.0)
        candela = turned.T
    return horizontal, vertical, np.ascontiguousarray(candela)
