"""Bakes that are killed, at each step and at any moment, and begun again: the same bytes, and no
finished task is done twice.
"""

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import works_for_tasks
from works_for_tasks import BUNDLES, Inline, contents, logged, task, tasks

from andon.bake.tasks import LocalWorkers, Store, run_tasks, tasks_status
from andon.errors import MachineError
from requirements import required

COUNT, SECONDS = 16, 0.04


def command(*arguments):
    return [sys.executable, works_for_tasks.__file__, *map(str, arguments)]


def environment(log):
    return os.environ | {"PYTHONPATH": os.pathsep.join(sys.path), "TASKS_LOG": str(log)}


def uninterrupted(folder, planned):
    run_tasks(planned, BUNDLES, Store(folder), workers=Inline())
    return contents(folder)


def done_in(folder, planned):
    store = Store(folder)
    return {number for number, each in enumerate(planned) if store.get(each.key)}


def test_killed_at_each_step(tmp_path):
    """At each file that is opened, renamed, removed or flushed, before it and after it."""
    good = uninterrupted(tmp_path / "good", tasks(2))
    done = subprocess.run(
        command("everywhere", tmp_path),
        env=environment(os.devnull), check=True, capture_output=True, text=True,
    )  # fmt: skip
    steps = int(done.stdout)
    assert steps >= 40
    for step in range(1, steps + 1):
        assert contents(tmp_path / str(step)) == good, step
    # At most the task that was being done is done again.
    runs = [[n for n, _ in logged(tmp_path / f"{step}.log")] for step in range(1, steps + 1)]
    assert {tuple(each) for each in runs} == {(0, 1), (0, 0, 1), (0, 1, 1)}


class Victim:
    """A bake in a process of its own, with its workers."""

    def __init__(self, folder, log):
        self.process = subprocess.Popen(
            command(folder, COUNT, SECONDS, 2), env=environment(log), stdout=subprocess.PIPE
        )
        assert self.process.stdout.readline() == b"begun\n"

    def killed(self, after, *, workers):
        """Whether it was still alive; its workers are killed with it or end by themselves."""
        psutil = required("psutil")
        time.sleep(after)
        children = psutil.Process(self.process.pid).children() if self.running() else []
        if workers:
            for child in children:
                child.kill()
        self.process.kill()
        code = self.process.wait()
        self.process.stdout.close()
        assert psutil.wait_procs(children, timeout=10)[1] == []
        assert code in (0, -signal.SIGKILL)
        return code != 0

    def running(self):
        return self.process.poll() is None


def killed_at_random(folder, wanted, seed):
    """Kills and resumes bakes until `wanted` have been killed; a new one where one came through."""
    generator = random.Random(seed)
    planned = tasks(COUNT, SECONDS)
    good = uninterrupted(folder / "good", planned)
    kills = resumed = bake = 0
    while kills < wanted or resumed:
        own, log = folder / f"bake {bake}", folder / f"log {bake}"
        finished = done_in(own, planned)
        before = len(logged(log))
        after = generator.uniform(0, 1.2) if kills < wanted else 60
        victim = Victim(own, log)
        if kills < wanted and victim.killed(after, workers=generator.random() < 0.5):
            kills, resumed = kills + 1, True
            again = {n for n, _ in logged(log)[before:]}
            assert not again & finished
            assert finished <= done_in(own, planned)
            continue
        assert victim.process.wait(60) == 0
        victim.process.stdout.close()
        assert not {n for n, _ in logged(log)[before:]} & finished
        assert contents(own) == good
        bake, resumed = bake + 1, False
    return kills, bake


def test_killed_at_random_and_resumed(tmp_path):
    assert killed_at_random(tmp_path, 3, seed=7)[0] == 3


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_killed_a_hundred_times(tmp_path):
    kills, bakes = killed_at_random(tmp_path, 100, seed=100)
    assert kills == 100
    assert bakes >= 5


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGINT])
def test_programs_of_a_killed_bake_end_with_it(tmp_path, how):
    pid = tmp_path / "pid"
    code = (
        "import sys; from pathlib import Path; from works_for_tasks import *\n"
        "run_tasks([task(0), task(1, 'with_a_program', pid=sys.argv[2])], BUNDLES,\n"
        "    Store(Path(sys.argv[1])), workers=LocalWorkers(2))"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", code, str(tmp_path / "maps"), str(pid)],
        env=environment(os.devnull), stderr=subprocess.DEVNULL,
    )  # fmt: skip
    until(pid.exists)
    until(lambda: tasks_status(tmp_path / "maps").done == 1)
    assert tasks_status(tmp_path / "maps").pid == process.pid
    process.send_signal(how)
    process.wait(20)
    for number in map(int, pid.read_text().split()):
        until(lambda number=number: not alive(number))
    assert (tmp_path / "maps" / "lock").exists() == (how == signal.SIGKILL)
    status = tasks_status(tmp_path / "maps")
    assert (status.done, status.running) == (1, False)


def until(true, seconds=20):
    end = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < end
        time.sleep(0.02)


def alive(pid):
    try:
        return " Z " not in Path(f"/proc/{pid}/stat").read_text()
    except FileNotFoundError:
        return False


def test_a_worker_that_dies_costs_one_attempt_of_its_task(tmp_path, monkeypatch):
    monkeypatch.setenv("TASKS_LOG", str(tmp_path / "log"))
    store = Store(tmp_path / "maps")
    planned = [task(9, "dies_once", mark=str(tmp_path / "mark")), *tasks(6)]
    report = run_tasks(planned, BUNDLES, store, workers=LocalWorkers(2))
    assert (report.computed, report.retried, report.workers) == (7, 1, 2)
    assert store.get(planned[0].key).read_bytes() == b"alive"
    assert sorted(n for n, _ in logged(tmp_path / "log")) == list(range(6))
    with pytest.raises(MachineError) as error:
        run_tasks([task(8, "dies"), *tasks(7)], BUNDLES, store, workers=LocalWorkers(1))
    assert "1 of 8 tasks failed 3 times: task 8 (its worker died: killed by SIGKILL (out of" in str(
        error.value
    )
    with pytest.raises(MachineError, match="exit code 7, and said 'the lamp is broken'"):
        run_tasks([task(1, "leaves")], BUNDLES, store, workers=LocalWorkers(1))


def test_works_may_use_the_standard_streams_and_one_thread(tmp_path):
    store, planned = Store(tmp_path / "maps"), [task(1, "talks"), task(2, "threads")]
    run_tasks(planned, BUNDLES, store, workers=LocalWorkers(1))
    assert [store.get(each.key).read_bytes() for each in planned] == [b"heard ", b"1"]
    assert not (store.folder / "inputs").exists()
    with pytest.raises(ValueError, match="count must be ≥ 1, got 0"):
        LocalWorkers(0)
    assert LocalWorkers().count >= 1
