"""EULUMDAT: the photometric files of Europe, one value a line, type C only.

::

     1  maker              10  number of the luminaire   26   sets of lamps n, then for each:
     2  kind               11  name of the file          26a  number of lamps (< 0: absolute)
     3  symmetry Isym      12  date                      26b  type        26d  colour
     4  C planes Mc        13-15  luminaire, mm          26c  lumens      26e  colour rendering
     5  step of C          16-21  luminous area, mm                       26f  watts
     6  angles a plane Ng  22  downward flux, %          27   10 direct ratios
     7  step of γ          23  light output ratio, %     28   Mc angles C
     8  report             24  conversion factor         29   Ng angles γ
     9  name               25  tilt while measured       30   candela per 1000 lm, plane by plane

Candela are the numbers × conversion factor × lumens of the lamps / 1000. Several sets are
*alternatives*: the first is taken. The angles of all Mc planes are listed, the candela only of
those that Isym leaves:

==== ======================== ==================
Isym symmetric about          planes with values
==== ======================== ==================
0    nothing                  all
1    the vertical axis        the first
2    the plane C0–C180        C0…C180
3    the plane C90–C270       C270…C90, over C0
4    both                     C0…C90
==== ======================== ==================

The plane C0–C180 stands *across* the length of the luminaire (C0 runs *along* it in LM-63).

Source: Stockmar (1990), EULUMDAT; EN 13032-1 for the planes.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.limits import DEFAULT_LIMITS, Limits, check_at_most
from andon.files.photometry.model import Distribution
from andon.files.photometry.planes import (
    checked_angles,
    checked_candela,
    full_circle,
    is_angle,
)
from andon.files.photometry.text import MAX_ANGLES, MAX_VALUES, lines_of, to_number

__all__ = ["read_ldt"]

Float = NDArray[np.float64]

MAX_SETS = 20  # the format's own limit
DIRECT_RATIOS = 10
MILLIMETRES = 1e-3


class _Lamps(NamedTuple):
    """The first set of lamps: how many (< 0: absolute photometry), lm and W of them together."""

    number: float
    lumens: float
    watts: float


class _Lines:
    """The lines of the file, one field after the other."""

    def __init__(self, lines: list[str], file: str | Path) -> None:
        while lines and not lines[-1].strip():  # editors leave empty lines at the end
            lines = lines[:-1]
        self._lines, self._next, self.file = lines, 0, file

    def text(self, what: str) -> str:
        if self._next >= len(self._lines):
            raise InputError(
                f"ends before {what}",
                file=self.file,
                field=f"line {self._next}",
                remedy="the file is cut short, or its counts of angles are wrong",
            )
        self._next += 1
        return self._lines[self._next - 1].strip()

    def number(self, what: str, default: float | None = None, low: float | None = None) -> float:
        """A number with a point or a comma; `default` for an empty line."""
        text = self.text(what)
        if not text and default is not None:
            return default
        field = f"line {self._next}, {what}"
        number = to_number(text.replace(",", "."), self.file, field)
        if low is not None and number < low:
            raise InputError(f"must be ≥ {low:g}, got {number:g}", file=self.file, field=field)
        return number

    def integer(self, what: str, low: int, high: int) -> int:
        number = self.number(what)
        if number != int(number) or not low <= number <= high:
            raise InputError(
                f"must be a whole number of {low}…{high}, got {number:g}",
                file=self.file,
                field=f"line {self._next}, {what}",
            )
        return int(number)

    def numbers(self, count: int, what: str, low: float | None = None) -> list[float]:
        return [self.number(f"{what} {i + 1} of {count}", low=low) for i in range(count)]

    def skip(self, count: int, what: str) -> None:
        for _ in range(count):
            self.text(what)

    def end(self) -> None:
        if self._next < len(self._lines):
            raise InputError(
                f"must end here, goes on with {self._lines[self._next][:40]!r}",
                file=self.file,
                field=f"line {self._next + 1}",
                remedy="Isym, Mc or Ng does not fit the candela values",
            )


def read_ldt(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> Distribution:
    """The distribution of a EULUMDAT file.

    Raises
    ------
    InputError
        for a file that is cut short, whose counts and symmetry do not fit, or that holds
        impossible numbers.
    """
    lines = _Lines(lines_of(path, limits), path)
    maker = lines.text("maker")
    lines.text("kind of luminaire")
    symmetry = lines.integer("symmetry Isym", 0, 4)
    planes = lines.integer("number of C planes Mc", 1, MAX_ANGLES)
    lines.text("step of C")
    angles = lines.integer("number of angles Ng", 2, MAX_ANGLES)
    stored = _stored_planes(symmetry, planes, path)
    check_at_most(stored.stop - stored.start, MAX_VALUES // angles, "planes of this length", path)
    lines.text("step of γ")
    lines.text("report")
    name = lines.text("name")
    lines.skip(3, "number, file or date")
    lines.skip(3, "size of the luminaire")
    opening, is_round = _opening(lines)
    lines.text("downward flux")
    output_ratio = lines.number("light output ratio", default=0.0, low=0) / 100
    conversion = lines.number("conversion factor", default=1.0)
    if not conversion > 0:
        raise InputError(f"must be > 0, got {conversion:g}", file=path, field="conversion factor")
    lines.text("tilt while measured")
    lamps = _lamps(lines)
    lines.skip(DIRECT_RATIOS, "direct ratio")
    horizontal = lines.numbers(planes, "angle C")
    vertical = lines.numbers(angles, "angle γ")
    count = stored.stop - stored.start
    values = lines.numbers(count * angles, "candela value", low=0)
    lines.end()
    scale = conversion * lamps.lumens / 1000
    candela = checked_candela(values, scale, (count, angles), str(path))
    full, candela = _unfolded(symmetry, horizontal, stored, candela, str(path))
    checked = checked_angles(vertical, 0, 180, "angles γ", path)
    if not (is_angle(checked[0], 0) or is_angle(checked[0], 90)):
        raise InputError(f"must begin with 0 or 90, got {checked[0]:g}", file=path, field="γ")
    return Distribution(
        "C",
        full,
        checked,
        candela,
        name=name,
        manufacturer=maker,
        stated_lumens=lamps.lumens * output_ratio or None,
        lamp_lumens=None if lamps.number < 0 else lamps.lumens,
        watts=lamps.watts or None,
        opening_m=opening,
        is_round=is_round,
    )


def _stored_planes(symmetry: int, planes: int, path: str | Path) -> range:
    """Indices of the planes that have values; beyond `planes` they go on from the first."""
    quarters = {2: 2, 3: 4, 4: 4}.get(symmetry, 1)
    if planes % quarters:
        raise InputError(
            f"symmetry {symmetry} needs a number of planes that {quarters} divides, got {planes}",
            file=path,
            field="line 4",
        )
    if symmetry == 0:
        return range(planes)
    if symmetry == 1:
        return range(1)
    if symmetry == 2:
        return range(planes // 2 + 1)
    if symmetry == 3:
        first = 3 * planes // 4
        return range(first, first + planes // 2 + 1)
    return range(planes // 4 + 1)


def _opening(lines: _Lines) -> tuple[tuple[float, float, float], bool]:
    """Luminous area along C0, along C90, and its height, in metres; and whether it is round."""
    length = lines.number("length of the luminous area", default=0.0, low=0) * MILLIMETRES
    width = lines.number("width of the luminous area", default=0.0, low=0) * MILLIMETRES
    heights = [lines.number("height of the luminous area", default=0.0) for _ in range(4)]
    is_round = width == 0
    return (length if is_round else width, length, max(heights) * MILLIMETRES), is_round


def _lamps(lines: _Lines) -> _Lamps:
    """The first of the sets, which are alternatives."""
    sets = lines.integer("number of sets of lamps", 1, MAX_SETS)
    found: list[_Lamps] = []
    for _ in range(sets):
        count = lines.number("number of lamps", default=1.0)
        lines.text("type of lamps")
        lumens = lines.number("lumens of the lamps", low=0)
        lines.skip(2, "colour of the lamps")
        found.append(_Lamps(count, lumens, lines.number("watts", default=0.0, low=0)))
    if not found[0].lumens > 0:
        raise InputError("must be > 0, got 0", file=lines.file, field="lumens of the lamps")
    return found[0]


def _unfolded(
    symmetry: int, horizontals: list[float], stored: range, candela: Float, file: str
) -> tuple[Float, Float]:
    """C angles from 0° to 360°, both included, and candela (c, g) at them."""
    angles = checked_angles(horizontals, 0, 360, "angles C", file)
    if symmetry == 1:
        return full_circle(angles[:1] * 0, candela, file)
    if not is_angle(angles[0], 0):
        raise InputError(f"must begin with 0, got {angles[0]:g}", file=file, field="angles C")
    count = len(angles)
    own = np.array([angles[i % count] + 360 * (i // count) for i in stored])
    if symmetry == 0:
        return full_circle(own, candela, file)
    first, last = {2: (0, 180), 3: (270, 450), 4: (0, 90)}[symmetry]
    if not (is_angle(own[0], first) and is_angle(own[-1], last)):
        raise InputError(
            f"symmetry {symmetry} needs planes {first % 360}…{last % 360}°, has "
            f"{own[0] % 360:g}…{own[-1] % 360:g}°",
            file=file,
            field="angles C",
        )
    if symmetry == 3:  # 270…450 mirrors into 90…270, which `full_circle` knows
        return full_circle(540 - own[::-1], candela[::-1], file)
    return full_circle(own, candela, file)
