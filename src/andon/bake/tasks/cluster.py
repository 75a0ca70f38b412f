"""Workers of a Dask cluster: other machines, by the address of their scheduler.

A scheduler runs code that its peers send it, and so do its workers: whoever reaches its port owns
those machines. Let it listen on a network that you trust alone, or give it certificates (TLS).

No state lives there. Bundles are sent once, and each worker writes them into a folder of its own
once; artefacts come back and are kept by this side's `Store`. A worker that goes loses the task
that it was doing, which the scheduler gives to another. A scheduler that goes ends the bake; one
that begins again does what is missing.
"""

from __future__ import annotations

import importlib
import logging
import queue
import shutil
import threading
from collections.abc import Generator, Mapping, Sequence
from contextlib import contextmanager, suppress
from math import inf
from pathlib import Path
from time import monotonic
from typing import Any
from uuid import uuid4

from andon.bake.tasks.inputs import write_bundle
from andon.bake.tasks.model import Bundle, Task
from andon.bake.tasks.outcomes import ATTEMPTS, Fault, Outcome, performed
from andon.errors import MachineError

__all__ = ["DaskWorkers"]

# Whether the scheduler is still there is looked at so often while nothing comes.
_PAUSE_SECONDS = 0.5
# How old what is known of the workers may be.
_LOOK_SECONDS = 1.0
# Where workers keep bundles, in the folder that Dask gives them and removes.
_FOLDER = "andon-inputs"
# Tasks that are sent for each one that is being done, so that workers need not wait for us.
_AHEAD = 2
# Folders of bundles are written once, by whichever thread of a worker comes first.
_WRITING = threading.Lock()


class DaskWorkers:
    """The workers of the scheduler at `address`, such as ``tcp://10.0.0.7:8786``.

    Parameters
    ----------
    address : with ``tls://`` for one that asks for certificates.
    tls_ca, tls_cert, tls_key : PEM files: who is trusted, and who this side is. All three or none.
    connect_seconds : how long the scheduler, and then the first worker, are waited for.
    """

    def __init__(
        self,
        address: str,
        *,
        tls_ca: Path | None = None,
        tls_cert: Path | None = None,
        tls_key: Path | None = None,
        connect_seconds: float = 10.0,
    ) -> None:
        self.address, self.connect_seconds = address, connect_seconds
        self.tls = tuple(path for path in (tls_ca, tls_cert, tls_key) if path is not None)
        if len(self.tls) not in (0, 3):
            raise ValueError("TLS needs all three: tls_ca, tls_cert and tls_key")

    @contextmanager
    def started(self, bundles: Mapping[str, Bundle], folder: Path, /) -> Generator[_DaskPool]:
        """The cluster's workers; see `Workers`. They themselves are left running."""
        with _quiet():
            client = self._connected()
            try:
                pool = _DaskPool(client, self.address, folder, self.connect_seconds)
                pool.send(bundles)
                try:
                    yield pool
                finally:
                    pool.forget()
            finally:
                with suppress(Exception):
                    client.close(timeout=2)

    def _connected(self) -> Any:
        distributed = _distributed()
        security = None
        if self.tls:
            ca, cert, key = map(str, self.tls)
            security = distributed.Security(
                tls_ca_file=ca, tls_client_cert=cert, tls_client_key=key, require_encryption=True
            )
        try:
            client = distributed.Client(
                self.address,
                timeout=self.connect_seconds,
                security=security,
                set_as_default=False,
            )
        except Exception as error:  # distributed raises OSError, ValueError, TypeError and others
            raise MachineError(
                f"no Dask scheduler at {self.address}: {_first_line(error)}",
                remedy="start one there (dask scheduler), or bake without --dask",
            ) from error
        try:
            self._check(client)
        except BaseException:
            client.close(timeout=2)
            raise
        return client

    def _check(self, client: Any) -> None:
        """There are workers, and they have this version."""
        try:
            client.wait_for_workers(1, timeout=self.connect_seconds)
        except Exception as error:
            raise MachineError(
                f"the Dask scheduler at {self.address} has no workers",
                remedy=f"start some: dask worker {self.address}",
            ) from error
        for worker, version in client.run(_version, on_error="return").items():
            if version != _version():
                raise MachineError(
                    f"the Dask worker {worker} has no Andon {_version()}: {version}",
                    remedy="install the same version there",
                )


class _DaskPool:
    """See `Pool`."""

    def __init__(self, client: Any, address: str, folder: Path, patience_seconds: float) -> None:
        self._client, self._address, self._folder = client, address, folder
        self._patience = patience_seconds
        self._bundles: Mapping[str, Bundle] = {}
        self._sent: dict[str, Any] = {}
        self._running: dict[Any, Task] = {}
        self._ended: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._threads, self._looked, self._seen = 1, -inf, monotonic()

    @property
    def count(self) -> int:
        """Threads of all workers that there are now, or were when there were any."""
        self._look()
        return self._threads

    @property
    def free(self) -> int:
        return _AHEAD * self.count - len(self._running)

    def send(self, bundles: Mapping[str, Bundle]) -> None:
        """Puts the bundles onto all workers."""
        self._bundles = bundles
        try:
            sent = self._client.scatter([dict(each) for each in bundles.values()], broadcast=True)
        except Exception as error:
            raise self._gone(_first_line(error)) from error
        self._sent = dict(zip(bundles, sent, strict=True))

    def start(self, task: Task, /) -> None:
        """See `Pool`."""
        names, digests = list(task.inputs), list(task.inputs.values())
        sent = [self._sent[each] for each in digests]
        try:
            future = self._client.submit(
                _performed_there,
                *(task, names, digests, *sent),
                key=f"andon-{task.key}-{uuid4().hex[:12]}",
                pure=False,
            )
        except Exception as error:
            raise self._gone(_first_line(error)) from error
        self._running[future] = task
        future.add_done_callback(self._ended.put)

    def next(self) -> Outcome:
        """See `Pool`."""
        while True:
            try:
                future = self._ended.get(timeout=_PAUSE_SECONDS)
            except queue.Empty:
                self._look()
                continue
            task = self._running.pop(future)
            try:
                return future.result()
            except Exception as error:
                return self._failed(task, error)

    def forget(self) -> None:
        """Lets workers remove their folders."""
        if self._client.status == "running":
            with suppress(Exception):
                self._client.run(_forget, list(self._bundles))

    def _failed(self, task: Task, error: Exception) -> Outcome:
        """An attempt that came to no end on a worker."""
        self._look(now=True)
        if type(error).__name__ == "KilledWorker":  # the scheduler has tried it several times
            words = "the workers that tried it died (out of memory?)"
            return Outcome(task.key, Fault("machine", words), spent=ATTEMPTS)
        # With a worker its inputs may have gone.
        self.send(self._bundles)
        return Outcome(task.key, Fault("machine", f"{type(error).__name__}: {_first_line(error)}"))

    def _look(self, *, now: bool = False) -> None:
        """Who is there; raises `MachineError` if the scheduler, or for long any worker, is not."""
        if self._client.status != "running":
            raise self._gone("the connection is lost")
        if not now and monotonic() - self._looked < _LOOK_SECONDS:
            return
        try:
            threads = sum(map(int, self._client.nthreads().values()))
        except Exception as error:
            raise self._gone(_first_line(error)) from error
        self._looked = monotonic()
        if threads:
            self._threads, self._seen = threads, self._looked
        elif self._looked - self._seen > self._patience:
            raise self._gone("it has no workers left")

    def _gone(self, why: str) -> MachineError:
        return MachineError(
            f"the Dask scheduler at {self._address} is of no more use: {why}",
            remedy=f"start it again, or bake without it: what is done is kept in {self._folder}",
        )


def _version() -> str:
    from andon import __version__

    return __version__


def _performed_there(
    task: Task, names: Sequence[str], digests: Sequence[str], *bundles: Bundle
) -> Outcome:
    """Does a task on a worker of the cluster."""
    worker = _distributed().get_worker()
    root = Path(worker.local_directory) / _FOLDER
    try:
        with _WRITING:
            folders = [_folder(root, *each) for each in zip(digests, bundles, strict=True)]
    except OSError as error:
        words = f"{worker.address}: inputs cannot be written: {error.strerror or error}"
        return Outcome(task.key, Fault("machine", words), worker=worker.address)
    return performed(task, dict(zip(names, folders, strict=True)), worker.address)


def _folder(root: Path, digest: str, bundle: Bundle) -> Path:
    """The folder of a bundle, written if it is not there; whole or not there at all."""
    folder = root / digest
    if not folder.is_dir():
        half = root / f"{digest}.half"
        shutil.rmtree(half, ignore_errors=True)
        write_bundle(half, bundle).rename(folder)
    return folder


def _forget(digests: Sequence[str], dask_worker: Any = None) -> None:
    """Runs beside the tasks of a worker, which Dask hands over by this argument's name."""
    root = Path(dask_worker.local_directory) / _FOLDER
    for digest in digests:
        shutil.rmtree(root / digest, ignore_errors=True)
    with suppress(OSError):
        root.rmdir()


def _distributed() -> Any:
    try:
        return importlib.import_module("distributed")
    except ImportError as error:
        raise MachineError(
            "Dask is not installed", remedy="pip install 'andon[cluster]'"
        ) from error


@contextmanager
def _quiet() -> Generator[None]:
    """Without what the library logs of connections that end; what matters is said by us."""
    logger = logging.getLogger("distributed")
    before = logger.level
    logger.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        logger.setLevel(before)


def _first_line(error: BaseException) -> str:
    return (str(error).strip() or type(error).__name__).splitlines()[0]
