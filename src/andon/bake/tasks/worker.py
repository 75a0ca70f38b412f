"""A local worker: a process that does one task after the other for the bake that started it.

Both talk through its standard input and output: a length of 8 bytes, then what `pickle` made. When
its input ends, the bake is over or killed: the worker goes at once, with all programs it has begun.
"""

from __future__ import annotations

import os
import pickle
import queue
import signal
import struct
import threading
from collections.abc import Mapping
from pathlib import Path
from typing import IO, Any

from andon.bake.tasks.model import Task
from andon.bake.tasks.outcomes import performed

__all__ = ["read_frame", "serve", "write_frame"]

_LENGTH = struct.Struct("<Q")


def write_frame(stream: IO[bytes], value: Any, /) -> None:
    """Sends `value`; raises `OSError` where nobody is there."""
    data = pickle.dumps(value, pickle.HIGHEST_PROTOCOL)
    stream.write(_LENGTH.pack(len(data)))
    stream.write(data)
    stream.flush()


def read_frame(stream: IO[bytes], /) -> Any:
    """The next value that the other side has sent; raises `EOFError` where there is none."""
    (length,) = _LENGTH.unpack(_exactly(stream, _LENGTH.size))
    return pickle.loads(_exactly(stream, length))


def _exactly(stream: IO[bytes], count: int) -> bytes:
    data = stream.read(count)
    if len(data) < count:
        raise EOFError
    return data


def serve(name: str, /) -> None:
    """Does tasks until the input ends. Its own programs get neither of the two streams."""
    given, taken = _private_streams()
    waiting: queue.SimpleQueue[tuple[Task, Mapping[str, Path]]] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(given, waiting), daemon=True).start()
    while True:
        task, folders = waiting.get()
        write_frame(taken, performed(task, folders, name))


def _listen(given: IO[bytes], waiting: queue.SimpleQueue[Any]) -> None:
    """Also while a task is being done, which is how the end is noticed then."""
    try:
        while True:
            waiting.put(read_frame(given))
    except (EOFError, OSError):
        _end()


def _end() -> None:
    if hasattr(os, "killpg") and os.getpgrp() == os.getpid():
        os.killpg(0, signal.SIGKILL)
    os._exit(1)


def _private_streams() -> tuple[IO[bytes], IO[bytes]]:
    """Copies of both that no other program inherits; what is printed goes to standard error."""
    given, taken = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.dup2(2, 1)
    os.close(nothing)
    return given, taken
