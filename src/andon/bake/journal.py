"""Results of a bake of probes that are done already: a `Store` of arrays.

A result's file holds its arrays one after the other as .npy, each after its name, in the order of
names. It lasts no longer than the bake, which throws all of them away once the volume is written.
"""

from __future__ import annotations

import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.bake.tasks.store import Store
from andon.errors import MachineError

__all__ = ["Journal", "Result"]

Result = Mapping[str, NDArray[Any]]

SUFFIX = ".probe"


class Journal:
    """A folder of results; None: nothing is kept."""

    def __init__(self, folder: Path | None) -> None:
        self.folder = folder
        self._store = None if folder is None else Store(folder, SUFFIX)

    @property
    def found(self) -> int:
        """Results that were there."""
        return 0 if self._store is None else self._store.found

    @property
    def damaged(self) -> int:
        """Files that were there and not whole."""
        return 0 if self._store is None else self._store.damaged

    def get(self, key: str, /) -> dict[str, NDArray[Any]] | None:
        """The result named `key`, or None where there is none that is whole."""
        path = None if self._store is None else self._store.get(key)
        return None if path is None else _unpacked(_bytes_of(path))

    def has(self, key: str, /) -> bool:
        """Whether there is a file named `key`; `get` says whether it is whole."""
        return self._store is not None and self._store.path(key).exists()

    def put(self, key: str, result: Result, /) -> None:
        """Keeps a result. Raises `MachineError` where it cannot be written."""
        if self._store is not None:
            self._store.put(key, _packed(result))

    def clear(self) -> None:
        """Throws all results away; what somebody else removes meanwhile is gone as well."""
        if self._store is None:
            return
        for path in self._store.folder.glob(f"*{SUFFIX}"):
            path.unlink(missing_ok=True)
        self._store.clear()


def _bytes_of(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise MachineError(
            f"{path}: cannot be read: {error.strerror or error}",
            remedy="let it be read, or bake afresh",
        ) from error


def _packed(result: Result) -> bytes:
    stream = io.BytesIO()
    for name in sorted(result):
        title = np.frombuffer(name.encode(), np.uint8)
        np.lib.format.write_array(stream, title, allow_pickle=False)
        np.lib.format.write_array(stream, np.asarray(result[name]), allow_pickle=False)
    return stream.getvalue()


def _unpacked(data: bytes) -> dict[str, NDArray[Any]]:
    stream, result = io.BytesIO(data), dict[str, NDArray[Any]]()
    while stream.tell() < len(data):
        title = np.lib.format.read_array(stream, allow_pickle=False)
        values = np.lib.format.read_array(stream, allow_pickle=False)
        result[title.tobytes().decode()] = values
    return result
