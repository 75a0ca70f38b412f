"""One bake of a thing at a time: a file beside its results that the running one holds.

The operating system lets go of it when the process ends, however it ends: what a killed bake has
left holds nobody up. The number in it is for messages alone.
"""

from __future__ import annotations

import os
from collections.abc import Generator
from contextlib import contextmanager, suppress
from pathlib import Path
from time import sleep

from andon.errors import MachineError

__all__ = ["NAME", "holder", "locked"]

NAME = "lock"
# Whoever asks who holds a lock holds it for an instant: a bake that begins just then tries again.
TRIES, PAUSE_SECONDS = 5, 0.02


@contextmanager
def locked(
    folder: Path, /, *, of: str = "this folder", remedy: str = "wait for it"
) -> Generator[None]:
    """Holds `folder`, which is made; afterwards it goes unless something is left in it.

    Raises `MachineError` where another process holds it (``another bake of {of} is running``, with
    `remedy`), and where it cannot be written.
    """
    handle = _taken(folder, of, remedy)
    try:
        yield
    finally:
        # First the name, then the lock: whoever waits for the name finds none or a free one.
        with suppress(OSError):
            (folder / NAME).unlink()
        os.close(handle)
        with suppress(OSError):  # results of a bake that was stopped, or somebody's files
            folder.rmdir()


def holder(folder: Path, /) -> int | None:
    """The process that holds `folder`, 0 if its number is unknown; None: nobody does.

    Without file locks of POSIX nobody ever does.
    """
    try:
        handle = os.open(folder / NAME, os.O_RDONLY)
    except OSError:
        return None
    try:
        if _lock(handle, shared=True):
            return None
        return int("0" + os.read(handle, 20).decode("ascii", "replace").strip())
    except ValueError:
        return 0
    finally:
        os.close(handle)


def _taken(folder: Path, of: str, remedy: str) -> int:
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
        if not any(_lock(handle) or sleep(PAUSE_SECONDS) for _ in range(TRIES)):
            owner = os.read(handle, 20).decode("ascii", "replace").strip()
            os.close(handle)
            raise MachineError(
                f"another bake of {of} is running (pid {owner or 'unknown'})",
                remedy=remedy,
            )
        if _is_named(handle, path):
            with suppress(OSError):  # a full disk: what is to be written next says so
                os.ftruncate(handle, 0)
                os.write(handle, str(os.getpid()).encode())
            return handle
        os.close(handle)  # the one before has removed it in between


def _is_named(handle: int, path: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(handle), path.stat())
    except FileNotFoundError:
        return False


def _lock(handle: int, *, shared: bool = False) -> bool:
    """Whether the file is ours now; without file locks of POSIX it always is."""
    try:
        import fcntl
    except ImportError:
        return True
    try:
        fcntl.flock(handle, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True
