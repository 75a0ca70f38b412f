"""What runs on a worker of a Dask cluster; imported only where Dask is."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from distributed import WorkerPlugin, get_worker

from andon.bake.tasks.inputs import write_bundle
from andon.bake.tasks.model import Bundle, Task
from andon.bake.tasks.outcomes import Fault, Outcome, performed
from andon.files.radiance_programs import radiance_version

__all__ = ["Inputs", "performed_there", "version"]


def version() -> str:
    """Of what computes on this machine: another one may give other bytes for the same key."""
    from andon import __version__

    return f"Andon {__version__}, pyradiance {radiance_version()}"


class Inputs(WorkerPlugin):
    """A plugin of workers: bundles as folders, from when a worker starts until it is unregistered.

    Dask sends it to each worker and to those that come later, and calls `setup` and `teardown`.
    The folders lie in the one that Dask gives a worker, which goes with it.

    Attributes
    ----------
    folders : digest → folder, on a worker.
    fault : why it is of no use; a worker with a full disk, or one of another version that comes
        later, still starts, and says so task by task.
    """

    def __init__(self, name: str, bundles: Mapping[str, Bundle]) -> None:
        self.name, self.version = name, version()
        self.bundles = {digest: dict(bundle) for digest, bundle in bundles.items()}
        self.folders: dict[str, Path] = {}
        self.fault: str | None = None
        self._root: Path | None = None

    def setup(self, worker: Any) -> None:
        """Writes the folders."""
        if version() != self.version:
            self.fault = f"{worker.address} has {version()}, not {self.version}"
        self._root = Path(worker.local_directory).resolve() / self.name
        try:
            for digest, bundle in self.bundles.items():
                self.folders[digest] = write_bundle(self._root / digest, bundle)
        except OSError as error:
            self.fault = f"{self._root}: cannot be written: {error.strerror or error}"
        self.bundles.clear()

    def teardown(self, worker: Any) -> None:
        """Removes them."""
        if self._root is not None:
            shutil.rmtree(self._root, ignore_errors=True)


def performed_there(task: Task, name: str, /) -> Outcome:
    """Does a task with the inputs of the plugin `name`."""
    worker: Any = get_worker()
    inputs: Inputs = worker.plugins[name]
    if inputs.fault is not None:
        return Outcome(task.key, Fault("machine", inputs.fault), worker=worker.address)
    folders = {each: inputs.folders[digest] for each, digest in task.inputs.items()}
    return performed(task, folders, worker.address)
