"""The numbers after a PLY header, as text or as bytes.

Both bodies offer the same two verbs: `columns` for a table whose rows are equally long, `lists`
for one with a list column (faces). Lists of one length, the common case of pure triangles, are
read as one array; others row by row.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.meshes.assemble import parse_numbers
from andon.files.numbers import to_float64

__all__ = ["BinaryBody", "Body", "Element", "Property", "TextBody"]

Columns = dict[str, NDArray[np.float64]]
Lists = tuple[NDArray[np.int64], NDArray[np.float64]]


@dataclass(frozen=True)
class Property:
    """One column: NumPy's type of its values, and of its length where it is a list."""

    name: str
    kind: str
    count_kind: str | None = None


@dataclass(frozen=True)
class Element:
    """One table of the file: its columns, and how many rows the header claims."""

    name: str
    count: int
    properties: tuple[Property, ...]

    def error(self, file: str) -> InputError:
        """For a body that has fewer rows than the header claims, or impossible lengths."""
        return InputError(
            f"must have {self.count} sound rows of {self.name}, is cut short or damaged", file=file
        )


class Body(Protocol):
    """A cursor over the elements, in the order of the header."""

    def columns(self, element: Element) -> Columns:
        """The columns (count,) of an element without lists."""
        ...

    def lists(self, element: Element, wanted: str) -> Lists:
        """Lengths (count,) and all values, row after row, of the list column `wanted`."""
        ...


class TextBody:
    """Numbers separated by white space."""

    def __init__(self, text: bytes, file: str) -> None:
        try:
            self._values = parse_numbers(text.decode("ascii"), np.float64)
        except ValueError as error:
            raise InputError("must hold numbers after the header", file=file) from error
        self._at, self._file = 0, file

    def columns(self, element: Element) -> Columns:
        """See `Body.columns`."""
        width = len(element.properties)
        end = self._at + width * element.count
        if end > len(self._values):
            raise element.error(self._file)
        rows = self._values[self._at : end].reshape(element.count, width)
        self._at = end
        return {p.name: rows[:, i] for i, p in enumerate(element.properties)}

    def lists(self, element: Element, wanted: str) -> Lists:
        """See `Body.lists`."""
        if len(element.properties) == 1 and element.count:
            found = self._uniform(element)
            if found is not None:
                return found
        values, at = self._values, self._at
        if element.count > len(values) - at:  # a row has one number at least
            raise element.error(self._file)
        counts = np.zeros(element.count, np.int64)
        parts: list[NDArray[np.float64]] = []
        for row in range(element.count):
            for column in element.properties:
                length = 1
                if column.count_kind is not None:
                    length = _length(values[at]) if at < len(values) else -1
                    at += 1
                if length < 0 or at + length > len(values):
                    raise element.error(self._file)
                if column.name == wanted:
                    counts[row] = length
                    parts.append(values[at : at + length])
                at += length
        self._at = at
        return counts, np.concatenate(parts) if parts else np.empty(0)

    def _uniform(self, element: Element) -> Lists | None:
        """The lists if all have the length of the first, else None."""
        if self._at >= len(self._values):
            raise element.error(self._file)
        length = _length(self._values[self._at])
        end = self._at + (length + 1) * element.count
        if length < 0 or end > len(self._values):
            return None
        rows = self._values[self._at : end].reshape(element.count, length + 1)
        if (rows[:, 0] != length).any():
            return None
        self._at = end
        return np.full(element.count, length), rows[:, 1:].ravel()


class BinaryBody:
    """Packed values in the byte order `order` (``<`` or ``>``)."""

    def __init__(self, data: bytes, at: int, order: str, file: str) -> None:
        self._data, self._at, self._order, self._file = data, at, order, file

    def columns(self, element: Element) -> Columns:
        """See `Body.columns`."""
        rows = self._rows(element, [(p.name, self._order + p.kind) for p in element.properties])
        return {p.name: to_float64(rows[p.name]) for p in element.properties}

    def lists(self, element: Element, wanted: str) -> Lists:
        """See `Body.lists`."""
        found = self._uniform(element, wanted) if element.count else None
        if found is not None:
            return found
        at = self._at
        if element.count > len(self._data) - at:  # a row has one byte at least
            raise element.error(self._file)
        counts = np.zeros(element.count, np.int64)
        parts: list[NDArray[np.float64]] = []
        kinds = [
            (p.name == wanted, np.dtype(self._order + p.kind), self._count_kind(p))
            for p in element.properties
        ]
        for row in range(element.count):
            for is_wanted, kind, count_kind in kinds:
                length = 1
                if count_kind is not None:
                    length = _length(self._one(at, count_kind, element))
                    at += count_kind.itemsize
                end = at + length * kind.itemsize
                if length < 0 or end > len(self._data):
                    raise element.error(self._file)
                if is_wanted:
                    counts[row] = length
                    values = np.frombuffer(self._data, kind, count=length, offset=at)
                    parts.append(to_float64(values))
                at = end
        self._at = at
        return counts, np.concatenate(parts) if parts else np.empty(0)

    def _count_kind(self, column: Property) -> np.dtype[Any] | None:
        return None if column.count_kind is None else np.dtype(self._order + column.count_kind)

    def _one(self, at: int, kind: np.dtype[Any], element: Element) -> float:
        if at + kind.itemsize > len(self._data):
            raise element.error(self._file)
        return float(np.frombuffer(self._data, kind, count=1, offset=at)[0])

    def _uniform(self, element: Element, wanted: str) -> Lists | None:
        """The lists if every row has the lengths of the first, else None."""
        fields: list[tuple[Any, ...]] = []
        lengths: dict[str, int] = {}
        at = self._at
        for column in element.properties:
            kind, count_kind = np.dtype(self._order + column.kind), self._count_kind(column)
            length = 1
            if count_kind is None:
                fields.append((column.name, kind))
            else:
                length = _length(self._one(at, count_kind, element))
                at += count_kind.itemsize
                lengths[column.name] = length
                if not 0 <= length <= 2**16:
                    return None
                fields.append((f"{column.name} length", count_kind))
                fields.append((column.name, kind, (length,)))
            at += length * kind.itemsize
        size = np.dtype(fields).itemsize * element.count
        if self._at + size > len(self._data):
            return None
        start = self._at
        rows = self._rows(element, fields)
        if any((rows[f"{name} length"] != length).any() for name, length in lengths.items()):
            self._at = start
            return None
        flat = to_float64(rows[wanted]).ravel()
        return np.full(element.count, lengths[wanted]), flat

    def _rows(self, element: Element, fields: list[Any]) -> NDArray[Any]:
        kind = np.dtype(fields)
        if self._at + kind.itemsize * element.count > len(self._data):
            raise element.error(self._file)
        rows = np.frombuffer(self._data, kind, count=element.count, offset=self._at)
        self._at += kind.itemsize * element.count
        return rows


def _length(value: float) -> int:
    """A list's length as a whole number, or −1 if it is none."""
    return int(value) if 0 <= value <= 2**31 and value == int(value) else -1
