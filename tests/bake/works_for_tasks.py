"""Works that tests give to workers, which import this module; and a bake of its own to be killed.

``python works_for_tasks.py FOLDER COUNT SECONDS WORKERS`` does tasks; ``… everywhere FOLDER`` kills
itself at each step of a bake. What works do beside their results goes where ``TASKS_LOG`` says.
"""

import os
import signal
import subprocess
import sys
import time
from collections import deque
from contextlib import contextmanager
from pathlib import Path

from andon.bake.tasks import LocalWorkers, Store, Task, bundle_digest, run_tasks
from andon.bake.tasks.inputs import inputs_in
from andon.bake.tasks.outcomes import performed
from andon.errors import InputError

BUNDLE = {"seed.txt": b"light", "deep/er/more.txt": b" of lamps"}
DIGEST = bundle_digest(BUNDLE)
BUNDLES = {DIGEST: BUNDLE}


def noted(n):
    if log := os.environ.get("TASKS_LOG"):
        with open(log, "a") as stream:
            stream.write(f"{n} {os.getpid()}\n")


def logged(log):
    """[(n, pid)] of all runs of `work` so far."""
    if not Path(log).exists():
        return []
    return [tuple(map(int, line.split())) for line in Path(log).read_text().splitlines()]


def work(inputs, settings):
    noted(settings["n"])
    time.sleep(settings.get("seconds", 0))
    folder = inputs["scene"]
    text = b"".join((folder / name).read_bytes() for name in BUNDLE)
    return text * (settings["n"] + 1) + str(settings["n"]).encode()


def fails(inputs, settings):
    noted(settings["n"])
    raise OSError("no light")


def fails_twice(inputs, settings):
    marks = Path(settings["marks"])
    marks.write_text(marks.read_text() + "x" if marks.exists() else "x")
    if len(marks.read_text()) < 3:
        raise OSError("not yet")
    return b"at last"


def input_at_fault(inputs, settings):
    noted(settings["n"])
    raise InputError("must be > 0", file="scene.toml", field="lamp.flux", remedy="make it so")


def our_fault(inputs, settings):
    noted(settings["n"])
    return {}["missing"]


def no_bytes(inputs, settings):
    return "text"


def dies_once(inputs, settings):
    """The first time its process is killed in the middle, after a while.

    What the process has done before is handed over by then, and not to be done again.
    """
    mark = Path(settings["mark"])
    if not mark.exists():
        mark.write_text(str(os.getpid()))
        time.sleep(0.5)
        os.kill(os.getpid(), signal.SIGKILL)
    return b"alive"


def dies(inputs, settings):
    noted(settings["n"])
    os.kill(os.getpid(), signal.SIGKILL)


def leaves(inputs, settings):
    print("the lamp is broken", file=sys.stderr)
    sys.stderr.flush()
    os._exit(7)


def talks(inputs, settings):
    """Uses the standard streams, as programs that it runs do."""
    print("a line")
    subprocess.run(["echo", "another"], check=True)
    heard = subprocess.run(["cat"], check=True, capture_output=True).stdout
    return b"heard " + heard


def with_a_program(inputs, settings):
    """Waits for a program that takes a minute; its number goes to `settings`' file."""
    with subprocess.Popen(["sleep", "60"]) as program:
        half = Path(settings["pid"] + ".half")
        half.write_text(f"{os.getpid()} {program.pid}")
        half.rename(settings["pid"])
        program.wait()
    return b"slept"


def threads(inputs, settings):
    return os.environ["OMP_NUM_THREADS"].encode()


def task(n, function="work", **settings):
    return Task(f"task {n}", f"works_for_tasks:{function}", {"scene": DIGEST}, {"n": n, **settings})


def tasks(count, seconds=0.0):
    return [task(n, seconds=seconds) for n in range(count)]


def contents(folder):
    """What the result of a bake is: name → bytes of all that is there but the journal."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in Path(folder).rglob("*")
        if path.is_file() and path.name != "journal.jsonl"
    }


class Inline:
    """Does tasks in this process, one after the other."""

    def __init__(self, count=1):
        self.count, self.starts = count, 0

    @property
    def free(self):
        return self.count - len(self.waiting)

    @contextmanager
    def started(self, bundles, folder):
        self.starts += 1
        self.waiting = deque()
        with inputs_in(folder, bundles) as self.inputs:
            yield self

    def start(self, each):
        self.waiting.append(each)

    def next(self):
        each = self.waiting.popleft()
        return performed(each, self.inputs.of(each), "here")

    def drop(self, digest):
        self.inputs.drop(digest)


def killed_everywhere(folder):
    """Bakes that kill themselves at the first, second, … step that touches files; each resumed.

    Prints how many steps there were.
    """
    step = 0
    while True:
        step += 1
        own = folder / str(step)
        os.environ["TASKS_LOG"] = str(folder / f"{step}.log")
        if not _killed_at(step, own):
            print(step - 1)
            return
        os.waitpid(_forked(own), 0)


def _killed_at(step, own):
    """Whether the bake of a forked process came as far as `step`."""

    def arm():
        left = [step]

        def hook(event, arguments):
            if event in ("open", "os.rename", "os.remove", "os.mkdir", "os.rmdir", "flushed"):
                left[0] -= 1
                if left[0] == 0:
                    os.kill(os.getpid(), signal.SIGKILL)

        flush = os.fsync
        os.fsync = lambda handle: (sys.audit("flushed"), flush(handle), sys.audit("flushed"))
        sys.addaudithook(hook)

    _, status = os.waitpid(_forked(own, arm), 0)
    return os.WIFSIGNALED(status)


def _forked(own, before=lambda: None):
    pid = os.fork()
    if pid == 0:
        code = 1
        try:
            before()
            run_tasks(tasks(2), BUNDLES, Store(own), workers=Inline())
            code = 0
        finally:
            os._exit(code)
    return pid


def main(folder, count, seconds, workers):
    print("begun", flush=True)
    report = run_tasks(
        tasks(int(count), float(seconds)),
        BUNDLES,
        Store(Path(folder)),
        workers=LocalWorkers(int(workers)),
    )
    print(report, flush=True)


if __name__ == "__main__":
    # Under its own name, by which workers know it.
    import works_for_tasks

    if sys.argv[1] == "everywhere":
        works_for_tasks.killed_everywhere(Path(sys.argv[2]))
    else:
        works_for_tasks.main(*sys.argv[1:])
