"""Who does tasks: what a bake asks of workers, wherever they are."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Protocol

from andon.bake.tasks.model import Bundle, Task
from andon.bake.tasks.outcomes import Outcome

__all__ = ["Pool", "Workers"]


class Pool(Protocol):
    """Workers that run."""

    @property
    def count(self) -> int:
        """How many tasks are done at the same time, ≥ 1."""
        ...

    @property
    def free(self) -> int:
        """How many more tasks it takes now."""
        ...

    def start(self, task: Task, /) -> None:
        """Hands out a task, with what it reads.

        Raises `MachineError` where there is nobody to do it, or no room for what it reads.
        """
        ...

    def drop(self, digest: str, /) -> None:
        """No task that runs or comes reads this bundle; it need not be kept."""
        ...

    def next(self) -> Outcome:
        """Waits for the next attempt to end.

        Raises `MachineError` where no worker can ever end one.
        """
        ...


class Workers(Protocol):
    """Workers that can be started."""

    def started(
        self, bundles: Mapping[str, Bundle], folder: Path, /
    ) -> AbstractContextManager[Pool]:
        """Workers that get `bundles` (digest → files) with the tasks that read them.

        They are killed afterwards, whatever they do. `folder` is the store's. Raises
        `MachineError` where they cannot be started.
        """
        ...
