"""What a result depends on, as one name: the same inputs give the same name on every machine."""

from __future__ import annotations

import hashlib
import struct
from collections.abc import Iterable, Mapping
from dataclasses import fields, is_dataclass
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

__all__ = ["digest"]


def digest(*values: Any, single: bool = False) -> str:
    """64 hexadecimal digits (SHA-256) of values: numbers, texts, arrays, dataclasses, and lists,
    tuples, mappings and sets of them.

    Types and shapes count as well as contents. With `single` numbers count as float32 has them:
    other machines may compute the last digits of float64 differently. Raises `TypeError` for
    anything else, since what has no contents has no name.
    """
    state = _Sum(single)
    for value in values:
        _add(state, value)
    return state.hash.hexdigest()


class _Sum:
    """A sum in the making, and whether its floats are shortened."""

    def __init__(self, single: bool) -> None:
        self.hash, self.single = hashlib.sha256(), single

    def update(self, data: bytes) -> None:
        self.hash.update(data)


def _add(state: _Sum, value: Any) -> None:
    if is_dataclass(value) and not isinstance(value, type):
        _many(state, type(value).__name__, [getattr(value, f.name) for f in fields(value)])
    elif isinstance(value, np.ndarray):
        array = cast("NDArray[Any]", value)
        if state.single and array.dtype == np.float64:
            array = array.astype(np.float32)
        _text(state, f"array {array.dtype.str} {array.shape}")
        state.update(np.ascontiguousarray(array).tobytes())
    elif isinstance(value, str):
        _text(state, f"text {value}")
    elif value is None or isinstance(value, bool | np.bool_):
        _text(state, f"{value}")
    elif isinstance(value, int):
        _text(state, f"int {value}")
    elif isinstance(value, float):  # float64 as well
        state.update(b"float" + struct.pack("<d", np.float32(value) if state.single else value))
    elif isinstance(value, np.generic):
        _add(state, value.item())
    elif isinstance(value, tuple | list):
        _many(state, "list", cast("Iterable[Any]", value))
    elif isinstance(value, frozenset | set):
        _many(
            state,
            "set",
            sorted(digest(each, single=state.single) for each in cast("Iterable[Any]", value)),
        )
    elif isinstance(value, Mapping):
        table = cast("Mapping[str, Any]", value)
        _many(state, "table", [(str(key), table[key]) for key in sorted(table, key=str)])
    else:
        raise TypeError(f"no digest of {type(value).__name__}")


def _many(state: _Sum, kind: str, values: Iterable[Any]) -> None:
    listed = list(values)
    _text(state, f"{kind} {len(listed)}")
    for each in listed:
        _add(state, each)


def _text(state: _Sum, text: str) -> None:
    data = text.encode()
    state.update(struct.pack("<q", len(data)) + data)
