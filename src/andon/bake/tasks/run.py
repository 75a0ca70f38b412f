"""Does tasks: what is done is not done again, what fails is tried again, and the rest goes on."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import NoReturn

from andon.bake.tasks.model import Bundle, Task
from andon.bake.tasks.outcomes import ATTEMPTS, Fault, Outcome, named
from andon.bake.tasks.plan import write_plan
from andon.bake.tasks.store import Store
from andon.bake.tasks.workers import Pool, Workers
from andon.errors import MachineError

__all__ = ["TasksProgress", "TasksReport", "run_tasks"]


@dataclass(frozen=True)
class TasksProgress:
    """How far a bake is.

    Attributes
    ----------
    done, of : tasks that are finished, those given up included, and all.
    kept : of `done`, those that an earlier bake had finished.
    name : of the task that has just ended; empty before the first.
    seconds_left : guessed from the mean of what was done now; None before the first.
    """

    done: int
    of: int
    kept: int
    name: str
    seconds_left: float | None


@dataclass(frozen=True)
class TasksReport:
    """What a bake did.

    Attributes
    ----------
    planned : different tasks.
    computed, kept : those done now, and those that an earlier bake had done.
    damaged : artefacts that were not whole, and were made again.
    retried : attempts that failed.
    seconds, elapsed : of all work together, and by the clock.
    workers : how many at the same time; 0: there was nothing to do.
    """

    planned: int
    computed: int
    kept: int
    damaged: int
    retried: int
    seconds: float
    elapsed: float
    workers: int


def run_tasks(
    tasks: Sequence[Task],
    bundles: Mapping[str, Bundle],
    store: Store,
    /,
    *,
    workers: Workers,
    progress: Callable[[TasksProgress], None] | None = None,
    attempts: int = ATTEMPTS,
) -> TasksReport:
    """Sees to it that `store` has the artefacts of all `tasks`.

    Parameters
    ----------
    tasks : those of the same key are done once; what the store has whole is not done. They begin
        in this order: a bundle is kept from the first that reads it to the last, so those that
        read the same one should follow each other.
    bundles : digest → files, at least those that tasks name as inputs. What is made when its files
        are asked for is not asked before a task needs it.
    store : is held until all is done; what is in it and not asked for stays.
    workers : who does them; not started where there is nothing to do.
    progress : called at the beginning and after each task that has ended.
    attempts : how often a task is tried.

    Raises
    ------
    MachineError
        after all others are done for tasks that failed `attempts` times; at once where another
        process uses the store, nothing can be written, or no worker is left.
    InputError
        as a task raises it, at once: trying again would not make a file better. So are exceptions
        that are our own faults.
    """
    planned = {task.key: task for task in tasks}
    for task in planned.values():
        for name, wanted in task.inputs.items():
            if wanted not in bundles:
                raise LookupError(f"{task.name}: no bundle {wanted} for input {name!r}")
    start = perf_counter()
    with store.locked():
        write_plan(store.folder, store.suffix, planned)
        damaged = store.damaged
        missing = {key: task for key, task in planned.items() if store.get(key) is None}
        run = _Run(store, planned, missing, progress, attempts)
        run.damaged = store.damaged - damaged
        run.tell("")
        if missing:
            with workers.started(bundles, store.folder) as pool:
                run.do(pool)
    return run.report(perf_counter() - start)


def _read_by(task: Task) -> set[str]:
    """Bundles, each once."""
    return set(task.inputs.values())


class _Run:
    """Tasks that are being done."""

    def __init__(
        self,
        store: Store,
        planned: Mapping[str, Task],
        missing: Mapping[str, Task],
        progress: Callable[[TasksProgress], None] | None,
        attempts: int,
    ) -> None:
        self.store, self.planned, self.missing = store, planned, missing
        self.progress, self.attempts = progress, attempts
        self.kept = len(planned) - len(missing)
        self.damaged = self.computed = self.retried = self.workers = 0
        self.seconds = 0.0
        self.failed: list[tuple[str, str]] = []
        self.spent = dict.fromkeys(missing, 0)
        # bundle → tasks that are still to end and read it
        self.readers = Counter(name for task in missing.values() for name in _read_by(task))

    def do(self, pool: Pool) -> None:
        """Does what is missing; failed ones come again after all others."""
        self.workers = pool.count
        self.store.note("begun", tasks=len(self.planned), kept=self.kept, workers=pool.count)
        waiting, running = deque(self.missing.values()), 0
        while waiting or running:
            while waiting and pool.free > 0:
                pool.start(waiting.popleft())
                running += 1
            outcome = pool.next()
            running -= 1
            if self._ended(outcome):
                self._drop(self.missing[outcome.key], pool)
            else:
                waiting.append(self.missing[outcome.key])
            self.workers = max(self.workers, pool.count)

    def _drop(self, task: Task, pool: Pool) -> None:
        """Says which bundles nobody reads any more, now that `task` has ended."""
        for name in _read_by(task):
            self.readers[name] -= 1
            if not self.readers[name]:
                pool.drop(name)

    def _ended(self, outcome: Outcome) -> bool:
        """Whether the task is finished or given up."""
        key, name = outcome.key, self.missing[outcome.key].name
        self.spent[key] += outcome.spent
        if isinstance(outcome.data, Fault):
            return self._failed(outcome, outcome.data, name)
        self.store.put(
            key,
            outcome.data,
            seconds=outcome.seconds,
            worker=outcome.worker,
            attempt=self.spent[key],
        )
        self.computed += 1
        self.seconds += outcome.seconds
        self.tell(name)
        return True

    def _failed(self, outcome: Outcome, fault: Fault, name: str) -> bool:
        spent = self.spent[outcome.key]
        over = spent >= self.attempts or fault.kind != "machine"
        self.store.note(
            "given up" if over else "failed",
            key=outcome.key,
            reason=fault.words[:2000],
            worker=outcome.worker,
            attempt=spent,
        )
        if fault.kind != "machine":
            fault.stop()
        self.retried += 1
        if over:
            self.failed.append((name, fault.words))
            self.tell(name)
        return over

    def tell(self, name: str) -> None:
        """Says how far it is."""
        if self.progress is None:
            return
        done, of = self.kept + self.computed + len(self.failed), len(self.planned)
        left: float | None = 0.0 if done == of else None
        if self.computed and done < of:
            rounds = max((of - done) / max(self.workers, 1), 1.0)
            left = self.seconds / self.computed * rounds
        self.progress(TasksProgress(done, of, self.kept, name, left))

    def report(self, elapsed: float) -> TasksReport:
        """What was done; raises `MachineError` if tasks were given up."""
        if self.failed:
            self._refuse()
        return TasksReport(
            len(self.planned),
            self.computed,
            self.kept,
            self.damaged,
            self.retried,
            self.seconds,
            elapsed,
            self.workers,
        )

    def _refuse(self) -> NoReturn:
        kept = self.kept + self.computed
        raise MachineError(
            f"{len(self.failed)} of {len(self.planned)} tasks failed {self.attempts} times: "
            f"{named(self.failed)}",
            remedy=f"{kept} are kept in {self.store.folder}: bake again, and only those "
            "that failed are done",
        )
