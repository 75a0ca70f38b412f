"""What became of an attempt at a task, wherever it was made."""

from __future__ import annotations

import builtins
import importlib
import traceback
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any, Literal, NoReturn

from andon.bake.tasks.model import Task
from andon.errors import InputError, MachineError

__all__ = ["ATTEMPTS", "OURS", "Fault", "Outcome", "named", "performed"]

# A task is tried this many times before it is reported.
ATTEMPTS = 3
# Faults of this program, which no second try mends.
OURS = (TypeError, AttributeError, NameError, LookupError, AssertionError, NotImplementedError)
# Failed tasks that a message names.
SHOWN = 3


@dataclass(frozen=True)
class Fault:
    """Why an attempt failed; made to travel between processes, as exceptions are not.

    Attributes
    ----------
    kind : whose fault: ``input`` and ``ours`` stop a bake at once, ``machine`` is tried again.
    words : what is said of it.
    details : ``input``: rule, file, field, remedy; ``ours``: the exception's name and text, its
        traceback.
    """

    kind: Literal["input", "ours", "machine"]
    words: str
    details: tuple[str | None, ...] = ()

    def stop(self) -> NoReturn:
        """Raises what an ``input`` or ``ours`` was; an exception of ours has where it was."""
        if self.kind == "input":
            rule, file, field, remedy = self.details
            raise InputError(rule or "", file=file, field=field, remedy=remedy)
        name, text, where = self.details
        error = getattr(builtins, name or "")(text)
        error.add_note(f"in a worker: {where}")
        raise error


@dataclass(frozen=True)
class Outcome:
    """One attempt.

    Attributes
    ----------
    key : of the task.
    data : the artefact's contents, or why there are none.
    seconds : that the work took.
    worker : who did it.
    spent : attempts that it counts as.
    """

    key: str
    data: bytes | Fault
    seconds: float = 0.0
    worker: str = ""
    spent: int = 1


def named(failed: Sequence[tuple[str, str]], /) -> str:
    """The first of failed tasks, (name, reason) each, as a message lists them."""
    words = [f"{name} ({reason})" for name, reason in failed[:SHOWN]]
    return ", ".join(words) + (", …" if len(failed) > SHOWN else "")


def performed(task: Task, folders: Mapping[str, Path], worker: str, /) -> Outcome:
    """Does a task here; `folders` are its inputs, name → folder. Raises nothing of what fails."""
    start = perf_counter()
    try:
        data = _work(task.work)(folders, task.settings)
        if not isinstance(data, bytes):
            raise TypeError(f"{task.work} must give bytes, got {type(data).__name__}")
    except Exception as error:
        data = _fault(error)
    return Outcome(task.key, data, perf_counter() - start, worker)


def _work(name: str) -> Callable[..., Any]:
    module, _, function = name.partition(":")
    return getattr(importlib.import_module(module), function)


def _fault(error: Exception) -> Fault:
    if isinstance(error, InputError):
        details = (error.rule, error.file, error.field, error.remedy)
        return Fault("input", str(error), details)
    if isinstance(error, MachineError):
        return Fault("machine", str(error))
    if isinstance(error, OURS):
        known = next(each for each in type(error).__mro__ if hasattr(builtins, each.__name__))
        where = "".join(traceback.format_exception(error))
        return Fault("ours", f"{known.__name__}: {error}", (known.__name__, str(error), where))
    return Fault("machine", f"{type(error).__name__}: {error}")
