"""Workers of a Dask cluster: other machines, by the address of their scheduler.

A scheduler runs code that its peers send it, and so do its workers: whoever reaches its port owns
those machines. Let it listen on a network that you trust alone, or give it certificates (TLS).

No state lives there. A bundle is sent once, with the first task that reads it, and each worker that
gets such a task writes it into a folder of its own; nobody keeps it when no task that is out reads
it. Artefacts come back and are kept by this side's `Store`. A worker that goes loses the task that
it was doing, which the scheduler gives to another. A scheduler that goes ends the bake; one that
begins again does what is missing.

As many tasks are out at a time as workers have threads, and none waits in a worker's queue: there
it would be blamed when the task before it takes the worker down. Workers of one thread
(``dask worker --nthreads 1``) are the best for the same reason.
"""

from __future__ import annotations

import gc
import importlib
import logging
import queue
import warnings
from collections.abc import Generator, Mapping
from contextlib import contextmanager, suppress
from math import inf
from pathlib import Path
from time import monotonic
from typing import Any
from uuid import uuid4

from andon.bake.tasks.model import Bundle, Task
from andon.bake.tasks.outcomes import ATTEMPTS, Fault, Outcome
from andon.errors import MachineError

__all__ = ["DaskWorkers"]

# Whether the scheduler is still there is looked at so often while nothing comes.
_PAUSE_SECONDS = 0.5
# How old what is known of the workers may be.
_LOOK_SECONDS = 1.0


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
                pool = _DaskPool(client, self.address, bundles, folder, self.connect_seconds)
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
        # Clients that were lost end when Python finds them; if that is while another one starts,
        # both wait for one lock of the library for ever.
        gc.collect()
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
                remedy="start one there (dask scheduler), or bake on this machine",
            ) from error
        try:
            self._check(client)
        except BaseException:
            client.close(timeout=2)
            raise
        return client

    def _check(self, client: Any) -> None:
        """There are workers, and they have this version."""
        from andon.bake.tasks.cluster_worker import version

        try:
            client.wait_for_workers(1, timeout=self.connect_seconds)
        except Exception as error:
            raise MachineError(
                f"the Dask scheduler at {self.address} has no workers",
                remedy=f"start some: dask worker {self.address}",
            ) from error
        for worker, found in client.run(version, on_error="return").items():
            if found != version():
                raise MachineError(
                    f"the Dask worker {worker} has not {version()}: {found}",
                    remedy="install the same versions there",
                )


class _DaskPool:
    """See `Pool`."""

    def __init__(
        self,
        client: Any,
        address: str,
        bundles: Mapping[str, Bundle],
        folder: Path,
        patience_seconds: float,
    ) -> None:
        self._client, self._address, self._folder = client, address, folder
        self._bundles, self._patience = bundles, patience_seconds
        self._sent: dict[str, Any] = {}
        self._name = f"andon-inputs-{uuid4().hex}"
        self._running: dict[Any, Task] = {}
        self._ended: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._threads, self._looked, self._seen = 1, -inf, monotonic()
        self._prepare()

    @property
    def count(self) -> int:
        """Threads of all workers that there are now, or were when there were any."""
        self._look()
        return self._threads

    @property
    def free(self) -> int:
        return self.count - len(self._running)

    def _prepare(self) -> None:
        """All workers, and those that come later, know where to put what tasks read."""
        from andon.bake.tasks.cluster_worker import Folders

        try:
            self._client.register_plugin(Folders(self._name), name=self._name)
        except Exception as error:
            raise self._gone(_first_line(error)) from error

    def start(self, task: Task, /) -> None:
        """See `Pool`."""
        from andon.bake.tasks.cluster_worker import performed_there

        read = {digest: self._held(digest) for digest in task.inputs.values()}
        key, out = f"andon-{task.key}-{uuid4().hex[:12]}", tuple(self._sent)
        future = self._submitted(performed_there, task, self._name, read, out, key=key)
        self._running[future] = task
        future.add_done_callback(self._ended.put)

    def drop(self, digest: str, /) -> None:
        """See `Pool`; workers remove its folder with their next task, or at the end."""
        self._sent.pop(digest, None)

    def _held(self, digest: str) -> Any:
        """The bundle where Dask has it; it is sent if it is not there."""
        from andon.bake.tasks.cluster_worker import held

        if digest not in self._sent:
            key = f"{self._name}-{digest}"
            self._sent[digest] = self._submitted(held, dict(self._bundles[digest]), key=key)
        return self._sent[digest]

    def _submitted(self, function: Any, *values: Any, key: str) -> Any:
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # Dask finds bundles large, and sends them
                return self._client.submit(function, *values, key=key, pure=False)
        except Exception as error:
            raise self._gone(_first_line(error)) from error

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
        self._sent.clear()
        if self._client.status == "running":
            with suppress(Exception):
                self._client.unregister_worker_plugin(self._name)

    def _failed(self, task: Task, error: Exception) -> Outcome:
        """An attempt that came to no end on a worker."""
        self._look(now=True)
        if type(error).__name__ == "KilledWorker":  # the scheduler has tried it several times
            words = "the workers that tried it died (out of memory?)"
            return Outcome(task.key, Fault("machine", words), spent=ATTEMPTS)
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
            remedy="start it again, or bake on this machine: "
            f"what is done is kept in {self._folder}",
        )


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
