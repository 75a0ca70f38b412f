"""What tasks do to each other, to what is done already, and what is said of them."""

import errno
import json
import os
from pathlib import Path

import pytest
from works_for_tasks import BUNDLE, BUNDLES, DIGEST, Inline, contents, logged, task, tasks

from andon.bake.tasks import Store, Task, bundle_digest, run_tasks
from andon.errors import InputError, MachineError


@pytest.fixture
def log(tmp_path, monkeypatch):
    path = tmp_path / "log"
    monkeypatch.setenv("TASKS_LOG", str(path))
    return lambda: [n for n, _ in logged(path)]


def test_artefacts_are_what_works_give(tmp_path, log):
    store = Store(tmp_path / "maps")
    report = run_tasks(tasks(3), BUNDLES, store, workers=Inline())
    found = [store.get(each.key).read_bytes() for each in tasks(3)]
    assert found == [b"light of lamps" * (n + 1) + b"%d" % n for n in range(3)]
    assert (report.planned, report.computed, report.kept, report.workers) == (3, 3, 0, 1)
    assert sorted(contents(store.folder)) == sorted(
        ["plan.json", *(f"{each.key}.exr" for each in tasks(3))]
    )


def test_tasks_of_one_key_are_done_once_and_finished_ones_never_again(tmp_path, log):
    store = Store(tmp_path / "maps")
    twice = [*tasks(3), *tasks(3)]
    report = run_tasks(twice, BUNDLES, store, workers=Inline())
    assert (report.planned, report.computed) == (3, 3)
    before, workers = contents(store.folder), Inline()
    report = run_tasks(tasks(3), BUNDLES, Store(store.folder), workers=workers)
    assert (report.computed, report.kept, report.workers, workers.starts) == (0, 3, 0, 0)
    report = run_tasks(tasks(5), {DIGEST: BUNDLES[DIGEST]}, Store(store.folder), workers=workers)
    assert (report.computed, report.kept) == (2, 3)
    assert log() == [0, 1, 2, 3, 4]
    after = contents(store.folder)
    assert {name: after[name] for name in before if name != "plan.json"} == {
        name: data for name, data in before.items() if name != "plan.json"
    }


def test_a_key_is_all_that_a_task_depends_on():
    first = task(1)
    assert first.key == Task("another name", first.work, first.inputs, first.settings).key
    others = [
        task(2),
        task(1, "fails"),
        Task("x", first.work, {"scene": bundle_digest({"seed.txt": b"dark"})}, first.settings),
        Task("x", first.work, first.inputs, first.settings, version=2),
    ]
    assert len({each.key for each in [first, *others]}) == 5
    assert bundle_digest({"a": b"1", "b": b"2"}) == bundle_digest({"b": b"2", "a": b"1"})
    assert bundle_digest({"a": b"1", "b": b"2"}) != bundle_digest({"a": b"2", "b": b"1"})


def test_a_task_that_fails_three_times_is_reported_and_the_rest_goes_on(tmp_path, log):
    store, seen = Store(tmp_path / "maps"), []
    planned = [task(7, "fails"), *tasks(3)]
    with pytest.raises(MachineError) as error:
        run_tasks(planned, BUNDLES, store, workers=Inline(), progress=seen.append)
    assert str(error.value) == (
        "1 of 4 tasks failed 3 times: task 7 (OSError: no light); 3 are kept in "
        f"{store.folder}: bake again, and only those that failed are done"
    )
    assert log() == [7, 0, 1, 2, 7, 7]
    assert [(each.done, each.name) for each in seen] == [
        (0, ""), (1, "task 0"), (2, "task 1"), (3, "task 2"), (4, "task 7"),
    ]  # fmt: skip
    with pytest.raises(MachineError, match="2 times: task 7"):
        run_tasks(planned, BUNDLES, store, workers=Inline(), attempts=2)
    assert log() == [7, 0, 1, 2, 7, 7, 7, 7]


def test_many_that_fail_are_not_all_named(tmp_path):
    planned = [task(n, "fails") for n in range(5)]
    with pytest.raises(MachineError, match=r"5 of 5 .* task 2 \(OSError: no light\), …; 0 are"):
        run_tasks(planned, BUNDLES, Store(tmp_path / "maps"), workers=Inline(2))


def test_a_task_may_fail_twice(tmp_path):
    store = Store(tmp_path / "maps")
    planned = [task(1, "fails_twice", marks=str(tmp_path / "marks"))]
    report = run_tasks(planned, BUNDLES, store, workers=Inline())
    assert (report.computed, report.retried) == (1, 2)
    assert store.get(planned[0].key).read_bytes() == b"at last"
    lines = [json.loads(line) for line in (store.folder / "journal.jsonl").open()]
    assert [line["event"] for line in lines] == ["begun", "failed", "failed", "done"]
    assert lines[-1]["attempt"] == 3


def test_input_at_fault_stops_at_once(tmp_path, log):
    planned = [task(1, "input_at_fault"), *tasks(3)]
    with pytest.raises(InputError) as error:
        run_tasks(planned, BUNDLES, Store(tmp_path / "maps"), workers=Inline())
    assert str(error.value) == "scene.toml: lamp.flux: must be > 0; make it so"
    assert (error.value.field, error.value.remedy) == ("lamp.flux", "make it so")
    assert log() == [1]


def test_our_own_faults_stop_at_once_and_say_where(tmp_path, log):
    planned = [task(0), task(1, "our_fault"), task(2)]
    with pytest.raises(KeyError, match="missing") as error:
        run_tasks(planned, BUNDLES, Store(tmp_path / "maps"), workers=Inline())
    assert any('return {}["missing"]' in note for note in error.value.__notes__)
    assert log() == [0, 1]
    with pytest.raises(TypeError, match="must give bytes, got str"):
        run_tasks([task(1, "no_bytes")], BUNDLES, Store(tmp_path / "maps"), workers=Inline())
    with pytest.raises(LookupError, match="task 0: no bundle"):
        run_tasks(tasks(1), {}, Store(tmp_path / "none"), workers=Inline())


def test_time_left_is_the_mean_of_what_was_done(tmp_path, log):
    store, seen = Store(tmp_path / "maps"), []
    run_tasks(tasks(2), BUNDLES, store, workers=Inline())
    run_tasks(tasks(6, 0.02), BUNDLES, store, workers=Inline(), progress=seen.append)
    assert [(each.done, each.of, each.kept) for each in seen] == [(n, 6, 0) for n in range(7)]
    run_tasks(tasks(9, 0.02), BUNDLES, store, workers=Inline(), progress=seen.append)
    assert [(each.done, each.of, each.kept) for each in seen[7:]] == [
        (6, 9, 6), (7, 9, 6), (8, 9, 6), (9, 9, 6),
    ]  # fmt: skip
    left = [each.seconds_left for each in seen]
    assert left[0] is left[7] is None
    assert left[6] == left[10] == 0.0
    assert 5 * 0.02 <= left[1] <= 5 * 0.2
    assert 1 * 0.02 <= left[5] <= 0.2
    # With more workers it is shared, but no less than one task takes.
    del seen[:]
    run_tasks(tasks(6, 0.01), BUNDLES, store, workers=Inline(4), progress=seen.append)
    assert seen[1].seconds_left >= 5 / 4 * 0.01
    assert seen[5].seconds_left >= 0.01


def test_an_interrupt_keeps_what_is_done(tmp_path, log):
    store = Store(tmp_path / "maps")

    def interrupted(progress):
        if progress.done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_tasks(tasks(4), BUNDLES, store, workers=Inline(), progress=interrupted)
    assert sorted(path.suffix for path in store.folder.iterdir()) == [
        ".exr", ".exr", ".json", ".jsonl",
    ]  # fmt: skip
    run_tasks(tasks(4), BUNDLES, store, workers=Inline())
    assert log() == [0, 1, 2, 3]


class Later(dict):
    """Bundles that are made when they are asked for; `made` are their numbers, as often."""

    def __init__(self, count):
        super().__init__(BUNDLES)
        self.made = []
        for n in range(count):
            files = {**BUNDLE, "number": b"%d" % n}
            self[bundle_digest(files)] = files

    def __getitem__(self, digest):
        files = super().__getitem__(digest)
        self.made.append(int(files.get("number", b"-1")))
        return files


@pytest.mark.parametrize("count", [1, 2])
def test_bundles_are_on_the_disk_while_tasks_read_them(tmp_path, log, count):
    """Three tasks for each of four bundles, one of which fails twice: no more than needed."""
    bundles, store, held = Later(4), Store(tmp_path / "maps"), []
    names = list(bundles)[1:]
    planned = [
        Task(f"{name[:6]} {n}", "works_for_tasks:work", {"scene": name, "again": name}, {"n": n})
        for name in names
        for n in range(3)
    ]
    marks = {"marks": str(tmp_path / "marks")}
    planned[1] = Task("again", "works_for_tasks:fails_twice", {"scene": names[0]}, marks)

    def look(progress):
        folder = store.folder / "inputs"
        held.append({path.name for path in folder.iterdir()} if folder.exists() else set())

    run_tasks(planned, bundles, store, workers=Inline(count), progress=look)
    assert bundles.made == [0, 1, 2, 3], "each once, when a task needs it"
    assert held[0] == set(), "none before the first task"
    # That of the task that comes again stays to the end; beside it those of tasks that are out.
    assert max(map(len, held)) <= 1 + count
    assert not held[-1] & set(names[1:3])
    assert not (store.folder / "inputs").exists()


def full(*_):
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


@pytest.mark.parametrize("place", ["artefact", "inputs", "journal"])
def test_a_full_disk_is_said_and_nothing_is_lost(tmp_path, monkeypatch, log, place):
    store = Store(tmp_path / "maps")
    run_tasks(tasks(2), BUNDLES, store, workers=Inline())
    write = Path.write_bytes

    def half(path, data):
        if (path.suffix == ".exr") if place == "artefact" else (place in path.parts):
            write(path, data[: len(data) // 2])
            full()
        return write(path, data)

    with monkeypatch.context() as patched:
        patched.setattr(Path, "write_bytes", half)
        if place == "journal":
            patched.setattr(os, "write", full)
        with pytest.raises(MachineError, match="No space left on device; free space") as error:
            run_tasks(tasks(4), BUNDLES, store, workers=Inline())
    assert error.value.exit_code == 3
    if place == "inputs":
        assert "these inputs need 0.0 MB" in str(error.value)
    assert not [path for path in store.folder.iterdir() if path.name.startswith((".", "inp"))]
    assert all(store.get(each.key) for each in tasks(2))
    report = run_tasks(tasks(4), BUNDLES, Store(store.folder), workers=Inline())
    assert (report.kept, report.computed, report.damaged) == (2, 2, 0)


def test_files_that_may_not_grow_are_as_a_full_disk(tmp_path, log):
    resource = pytest.importorskip("resource", reason="limits of POSIX")
    big = [task(100_000)]  # 1.4 MB
    store = Store(tmp_path / "maps")
    run_tasks(tasks(2), BUNDLES, store, workers=Inline())
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, before[1]))
    try:
        with pytest.raises(MachineError, match=r"cannot be written: File too large; free space"):
            run_tasks([*tasks(2), *big], BUNDLES, store, workers=Inline())
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    report = run_tasks([*tasks(2), *big], BUNDLES, store, workers=Inline())
    assert (report.kept, report.computed) == (2, 1)
    assert store.get(big[0].key).stat().st_size == 14 * 100_001 + 6


def test_a_folder_that_cannot_be_is_said(tmp_path, monkeypatch):
    (tmp_path / "maps").write_bytes(b"a file")
    with pytest.raises(MachineError, match="cannot be made"):
        run_tasks(tasks(1), BUNDLES, Store(tmp_path / "maps"), workers=Inline())
    assert (tmp_path / "maps").read_bytes() == b"a file"

    def refused(path, flags, *_):
        raise OSError(errno.EROFS, os.strerror(errno.EROFS))

    with monkeypatch.context() as patched:
        patched.setattr(os, "open", refused)
        with pytest.raises(MachineError, match=r"Read-only file system; choose a folder"):
            run_tasks(tasks(1), BUNDLES, Store(tmp_path / "other"), workers=Inline())
