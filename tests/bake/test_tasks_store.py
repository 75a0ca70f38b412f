"""What counts as done, what is thrown away, and who may write."""

import json
import os
import subprocess
import sys
import threading

import pytest
from works_for_tasks import BUNDLES, Inline, contents, tasks

from andon.bake.tasks import Store, run_tasks
from andon.bake.tasks.events import Events
from andon.bake.tasks.lock import holder, locked
from andon.errors import MachineError

KEYS = [each.key for each in tasks(3)]


@pytest.fixture
def store(tmp_path):
    folder = tmp_path / "maps"
    run_tasks(tasks(3), BUNDLES, Store(folder), workers=Inline())
    return Store(folder)


def test_only_contents_that_the_journal_vouches_for_count(store):
    good = contents(store.folder)
    store.path(KEYS[0]).write_bytes(b"other")
    store.path(KEYS[1]).write_bytes(store.path(KEYS[1]).read_bytes()[:-1])
    assert [store.get(key) is not None for key in KEYS] == [False, False, True]
    assert (store.found, store.damaged) == (1, 2)
    store.path(KEYS[2]).unlink()
    assert store.get(KEYS[2]) is None
    assert store.damaged == 2
    report = run_tasks(tasks(3), BUNDLES, Store(store.folder), workers=Inline())
    assert (report.computed, report.damaged) == (3, 2)
    assert contents(store.folder) == good


def test_without_the_journal_nothing_counts(store):
    (store.folder / "journal.jsonl").unlink()
    assert Store(store.folder).get(KEYS[0]) is None


@pytest.mark.parametrize(
    "junk",
    [b'{"event": "done", "ke', b"\xff\x00\n", b"[1, 2]\n", b"x" * 200_000 + b"\n", b"[" * 60_000],
)
def test_lines_that_are_no_events_harm_nobody(store, junk):
    with (store.folder / "journal.jsonl").open("ab") as stream:
        stream.write(junk)
    run_tasks(tasks(4), BUNDLES, Store(store.folder), workers=Inline())
    again = Store(store.folder)
    assert all(again.get(each.key) for each in tasks(4))


def test_events_are_read_as_they_come(tmp_path):
    writer, reader = Events(tmp_path / "journal"), Events(tmp_path / "journal")
    assert list(reader.news()) == []
    writer.add({"n": 1})
    writer.add({"n": 2, "reason": "first\nsecond \udcff"})
    assert [event["n"] for event in reader.news()] == [1, 2]
    with writer.path.open("ab") as stream:
        stream.write(b'{"n": 3')
    assert list(reader.news()) == []
    writer.add({"n": 4})
    assert [event["n"] for event in reader.news()] == [4]
    writer.path.unlink()
    assert list(reader.news()) == []
    writer.add({"n": 5})
    assert [event["n"] for event in reader.news()] == [5]


def test_others_are_removed_and_strangers_stay(store):
    names = ["my.exr", "notes.txt", f"{KEYS[1]}.png", f"{KEYS[1][:-1]}.exr"]
    for name in names:
        (store.folder / name).write_bytes(b"mine")
    assert store.remove_others(KEYS[:1]) == 2
    left = {path.name for path in store.folder.iterdir()}
    assert left == {*names, f"{KEYS[0]}.exr", "journal.jsonl", "plan.json"}
    store.clear()
    assert {path.name for path in store.folder.iterdir()} == set(names)
    assert Store(store.folder / "none").remove_others(()) == 0


def test_what_a_killed_bake_left_half_written_goes(store):
    before = contents(store.folder)
    for name in (f".{KEYS[0]}.0123456789ab.tmp.exr", ".plan.0123456789ab.tmp.json"):
        (store.folder / name).write_bytes(b"half")
    (store.folder / "inputs" / KEYS[0]).mkdir(parents=True)
    (store.folder / "inputs" / KEYS[0] / "half").write_bytes(b"half")
    with store.locked(), store.locked():
        pass
    assert contents(store.folder) == before
    assert not (store.folder / "inputs").exists()
    run_tasks(tasks(4), BUNDLES, store, workers=Inline())
    assert set(contents(store.folder)) == {*before, f"{tasks(4)[3].key}.exr"}


def test_one_process_at_a_time(tmp_path, store):
    code = (
        "import sys, time; from pathlib import Path; from andon.bake.tasks import Store\n"
        "with Store(Path(sys.argv[1])).locked(): print('held', flush=True); time.sleep(60)"
    )
    command = [sys.executable, "-c", code, str(store.folder)]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    with subprocess.Popen(command, stdout=subprocess.PIPE, env=environment) as process:
        assert process.stdout.readline() == b"held\n"
        assert holder(store.folder) == process.pid
        before = contents(store.folder)
        with pytest.raises(MachineError) as error:
            run_tasks(tasks(9), BUNDLES, store, workers=Inline())
        assert str(error.value) == (
            f"another bake of {store.folder} is running (pid {process.pid}); wait for it"
        )
        assert contents(store.folder) == before
        process.kill()
    assert holder(store.folder) is None
    run_tasks(tasks(3), BUNDLES, store, workers=Inline())
    assert not (store.folder / "lock").exists()


def test_who_asks_for_the_holder_holds_nobody_up(tmp_path):
    stop = threading.Event()

    def asks():
        while not stop.is_set():
            holder(tmp_path / "maps")

    thread = threading.Thread(target=asks)
    thread.start()
    try:
        for _ in range(200):
            with locked(tmp_path / "maps"):
                pass
    finally:
        stop.set()
        thread.join()


def test_the_journal_says_what_was_done(store):
    lines = [json.loads(line) for line in (store.folder / "journal.jsonl").open()]
    assert [line["event"] for line in lines] == ["begun", "done", "done", "done"]
    assert lines[0] | {"time": ""} == {
        "event": "begun", "tasks": 3, "kept": 0, "workers": 1, "time": "",
    }  # fmt: skip
    for key, line in zip(KEYS, lines[1:], strict=True):
        assert (line["key"], line["attempt"], line["worker"]) == (key, 1, "here")
        assert line["bytes"] == store.path(key).stat().st_size
        assert line["seconds"] >= 0
