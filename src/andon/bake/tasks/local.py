"""Workers on this machine: separate processes, so that one that dies takes nothing with it.

Each is a fresh Python in a group of processes of its own, and not a fork or a child of
`multiprocessing`: those would run the user's main script again, and would get the Ctrl-C that is
meant for the bake. A worker that dies costs one attempt of its task, and the next task starts a new
one. Their libraries compute with one thread each: the parallelism is over tasks, and sums do not
depend on how many cores there are.
"""

from __future__ import annotations

import os
import queue
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Generator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, Any

from andon.bake.tasks.inputs import Inputs, inputs_in
from andon.bake.tasks.model import Bundle, Task
from andon.bake.tasks.outcomes import Fault, Outcome
from andon.bake.tasks.worker import read_frame, write_frame
from andon.errors import MachineError

__all__ = ["LocalWorkers"]

_ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
_SERVE = "import sys; from andon.bake.tasks.worker import serve; serve(sys.argv[1])"
# How much a message quotes of what a dead worker said last.
_TAIL_BYTES = 300
# Waits are cut into pieces so that Ctrl-C gets through on every system.
_PAUSE_SECONDS = 0.5


class LocalWorkers:
    """As many processes as `count`, by default as there are cores for this one."""

    def __init__(self, count: int | None = None) -> None:
        if count is not None and count < 1:
            raise ValueError(f"count must be ≥ 1, got {count}")
        self.count = count or _cores()

    @contextmanager
    def started(self, bundles: Mapping[str, Bundle], folder: Path, /) -> Generator[_LocalPool]:
        """Workers whose inputs are in ``folder/inputs`` meanwhile; see `Workers`."""
        with inputs_in(folder, bundles) as inputs:
            pool = _LocalPool(self.count, inputs)
            try:
                yield pool
            finally:
                pool.close()


def _cores() -> int:
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


class _LocalPool:
    """See `Pool`."""

    def __init__(self, count: int, inputs: Inputs) -> None:
        self.count, self._inputs = count, inputs
        self._heard: queue.SimpleQueue[tuple[_Worker, Outcome | None]] = queue.SimpleQueue()
        self._idle: list[_Worker] = []
        self._busy: dict[_Worker, Task] = {}
        self._started = 0

    @property
    def free(self) -> int:
        return self.count - len(self._busy)

    def start(self, task: Task, /) -> None:
        folders = self._inputs.of(task)  # first: a full disk should lose no worker
        worker = self._idle.pop() if self._idle else self._new()
        self._busy[worker] = task
        worker.give(task, folders)

    def drop(self, digest: str, /) -> None:
        self._inputs.drop(digest)

    def next(self) -> Outcome:
        while True:
            try:
                worker, outcome = self._heard.get(timeout=_PAUSE_SECONDS)
            except queue.Empty:
                continue
            task = self._busy.pop(worker, None)
            if outcome is not None:
                self._idle.append(worker)
                return outcome
            reason = worker.end()
            if task is not None:
                return Outcome(task.key, Fault("machine", reason), worker=worker.name)
            self._idle.remove(worker)  # died between two tasks

    def close(self) -> None:
        """Kills all workers."""
        for worker in (*self._idle, *self._busy):
            worker.end()

    def _new(self) -> _Worker:
        self._started += 1
        return _Worker(f"local {self._started}", self._heard)


class _Worker:
    """One process, and a thread that listens to it."""

    def __init__(self, name: str, heard: queue.SimpleQueue[Any]) -> None:
        self.name, self._heard = name, heard
        self._said: IO[bytes] = tempfile.TemporaryFile()  # noqa: SIM115 (closed by `end`)
        self._process = self._spawned()
        threading.Thread(target=self._listen, daemon=True).start()

    def _spawned(self) -> subprocess.Popen[bytes]:
        places = os.pathsep.join(path or str(Path.cwd()) for path in sys.path)
        environment = os.environ | dict.fromkeys(_ONE_THREAD, "1") | {"PYTHONPATH": places}
        try:
            return subprocess.Popen(
                [sys.executable, "-P", "-c", _SERVE, self.name],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self._said,
                env=environment,
                start_new_session=True,
            )
        except OSError as error:
            raise MachineError(
                f"no worker can be started: {error.strerror or error}",
                remedy="use fewer workers, and begin again: what is done is kept",
            ) from error

    def give(self, task: Task, folders: Mapping[str, Path]) -> None:
        """Sends a task; whether it has died is heard from the other side."""
        assert self._process.stdin is not None
        with suppress(OSError):
            write_frame(self._process.stdin, (task, folders))

    def _listen(self) -> None:
        assert self._process.stdout is not None
        try:
            while True:
                self._heard.put((self, read_frame(self._process.stdout)))
        except Exception:  # its end, in the middle of a frame as well
            self._heard.put((self, None))

    def end(self) -> str:
        """Kills it with all programs it has begun; how it had ended if it was dead already."""
        process = self._process
        if hasattr(os, "killpg") and process.returncode is None:
            with suppress(OSError):
                os.killpg(process.pid, signal.SIGKILL)
        process.kill()
        code = process.wait()
        with suppress(OSError):
            assert process.stdin is not None
            process.stdin.close()
        said = self._last_words()
        self._said.close()
        return f"its worker died: {_how(code)}{said}"

    def _last_words(self) -> str:
        self._said.seek(max(self._said.seek(0, os.SEEK_END) - _TAIL_BYTES, 0))
        lines = self._said.read().decode("utf-8", "replace").strip().splitlines()
        return f", and said {lines[-1]!r}" if lines else ""


def _how(code: int) -> str:
    if code >= 0:
        return f"exit code {code}"
    try:
        name = signal.Signals(-code).name
    except ValueError:
        name = f"signal {-code}"
    return f"killed by {name}" + (" (out of memory?)" if name == "SIGKILL" else "")
