"""One bake of a volume at a time: a file beside its results that the running one holds.

The operating system lets go of it when the process ends, however it ends: what a killed bake has
left holds nobody up. The number in it is for messages alone.
"""

from __future__ import annotations

import os
from collections.abc import Generator
from contextlib import contextmanager, suppress
from pathlib import Path

from andon.errors import MachineError

__all__ = ["locked"]

NAME = "lock"


@contextmanager
def locked(folder: Path, /) -> Generator[None]:
    """Holds `folder`, which is made; afterwards it goes unless something is left in it.

    Raises `MachineError` where another process holds it, and where it cannot be written.
    """
    handle = _taken(folder)
    try:
        yield
    finally:
        # First the name, then the lock: whoever waits for the name finds none or a free one.
        with suppress(OSError):
            (folder / NAME).unlink()
        os.close(handle)
        with suppress(OSError):  # results of a bake that was stopped, or somebody's files
            folder.rmdir()


def _taken(folder: Path) -> int:
    path = folder / NAME
    while True:
        try:
            folder.mkdir(parents=True, exist_ok=True)
            handle = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
        except FileNotFoundError:  # the one before has just removed the folder
            continue
        except OSError as error:
            raise MachineError(
                f"{folder}: cannot be made: {error.strerror or error}",
                remedy="choose a folder that can be written, or remove the file of that name",
            ) from error
        if not _lock(handle):
            owner = os.read(handle, 20).decode("ascii", "replace").strip()
            os.close(handle)
            raise MachineError(
                f"another bake of this volume is running (pid {owner or 'unknown'})",
                remedy="wait for it, or name another probes.volume",
            )
        if _is_named(handle, path):
            os.ftruncate(handle, 0)
            os.write(handle, str(os.getpid()).encode())
            return handle
        os.close(handle)  # the one before has removed it in between


def _is_named(handle: int, path: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(handle), path.stat())
    except FileNotFoundError:
        return False


def _lock(handle: int) -> bool:
    """Whether the file is ours now; without file locks of POSIX it always is."""
    try:
        import fcntl
    except ImportError:
        return True
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True
