"""What happened to tasks, one line of JSON each, in a file that only grows.

A process that is killed while it writes leaves a cut last line. Whoever reads passes over lines
that are no event, and whoever writes begins a new one after it: nothing but that one event is lost.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, cast

from andon.errors import MachineError

__all__ = ["Event", "Events"]

Event = Mapping[str, Any]

# Events have a few hundred bytes; what is longer is none of ours.
MAX_LINE_BYTES = 1 << 16


class Events:
    """The file `path`; there is none before the first event."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._read = 0

    def news(self) -> Iterator[Event]:
        """The events since the last call, all of them at the first; none where there is no file.

        A last line that is not ended yet is left for later. Raises `MachineError` where the file
        cannot be read.
        """
        try:
            with self.path.open("rb") as stream:
                if os.fstat(stream.fileno()).st_size < self._read:  # somebody began it afresh
                    self._read = 0
                stream.seek(self._read)
                while line := stream.readline(MAX_LINE_BYTES):
                    if not line.endswith(b"\n") and len(line) < MAX_LINE_BYTES:
                        return
                    self._read += len(line)
                    if (event := _event(line)) is not None:
                        yield event
        except FileNotFoundError:
            self._read = 0
        except OSError as error:
            raise MachineError(
                f"{self.path}: cannot be read: {error.strerror or error}",
                remedy="let it be read, or bake afresh",
            ) from error

    def add(self, event: Event, /) -> None:
        """Writes an event; it is on the disk when this returns.

        Raises `MachineError` where it cannot be written.
        """
        line = json.dumps(event, ensure_ascii=False).encode("utf-8", "replace") + b"\n"
        try:
            handle = os.open(self.path, os.O_RDWR | os.O_CREAT | os.O_APPEND, 0o644)
            try:
                _write(handle, line)
                os.fsync(handle)
            finally:
                os.close(handle)
        except OSError as error:
            raise MachineError(
                f"{self.path}: cannot be written: {error.strerror or error}",
                remedy="free space or choose a folder that can be written, and begin again: what "
                "is done is kept",
            ) from error


def _write(handle: int, line: bytes) -> None:
    size = os.fstat(handle).st_size
    if size:
        os.lseek(handle, size - 1, os.SEEK_SET)
        if os.read(handle, 1) != b"\n":  # cut off by a kill or a full disk
            line = b"\n" + line
    while line:
        line = line[os.write(handle, line) :]


def _event(line: bytes) -> Event | None:
    try:
        value: Any = json.loads(line)
    except (ValueError, RecursionError):
        return None
    return cast("Event", value) if isinstance(value, dict) else None
