"""Results of tasks that are done already: one file each, named by what it depends on.

::

    <key>.exr       an artefact: what the task gave, byte for byte
    journal.jsonl   what happened, one event a line
    plan.json       the tasks of the bake that ran last: for people, and for `tasks_status`

How a kill is survived
    An artefact's sum goes into the journal first, then the artefact is written under another name
    and renamed. A file counts as done only if its contents have the sum that the journal gives. So
    a kill before the rename leaves an event without a file, which is done again, and one after it a
    file that is done; there is nothing in between.
What is the result
    The artefacts and plan.json: the same bytes however often a bake was killed. The journal's times
    and workers are those of what happened. It must be kept with the artefacts: without it none
    counts as done, since nobody says what they should contain.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Collection, Generator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from andon.bake.tasks.events import Events
from andon.bake.tasks.inputs import remove_inputs
from andon.bake.tasks.lock import locked
from andon.errors import MachineError
from andon.files.atomic import write_bytes

__all__ = ["JOURNAL", "PLAN", "Store"]

JOURNAL, PLAN = "journal.jsonl", "plan.json"
_CHUNK = 1 << 20


class Store:
    """A folder of artefacts.

    Parameters
    ----------
    folder : is made by `locked`.
    suffix : of artefacts, with its dot.
    beside : names of files that its owner writes into the folder as well: what a killed bake has
        left half-written of them goes, too.

    Attributes
    ----------
    found, damaged : artefacts that `get` found whole, and that were there and were not.
    """

    def __init__(self, folder: Path, suffix: str = ".exr", *, beside: Collection[str] = ()) -> None:
        self.folder, self.suffix, self._beside = Path(folder), suffix, tuple(beside)
        self.found = self.damaged = 0
        self._events = Events(self.folder / JOURNAL)
        self._sums: dict[str, str] = {}
        self._depth = 0

    def get(self, key: str, /) -> Path | None:
        """The artefact named `key`, or None where there is none that is whole.

        Reads it once through. Raises `MachineError` where it cannot be read.
        """
        path = self.path(key)
        total = _sum_of(path)
        if total is None:
            return None
        self._learn()
        if self._sums.get(key) != total:
            self.damaged += 1
            return None
        self.found += 1
        return path

    def put(
        self, key: str, data: bytes, /, *, seconds: float = 0.0, worker: str = "", attempt: int = 1
    ) -> Path:
        """Keeps an artefact. Raises `MachineError` where it cannot be written."""
        self._make()
        total = hashlib.sha256(data).hexdigest()
        facts = {"sha256": total, "bytes": len(data), "seconds": round(seconds, 6)}
        self.note("done", key=key, **facts, worker=worker, attempt=attempt)
        try:
            return write_bytes(self.path(key), data)
        except MachineError as error:
            raise MachineError(
                error.what,
                remedy="free space or choose a folder that can be written, and begin again: what "
                f"is done is kept in {self.folder}",
            ) from error

    def note(self, event: str, /, **facts: Any) -> None:
        """Writes an event into the journal, with its time (UTC)."""
        time = datetime.now(UTC).isoformat(timespec="milliseconds")
        self._events.add({"event": event, **facts, "time": time})

    def path(self, key: str, /) -> Path:
        """Where the artefact named `key` is, or would be."""
        return self.folder / f"{key}{self.suffix}"

    @contextmanager
    def locked(self) -> Generator[None]:
        """Holds the folder, which is made: one process at a time writes into it.

        May be nested. What a killed one has left half-written goes, and its inputs. Raises
        `MachineError` where another process holds the folder, and where it cannot be written.
        """
        if self._depth:
            yield
            return
        with locked(self.folder, of=f"{self.folder}"):
            self._depth += 1
            try:
                self._remove_unfinished()
                remove_inputs(self.folder)
                yield
            finally:
                self._depth -= 1

    def remove_others(self, keys: Collection[str], /) -> int:
        """Removes artefacts whose key is not among `keys`; how many.

        Files that are no artefacts of this store stay.
        """
        pattern = re.compile(r"([0-9a-f]{64})" + re.escape(self.suffix))
        found = ((path, pattern.fullmatch(path.name)) for path in self._files())
        others = [path for path, match in found if match and match[1] not in keys]
        for path in others:
            path.unlink(missing_ok=True)
        return len(others)

    def clear(self) -> None:
        """Throws everything of this store away: artefacts, the journal, the plan."""
        self.remove_others(())
        for name in (JOURNAL, PLAN):
            (self.folder / name).unlink(missing_ok=True)
        self._sums.clear()

    def _remove_unfinished(self) -> None:
        """What `write_atomically` had not renamed when its process was killed."""
        stems = "|".join(re.escape(Path(name).stem) for name in (PLAN, *self._beside))
        pattern = re.compile(rf"\.([0-9a-f]{{64}}|{stems})\.[0-9a-f]{{12}}\.tmp(\..+)?")
        for path in self._files():
            if pattern.fullmatch(path.name):
                path.unlink(missing_ok=True)

    def _files(self) -> list[Path]:
        return list(self.folder.iterdir()) if self.folder.is_dir() else []

    def _learn(self) -> None:
        for event in self._events.news():
            if event.get("event") == "done":
                self._sums[str(event.get("key"))] = str(event.get("sha256"))

    def _make(self) -> None:
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise MachineError(
                f"{self.folder}: cannot be made: {error.strerror or error}",
                remedy="choose a folder that can be written, or remove the file of that name",
            ) from error


def _sum_of(path: Path) -> str | None:
    """SHA-256 of a file in hexadecimal digits; None where there is none."""
    total = hashlib.sha256()
    try:
        with path.open("rb") as stream:
            while chunk := stream.read(_CHUNK):
                total.update(chunk)
    except FileNotFoundError:
        return None
    except OSError as error:
        raise MachineError(
            f"{path}: cannot be read: {error.strerror or error}",
            remedy="let it be read, or bake afresh",
        ) from error
    return total.hexdigest()
