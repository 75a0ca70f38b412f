"""Text and numbers of photometric files: code pages, words with their line, finite numbers."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from pathlib import Path

from andon.errors import InputError
from andon.files.limits import Limits
from andon.files.paths import open_bounded

__all__ = [
    "MAX_ANGLES",
    "MAX_PHOTOMETRY_BYTES",
    "MAX_VALUES",
    "Words",
    "lines_of",
    "to_number",
]

# The finest goniophotometers step by 0.1° through half a turn; 10⁶ values of eight characters are
# 8 MB. (A street lamp measured at every degree has 5·10⁴ values.)
MAX_ANGLES = 3601
MAX_VALUES = 2**20
MAX_PHOTOMETRY_BYTES = 2**24

# Letters of DOS code page 850 (ä ö ü Ä Ö Ü é è à) that are quotes and dashes in Windows' 1252.
_DOS_LETTER = re.compile(rb"[A-Za-z][\x81\x82\x84\x85\x8a\x8e\x94\x99\x9a]")
_WINDOWS_LETTER = re.compile(rb"[\xc0-\xe0\xe2-\xff]")
# What float() takes and no standard does: underscores, words ("nan"), digits of other scripts.
_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?", re.ASCII)


def lines_of(path: str | Path, limits: Limits) -> list[str]:
    """The lines of a text file in UTF-8 or a code page of Windows (1252) or DOS (850).

    The formats predate Unicode and do not say their code page; only names depend on it.
    """
    data = open_bounded(path, limits, max_bytes=min(MAX_PHOTOMETRY_BYTES, limits.max_text_bytes))
    # Programs of DOS end a text with control-Z.
    data = data.split(b"\x1a", 1)[0]
    if b"\0" in data:
        raise InputError("must be text, has zero bytes", file=path)
    for page in ("utf-8-sig", "cp850" if _is_dos(data) else "cp1252", "cp850"):
        try:
            return re.split(r"\r\n|\n|\r", data.decode(page))
        except UnicodeDecodeError:
            continue
    raise AssertionError("code page 850 has a letter for every byte")


def _is_dos(data: bytes) -> bool:
    return _DOS_LETTER.search(data) is not None and _WINDOWS_LETTER.search(data) is None


def to_number(word: str, file: str | Path, field: str) -> float:
    """`word` as a finite number; otherwise an `InputError` that names `field`."""
    if _NUMBER.fullmatch(word):
        number = float(word)
        if math.isfinite(number):
            return number
    shown = repr(word if len(word) <= 40 else word[:39] + "…")
    raise InputError(f"must be a finite number, got {shown}", file=file, field=field)


class Words:
    """Numbers of a free-form text, one after the other, over the ends of lines.

    LM-63 separates by spaces, commas and line ends alike.
    """

    def __init__(self, lines: Iterable[str], first_line: int, file: str | Path) -> None:
        self._lines = enumerate(lines, start=first_line)
        self._waiting: list[str] = []
        self._line = first_line
        self.file = file

    @property
    def place(self) -> str:
        """The line of the last number."""
        return f"line {self._line}"

    def _fill(self) -> bool:
        while not self._waiting:
            following = next(self._lines, None)
            if following is None:
                return False
            self._line, text = following
            self._waiting = re.split(r"[,\s]+", text.strip(" \t,\f\v"))[::-1] if text else []
            self._waiting = [word for word in self._waiting if word]
        return True

    def number(self, what: str, low: float = -math.inf, high: float = math.inf) -> float:
        """The next number, low ≤ number ≤ high; `what` it is goes into messages."""
        if not self._fill():
            raise InputError(
                f"ends before {what}",
                file=self.file,
                field=self.place,
                remedy="the file is cut short, or its counts of angles are wrong",
            )
        number = to_number(self._waiting.pop(), self.file, f"{self.place}, {what}")
        if not low <= number <= high:
            bounds = f"≥ {low:g}" if high == math.inf else f"{low:g}…{high:g}"
            raise self.error(f"must be {bounds}, got {number:g}", what)
        return number

    def integer(self, what: str, low: int, high: int) -> int:
        """The next number, which is whole; ``1.0`` counts as whole, as programs write it."""
        number = self.number(what)
        if number != int(number) or not low <= number <= high:
            raise self.error(f"must be a whole number of {low}…{high}, got {number:g}", what)
        return int(number)

    def numbers(
        self, count: int, what: str, low: float = -math.inf, high: float = math.inf
    ) -> list[float]:
        """The next `count` numbers."""
        return [self.number(f"{what} {i + 1} of {count}", low, high) for i in range(count)]

    def end(self) -> None:
        """Refuses what is left over."""
        if self._fill():
            raise InputError(
                f"must end here, goes on with {self._waiting[-1][:40]!r}",
                file=self.file,
                field=self.place,
                remedy="the counts of angles do not fit the candela values",
            )

    def error(self, rule: str, what: str) -> InputError:
        """An error about the last number."""
        return InputError(rule, file=self.file, field=f"{self.place}, {what}")
