"""Files that a frame would read again: read once, and again when they change."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any, TypeVar

__all__ = ["file_stamp", "read_cached"]

T = TypeVar("T")

# Files kept in memory, of all readers.
KEPT = 128


def file_stamp(path: Path, /) -> tuple[int, int] | None:
    """What changes when a file does: its time in ns and its size in bytes; None: there is none."""
    try:
        status = path.stat()
    except OSError:
        return None
    return status.st_mtime_ns, status.st_size


def read_cached(reader: Callable[[Path], T], path: Path, /) -> T:
    """``reader(path)``, or what it gave before if the file did not change; not to be written to.

    Name one and the same function each time: another one reads anew. Errors are not kept.
    """
    stamp = file_stamp(path)
    # Of a missing file the reader says what is wrong.
    return reader(path) if stamp is None else _read(reader, path, stamp)


@lru_cache(maxsize=KEPT)
def _read(reader: Callable[[Path], Any], path: Path, _stamp: tuple[int, int], /) -> Any:
    return reader(path)
