"""What runs on a worker of a Dask cluster; imported only where Dask is."""

from __future__ import annotations

import shutil
from collections import Counter
from collections.abc import Collection, Generator, Mapping
from contextlib import contextmanager
from pathlib import Path
from threading import Lock
from typing import Any

from distributed import WorkerPlugin, get_worker

from andon.bake.tasks.inputs import Inputs
from andon.bake.tasks.model import Bundle, Task
from andon.bake.tasks.outcomes import Fault, Outcome, performed
from andon.errors import MachineError
from andon.files.radiance_programs import radiance_version

__all__ = ["Folders", "held", "performed_there", "version"]


def version() -> str:
    """Of what computes on this machine: another one may give other bytes for the same key."""
    from andon import __version__

    return f"Andon {__version__}, pyradiance {radiance_version()}"


def held(bundle: Bundle, /) -> Bundle:
    """A bundle as a result, which Dask moves between workers and asks for again if one dies."""
    return bundle


class Folders(WorkerPlugin):
    """A plugin of workers: bundles as folders, as long as tasks that are out read them.

    Dask sends it to each worker and to those that come later, and calls `setup` and `teardown`.
    The folders lie in the one that Dask gives a worker, which goes with it.

    Attributes
    ----------
    fault : why it is of no use; a worker of another version that comes later still starts, and says
        so task by task.
    """

    def __init__(self, name: str) -> None:
        self.name, self.version = name, version()
        self.fault: str | None = None

    def setup(self, worker: Any) -> None:
        """Finds the place of the folders."""
        if version() != self.version:
            self.fault = f"{worker.address} has {version()}, not {self.version}"
        self._root = Path(worker.local_directory).resolve() / self.name
        self._bundles: dict[str, Bundle] = {}
        self._inputs = Inputs(self._root, self._bundles)
        self._readers, self._lock = Counter[str](), Lock()

    def teardown(self, worker: Any) -> None:
        """Removes them."""
        shutil.rmtree(self._root, ignore_errors=True)

    @contextmanager
    def of(
        self, task: Task, bundles: Mapping[str, Bundle], out: Collection[str]
    ) -> Generator[dict[str, Path]]:
        """What `task` reads, its `bundles`, as folders; those go that no task reads.

        `out` are the bundles of all tasks that were out when this one was sent. Raises
        `MachineError` where one cannot be written.
        """
        with self._lock:
            self._readers.update(bundles.keys())
            for digest in [each for each in self._bundles if each not in out]:
                if not self._readers[digest]:
                    self._inputs.drop(digest)
                    del self._bundles[digest]
            self._bundles |= bundles
        try:
            with self._lock:
                folders = self._inputs.of(task)
            yield folders
        finally:
            with self._lock:
                self._readers.subtract(bundles.keys())


def performed_there(
    task: Task, name: str, bundles: Mapping[str, Bundle], out: Collection[str], /
) -> Outcome:
    """Does a task with the plugin `name`; see `Folders.of`."""
    worker: Any = get_worker()
    there: Folders = worker.plugins[name]
    if there.fault is not None:
        return Outcome(task.key, Fault("machine", there.fault), worker=worker.address)
    try:
        with there.of(task, bundles, out) as folders:
            return performed(task, folders, worker.address)
    except MachineError as error:
        return Outcome(task.key, Fault("machine", str(error)), worker=worker.address)
