"""Typed access to parsed TOML, YAML and JSON, with errors that name the place.

The parsers return nested dicts, lists and scalars of unknown type; `Tree` is one of those values
together with where it stands, so that "materials[3].name: must be text, got 7" needs no effort.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, cast

from andon.errors import InputError, nearest_name
from andon.files.limits import Limits

__all__ = ["Tree", "check_complexity"]


def check_complexity(value: Any, file: str, limits: Limits) -> None:
    """Refuse parsed data with more than `max_nodes` containers or `max_depth` levels."""
    count = 0
    stack: list[tuple[Any, int]] = [(value, 1)]
    while stack:
        item, depth = stack.pop()
        if not isinstance(item, dict | list):
            continue
        if isinstance(item, dict):
            inner = list(cast("dict[str, Any]", item).values())
        else:
            inner = cast("list[Any]", item)
        count += 1
        if count > limits.max_nodes or depth > limits.max_depth:
            raise InputError(
                f"must have at most {limits.max_nodes} lists and tables, nested at most "
                f"{limits.max_depth} deep",
                file=file,
            )
        stack.extend((child, depth + 1) for child in inner)


def _short(value: Any) -> str:
    kind = type(value).__name__
    shown = kind if kind in ("dict", "list") else repr(value)
    return shown if len(shown) <= 60 else shown[:57] + "..."


@dataclass(frozen=True)
class Tree:
    """A parsed `value`, its `place` in the file ("camera.fx") and the `file`."""

    value: Any
    place: str
    file: str

    def error(self, rule: str, remedy: str | None = None) -> InputError:
        """An error about this value."""
        return InputError(rule, file=self.file, field=self.place or None, remedy=remedy)

    def table(self) -> dict[str, Any]:
        """The value as a table (dict with text keys)."""
        if not isinstance(self.value, dict):
            raise self.error(f"must be a table, got {_short(self.value)}")
        return cast("dict[str, Any]", self.value)

    def __contains__(self, key: str) -> bool:
        return key in self.table()

    def get(self, key: str) -> Tree | None:
        """The entry `key` of a table, or None."""
        table = self.table()
        if key not in table:
            return None
        return Tree(table[key], f"{self.place}.{key}" if self.place else key, self.file)

    def at(self, key: str) -> Tree:
        """The entry `key` of a table; an error if it is missing."""
        found = self.get(key)
        if found is None:
            raise self.error(f"must have {key!r}")
        return found

    def elements(self) -> list[Tree]:
        """The elements of a list."""
        if not isinstance(self.value, list):
            raise self.error(f"must be a list, got {_short(self.value)}")
        items = cast("list[Any]", self.value)
        return [Tree(item, f"{self.place}[{i}]", self.file) for i, item in enumerate(items)]

    def list_of(self, key: str) -> list[Tree]:
        """The elements of the list `key`; empty if it is missing."""
        found = self.get(key)
        return [] if found is None else found.elements()

    def text(self) -> str:
        """The value as text."""
        if not isinstance(self.value, str):
            raise self.error(f"must be text, got {_short(self.value)}")
        return self.value

    def boolean(self) -> bool:
        """The value as true or false."""
        if not isinstance(self.value, bool):
            raise self.error(f"must be true or false, got {_short(self.value)}")
        return self.value

    def number(self, low: float = -math.inf, high: float = math.inf) -> float:
        """The value as a finite number in [low, high]."""
        if isinstance(self.value, bool) or not isinstance(self.value, int | float):
            raise self.error(f"must be a number, got {_short(self.value)}")
        try:
            number = float(self.value)
        except OverflowError:
            number = math.inf
        if not math.isfinite(number) or not low <= number <= high:
            raise self.error(f"must be a finite number in {low:g}…{high:g}, got {number:g}")
        return number

    def integer(self, low: int, high: int) -> int:
        """The value as a whole number in [low, high]."""
        if isinstance(self.value, bool) or not isinstance(self.value, int):
            raise self.error(f"must be a whole number, got {_short(self.value)}")
        if not low <= self.value <= high:
            raise self.error(f"must be {low}…{high}, got {_short(self.value)}")
        return self.value

    def numbers(self, count: int | None = None) -> tuple[float, ...]:
        """The value as a list of finite numbers (exactly `count`)."""
        found = tuple(item.number() for item in self.elements())
        if count is not None and len(found) != count:
            raise self.error(f"must be {count} numbers, got {len(found)}")
        return found

    def only(self, known: Iterable[str]) -> None:
        """Refuse a table with other keys than the known ones, naming the nearest of them."""
        names = list(known)
        for key in self.table():
            if key not in names:
                near = nearest_name(str(key), names)
                raise self.error(
                    f"has an unknown key {_short(key)}",
                    f"did you mean {near!r}?" if near else f"known are {', '.join(names)}",
                )
