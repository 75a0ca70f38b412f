"""How far a bake is, from its folder alone: it may run, have been killed, or be done."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Any

from andon.bake.tasks.events import Event, Events
from andon.bake.tasks.lock import holder
from andon.bake.tasks.plan import read_plan
from andon.bake.tasks.store import JOURNAL

__all__ = ["FailedTask", "TasksStatus", "tasks_status"]


@dataclass(frozen=True)
class FailedTask:
    """A task that was given up by the bake that ran last, and why."""

    name: str
    reason: str


@dataclass(frozen=True)
class TasksStatus:
    """What is to be said of a folder of tasks.

    Attributes
    ----------
    planned, done : tasks of the bake that ran last, and those of them with an artefact.
    failed : those given up.
    running : a bake holds the folder now; `pid` is its process, 0 if that is not known.
    bytes : of the artefacts that are done.
    seconds : of all work on them, on whatever machine.
    seconds_left : guessed for a bake that runs; else None.
    begun, last : when the bake that ran last began, and the last event; None: never.
    last_done : name of the task that was finished last, of those that are done; empty: none is.
    """

    folder: Path
    planned: int
    done: int
    failed: tuple[FailedTask, ...]
    running: bool
    pid: int
    bytes: int
    seconds: float
    seconds_left: float | None
    begun: datetime | None
    last: datetime | None
    last_done: str = ""


def tasks_status(folder: Path, /) -> TasksStatus | None:
    """The status of a store's folder; None where no bake has begun.

    An artefact counts as done here if it has as many bytes as the journal says; the next bake looks
    at its contents as well. Raises `InputError` for a plan that is none, `MachineError` for what
    cannot be read.
    """
    plan = read_plan(folder)
    if plan is None:
        return None
    suffix, names = plan
    history = _History()
    for event in Events(folder / JOURNAL).news():
        history.add(event)
    done = {
        key: event
        for key, event in history.done.items()
        if key in names and _size(folder / f"{key}{suffix}") == event.get("bytes")
    }
    failed = {key: why for key, why in history.given_up.items() if key in names and key not in done}
    pid = holder(folder)
    mean = sum(map(_seconds, done.values())) / len(done) if done else None
    left = len(names) - len(done) - len(failed)
    return TasksStatus(
        folder,
        len(names),
        len(done),
        tuple(FailedTask(names[key], why) for key, why in failed.items()),
        pid is not None,
        pid or 0,
        sum(_size(folder / f"{key}{suffix}") or 0 for key in done),
        sum(map(_seconds, done.values())),
        None if pid is None or mean is None else mean * max(left / history.workers, left > 0),
        history.begun,
        history.last,
        next((names[key] for key in reversed(history.done) if key in done), ""),
    )


class _History:
    """What the events say; of several of one task the last."""

    def __init__(self) -> None:
        self.done: dict[str, Event] = {}
        self.given_up: dict[str, str] = {}
        self.workers = 1
        self.begun: datetime | None = None
        self.last: datetime | None = None

    def add(self, event: Event) -> None:
        kind, key = event.get("event"), str(event.get("key"))
        self.last = _time(event) or self.last
        if kind == "begun":
            self.begun = _time(event)
            self.given_up.clear()
            self.workers = max(_whole(event.get("workers")), 1)
        elif kind == "done":
            self.done.pop(key, None)
            self.done[key] = event  # the last in their order
        elif kind == "given up":
            self.given_up[key] = str(event.get("reason"))


def _time(event: Event) -> datetime | None:
    try:
        return datetime.fromisoformat(str(event.get("time")))
    except ValueError:
        return None


def _seconds(event: Event) -> float:
    value: Any = event.get("seconds")
    return float(value) if isinstance(value, int | float) else 0.0


def _whole(value: Any) -> int:
    return value if isinstance(value, int) else 0


def _size(path: Path) -> int | None:
    try:
        return path.stat().st_size
    except OSError:
        return None
