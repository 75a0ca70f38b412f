"""Results of a bake that are done already: one file each, named by what it depends on.

::

    32 bytes SHA-256 of the rest │ arrays, one after the other, as .npy in the order of their names

A file that is cut off or damaged does not match its sum and counts as not there.
"""

from __future__ import annotations

import hashlib
import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import MachineError
from andon.files.atomic import write_bytes

__all__ = ["Journal", "Result"]

Result = Mapping[str, NDArray[Any]]

SUFFIX = ".probe"
_SUM_BYTES = 32
# A probe's result is a few kilobytes; nothing larger is one of ours.
MAX_BYTES = 1 << 26


class Journal:
    """A folder of results; None: nothing is kept.

    Attributes
    ----------
    found, damaged : results that were there, and files that were not whole.
    """

    def __init__(self, folder: Path | None) -> None:
        self.folder = folder
        self.found = self.damaged = 0

    def get(self, key: str, /) -> dict[str, NDArray[Any]] | None:
        """The result named `key`, or None where there is none that is whole."""
        if self.folder is None:
            return None
        path = self._path(key)
        try:
            if path.stat().st_size > MAX_BYTES:
                return self._refused()
            data = path.read_bytes()
        except FileNotFoundError:
            return None
        except OSError as error:
            raise MachineError(
                f"{path}: cannot be read: {error.strerror or error}",
                remedy="let it be read, or bake afresh",
            ) from error
        result = _unpacked(data)
        if result is None:
            return self._refused()
        self.found += 1
        return result

    def has(self, key: str, /) -> bool:
        """Whether there is a file named `key`; `get` says whether it is whole."""
        return self.folder is not None and self._path(key).exists()

    def _refused(self) -> None:
        self.damaged += 1

    def put(self, key: str, result: Result, /) -> None:
        """Keeps a result. Raises `MachineError` where it cannot be written."""
        if self.folder is None:
            return
        self._make()
        write_bytes(self._path(key), _packed(result))

    def clear(self) -> None:
        """Throws all results away; what somebody else removes meanwhile is gone as well."""
        if self.folder is None:
            return
        for path in self.folder.glob(f"*{SUFFIX}"):
            path.unlink(missing_ok=True)

    def _make(self) -> None:
        assert self.folder is not None
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise MachineError(
                f"{self.folder}: cannot be made: {error.strerror or error}",
                remedy="choose a folder that can be written, or remove the file of that name",
            ) from error

    def _path(self, key: str) -> Path:
        assert self.folder is not None
        return self.folder / f"{key}{SUFFIX}"


def _packed(result: Result) -> bytes:
    stream = io.BytesIO()
    for name in sorted(result):
        title = np.frombuffer(name.encode(), np.uint8)
        np.lib.format.write_array(stream, title, allow_pickle=False)
        np.lib.format.write_array(stream, np.asarray(result[name]), allow_pickle=False)
    body = stream.getvalue()
    return hashlib.sha256(body).digest() + body


def _unpacked(data: bytes) -> dict[str, NDArray[Any]] | None:
    body = data[_SUM_BYTES:]
    if hashlib.sha256(body).digest() != data[:_SUM_BYTES]:
        return None
    stream, result = io.BytesIO(body), dict[str, NDArray[Any]]()
    while stream.tell() < len(body):
        title = np.lib.format.read_array(stream, allow_pickle=False)
        values = np.lib.format.read_array(stream, allow_pickle=False)
        result[title.tobytes().decode()] = values
    return result
