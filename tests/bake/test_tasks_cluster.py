"""A cluster's workers: what they give, what happens when they go, and when the scheduler goes."""

import gc
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from contextlib import ExitStack, contextmanager
from pathlib import Path
from types import SimpleNamespace

import pytest
from works_for_tasks import BUNDLES, DIGEST, Inline, contents, logged, task, tasks

from andon.bake.tasks import DaskWorkers, Store, Task, bundle_digest, run_tasks, tasks_status
from andon.errors import MachineError
from requirements import missing, required

distributed = required("distributed")


@contextmanager
def program(kind, *arguments, log):
    """A scheduler or worker of Dask, as people start it; gives the process."""
    module = f"distributed.cli.dask_{kind}"
    with log.open("w") as stream:
        process = subprocess.Popen(
            [sys.executable, "-m", module, "--no-dashboard", *map(str, arguments)],
            stderr=stream, stdout=stream, start_new_session=True,
            env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)},
        )  # fmt: skip
    try:
        yield process
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()


def address_in(log):
    """Where a scheduler listens, as it says itself."""
    end = time.monotonic() + 30
    while not (found := re.search(r"Scheduler at:\s+(\S+)", log.read_text())):
        assert time.monotonic() < end, log.read_text()
        time.sleep(0.02)
    return found[1]


@contextmanager
def cluster(folder, workers, *security):
    """(address, scheduler, workers) with what they log and keep in `folder`."""
    folder.mkdir(exist_ok=True)
    with ExitStack() as stack:
        log = folder / "scheduler.log"
        local = ("--host", "tls://127.0.0.1" if security else "127.0.0.1", *security)
        scheduler = stack.enter_context(program("scheduler", "--port", 0, *local, log=log))
        address = address_in(log)
        started = [
            stack.enter_context(
                program(
                    "worker", address, "--nthreads", 1, "--no-nanny", *security,
                    "--local-directory", folder / f"worker {n}", log=folder / f"{n}.log",
                )
            )
            for n in range(workers)
        ]  # fmt: skip
        yield address, scheduler, started


@pytest.fixture
def log(tmp_path, monkeypatch):
    monkeypatch.setenv("TASKS_LOG", str(tmp_path / "log"))
    return tmp_path / "log"


def until(true, seconds=30):
    end = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < end
        time.sleep(0.02)


def inputs_of(folder):
    return [path for path in folder.rglob("andon-inputs*") if path.is_dir()]


def test_a_cluster_gives_what_this_machine_gives(tmp_path, log):
    planned = tasks(6)
    run_tasks(planned, BUNDLES, Store(tmp_path / "here"), workers=Inline())
    with cluster(tmp_path / "dask", 2) as (address, _, _):
        workers = DaskWorkers(address)
        report = run_tasks(planned, BUNDLES, Store(tmp_path / "there"), workers=workers)
        assert report.computed == 6
        assert contents(tmp_path / "there") == contents(tmp_path / "here")
        assert inputs_of(tmp_path / "dask") == []
        with pytest.raises(KeyError, match="missing"):
            run_tasks([task(1, "our_fault")], BUNDLES, Store(tmp_path / "a"), workers=workers)
        with pytest.raises(MachineError, match=r"3 times: task 1 \(OSError: no light\); 2 are"):
            run_tasks(
                [task(1, "fails"), *tasks(2)], BUNDLES, Store(tmp_path / "b"), workers=workers
            )
        assert inputs_of(tmp_path / "dask") == []
        # Nothing is done again where all is done: not even the cluster is asked.
    report = run_tasks(planned, BUNDLES, Store(tmp_path / "there"), workers=workers)
    assert (report.kept, report.workers) == (6, 0)


def test_the_task_of_a_killed_worker_is_done_elsewhere(tmp_path, log):
    planned = [task(9, "dies_once", mark=str(tmp_path / "mark")), *tasks(5, 0.05)]
    with cluster(tmp_path / "dask", 2) as (address, _, started):
        store = Store(tmp_path / "maps")
        report = run_tasks(planned, BUNDLES, store, workers=DaskWorkers(address))
        assert (report.computed, report.retried) == (6, 0)
        assert sum(worker.poll() is not None for worker in started) == 1
        assert sorted(n for n, _ in logged(log)) == [0, 1, 2, 3, 4]
        # The last one goes as well: nobody is left to do anything.
        with pytest.raises(MachineError) as error:
            run_tasks(
                [*planned, task(8, "dies")], BUNDLES, store,
                workers=DaskWorkers(address, connect_seconds=1),
            )  # fmt: skip
        assert f"Dask scheduler at {address} is of no more use: it has no workers left" in str(
            error.value
        )
        with pytest.raises(MachineError, match=f"no workers; start some: dask worker {address}"):
            run_tasks(tasks(9), BUNDLES, store, workers=DaskWorkers(address, connect_seconds=0.5))


def test_a_scheduler_that_goes_loses_nothing_that_is_done(tmp_path, log):
    planned, store = tasks(12, 0.2), Store(tmp_path / "maps")

    def killing(progress):
        if progress.done == 3:
            os.killpg(scheduler.pid, signal.SIGKILL)

    with cluster(tmp_path / "dask", 1) as (address, scheduler, _):
        start = time.monotonic()
        with pytest.raises(MachineError, match="is of no more use") as error:
            run_tasks(planned, BUNDLES, store, workers=DaskWorkers(address), progress=killing)
        assert time.monotonic() - start < 20
    assert f"what is done is kept in {store.folder}" in str(error.value)
    assert error.value.exit_code == 3
    kept = tasks_status(store.folder).done
    assert 3 <= kept < 12
    report = run_tasks(planned, BUNDLES, store, workers=Inline())
    assert (report.kept, report.computed) == (kept, 12 - kept)


def test_a_worker_of_another_version_is_refused(tmp_path, monkeypatch):
    from andon.bake.tasks import cluster_worker

    inputs = cluster_worker.Folders("inputs")
    with cluster(tmp_path / "dask", 1) as (address, _, _), monkeypatch.context() as patched:
        patched.setattr(cluster_worker, "radiance_version", lambda: "9")
        with pytest.raises(MachineError, match=r"has not Andon .*, pyradiance 9: Andon .*install"):
            run_tasks(tasks(1), BUNDLES, Store(tmp_path / "maps"), workers=DaskWorkers(address))
        # One that comes when all others have been asked says so itself.
        worker = SimpleNamespace(local_directory=tmp_path, address="tcp://late", plugins={})
        inputs.setup(worker)
        assert re.fullmatch(r"tcp://late has Andon \S+, pyradiance 9, not Andon .*", inputs.fault)


def test_a_worker_holds_what_tasks_that_are_out_read(tmp_path):
    from andon.bake.tasks import cluster_worker

    inputs, there = cluster_worker.Folders("inputs"), tmp_path / "inputs" / "inputs"
    worker = SimpleNamespace(local_directory=tmp_path, address="tcp://here", plugins={})
    inputs.setup(worker)
    other = {"other.txt": b"moonlight"}
    name = bundle_digest(other)
    second = Task("other", "works_for_tasks:work", {"scene": name}, {"n": 1})
    with inputs.of(tasks(1)[0], BUNDLES, [DIGEST]) as folders:
        assert (folders["scene"] / "deep/er/more.txt").read_bytes() == b" of lamps"
        with inputs.of(second, {name: other}, [name]) as more:
            assert (more["scene"] / "other.txt").read_bytes() == b"moonlight"
            assert (there / DIGEST).exists(), "a task reads it"
    with inputs.of(second, {name: other}, [name, DIGEST]):
        assert (there / DIGEST).exists(), "a task that comes reads it"
    with inputs.of(second, {name: other}, [name]):
        assert [path.name for path in there.iterdir()] == [name]
    inputs.teardown(worker)
    assert not (tmp_path / "inputs").exists()


def test_a_full_worker_says_so(tmp_path, monkeypatch):
    from andon.bake.tasks import cluster_worker

    (tmp_path / "inputs").write_bytes(b"in the way")
    inputs = cluster_worker.Folders("inputs")
    worker = SimpleNamespace(
        local_directory=tmp_path, address="tcp://full", plugins={"inputs": inputs}
    )
    inputs.setup(worker)
    monkeypatch.setattr(cluster_worker, "get_worker", lambda: worker)
    outcome = cluster_worker.performed_there(tasks(1)[0], "inputs", BUNDLES, [DIGEST])
    assert outcome.worker == "tcp://full"
    assert outcome.data.kind == "machine"
    assert f"inputs/{DIGEST}: cannot be written: " in outcome.data.words


def test_nobody_at_the_address_is_said_soon(tmp_path):
    start = time.monotonic()
    with pytest.raises(MachineError, match=r"no Dask scheduler at tcp://127\.0\.0\.1:1: ") as error:
        run_tasks(
            tasks(1), BUNDLES, Store(tmp_path / "maps"),
            workers=DaskWorkers("tcp://127.0.0.1:1", connect_seconds=0.5),
        )  # fmt: skip
    assert time.monotonic() - start < 10
    assert error.value.exit_code == 3
    for address in ("127.0.0.1", "udp://x:1", "", "tcp://127.0.0.1:99999999"):
        with pytest.raises(MachineError, match="no Dask scheduler at"):
            run_tasks(
                tasks(1), BUNDLES, Store(tmp_path / "maps"),
                workers=DaskWorkers(address, connect_seconds=0.5),
            )  # fmt: skip


def test_clients_that_were_lost_end_before_another_starts(tmp_path, monkeypatch):
    ended, asked = [], []

    class Lost:
        def __init__(self):
            self.itself = self

        def __del__(self):
            ended.append(self)

    def client(*_, **__):
        asked.append(len(ended))
        raise OSError("nobody")

    monkeypatch.setattr(distributed, "Client", client)
    gc.disable()
    try:
        Lost()
        with pytest.raises(MachineError, match="no Dask scheduler at"):
            run_tasks(tasks(1), BUNDLES, Store(tmp_path / "maps"), workers=DaskWorkers("tcp://a:1"))
    finally:
        gc.enable()
    assert asked == [1]


def test_without_dask_its_package_is_named(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(MachineError, match=r"Dask is not installed; pip install 'andon\[cluster\]"):
        run_tasks(tasks(1), BUNDLES, Store(tmp_path / "maps"), workers=DaskWorkers("tcp://a:1"))


def certificates(folder):
    """(ca, cert, key): one that signs itself."""
    cert, key = folder / "cert.pem", folder / "key.pem"
    subprocess.run(
        ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj",
         "/CN=localhost", "-addext", "subjectAltName=IP:127.0.0.1", "-keyout", key, "-out", cert],
        check=True, capture_output=True,
    )  # fmt: skip
    return cert, cert, key


def test_certificates_keep_others_out(tmp_path, log):
    if shutil.which("openssl") is None:
        missing("openssl makes the certificates")
    ca, cert, key = certificates(tmp_path)
    security = ("--tls-ca-file", ca, "--tls-cert", cert, "--tls-key", key)
    with cluster(tmp_path / "dask", 1, *security) as (address, _, _):
        assert address.startswith("tls://")
        ours = DaskWorkers(address, tls_ca=ca, tls_cert=cert, tls_key=key)
        assert run_tasks(tasks(2), BUNDLES, Store(tmp_path / "maps"), workers=ours).computed == 2
        (tmp_path / "other").mkdir()
        ca, cert, key = certificates(tmp_path / "other")
        for stranger in (
            DaskWorkers(address, connect_seconds=1),
            DaskWorkers(address, connect_seconds=1, tls_ca=ca, tls_cert=cert, tls_key=key),
        ):
            with pytest.raises(MachineError, match="no Dask scheduler at"):
                run_tasks(tasks(3), BUNDLES, Store(tmp_path / "maps"), workers=stranger)
    with pytest.raises(ValueError, match="TLS needs all three"):
        DaskWorkers(address, tls_ca=Path("ca.pem"))
