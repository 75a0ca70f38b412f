"""Runs the tasks of a bake: what is kept is not done again, what fails is tried again."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from time import perf_counter
from typing import NoReturn

from andon.bake.journal import Journal, Result
from andon.bake.tasks.outcomes import ATTEMPTS, OURS, named
from andon.errors import InputError, MachineError

__all__ = ["Progress", "Runner"]

# (done, of, what is being done)
Progress = Callable[[int, int, str], None]


class Runner:
    """Tasks of probes, one after the other.

    Attributes
    ----------
    total : tasks of the whole bake, for `progress`.
    computed, seconds : what was not kept from before, and the time that took.
    """

    def __init__(self, journal: Journal, names: Sequence[str], progress: Progress | None) -> None:
        self.journal, self.names = journal, names
        self.total = self.computed = self._done = 0
        self.seconds = 0.0
        self._progress = progress

    def each(
        self,
        what: str,
        indices: Sequence[int],
        key: Callable[[int], str],
        work: Callable[[int], Result],
    ) -> list[Result]:
        """The results of `work` for the probes `indices`, each kept by its `key`.

        Raises `MachineError` after all others are done for those that failed three times, from
        the last of their exceptions; at once `InputError`, and exceptions that are our own faults.
        """
        results: list[Result] = []
        failed: list[tuple[str, Exception]] = []
        for index in indices:
            name = key(index)
            result: Result | None = self.journal.get(name)
            if result is None:
                tried = self._tried(index, work)
                if isinstance(tried, Exception):
                    failed.append((self.names[index], tried))
                else:
                    self.journal.put(name, result := tried)
            if result is not None:
                results.append(result)
            self._done += 1
            if self._progress is not None:
                self._progress(self._done, self.total, what)
        if failed:
            self._refuse(failed, len(indices))
        return results

    def advance(self, count: int, what: str, /) -> None:
        """Counts work that others have done."""
        self._done += count
        if self._progress is not None and count:
            self._progress(self._done, self.total, what)

    def _tried(self, index: int, work: Callable[[int], Result]) -> Result | Exception:
        """What `work` gives; the last exception where it fails each time."""
        fault: Exception = MachineError("was not tried")
        for _ in range(ATTEMPTS):
            start = perf_counter()
            try:
                result = work(index)
            except (InputError, *OURS):  # trying again would not make a file better, nor us
                raise
            except Exception as error:
                fault = error
                continue
            self.computed += 1
            self.seconds += perf_counter() - start
            return result
        return fault

    def _refuse(self, failed: list[tuple[str, Exception]], count: int) -> NoReturn:
        names = named([(name, f"{type(fault).__name__}: {fault}") for name, fault in failed])
        folder = self.journal.folder
        kept = "" if folder is None else f"the others are kept in {folder}: "
        raise MachineError(
            f"{len(failed)} of {count} probes failed {ATTEMPTS} times: {names}",
            remedy=f"{kept}bake again, or leave these probes out",
        ) from failed[-1][1]
