"""How far a bake is, from its folder alone."""

import json
from datetime import UTC, datetime

import pytest
from works_for_tasks import BUNDLES, Inline, task, tasks

from andon.bake.tasks import Store, run_tasks, tasks_status
from andon.errors import InputError, MachineError


@pytest.fixture
def store(tmp_path):
    return Store(tmp_path / "maps", ".map")


def test_nothing_is_known_of_what_has_not_begun(tmp_path):
    assert tasks_status(tmp_path / "none") is None
    assert tasks_status(tmp_path) is None


def test_while_it_runs_and_when_it_is_done(store):
    seen = []

    def look(progress):
        seen.append(tasks_status(store.folder))

    before = datetime.now(UTC)
    run_tasks(tasks(4, 0.02), BUNDLES, store, workers=Inline(), progress=look)
    assert [each.done for each in seen] == [0, 1, 2, 3, 4]
    assert {(each.planned, each.running, each.failed) for each in seen} == {(4, True, ())}
    assert seen[0].seconds_left is None
    assert 3 * 0.02 <= seen[1].seconds_left <= 3 * 0.2
    assert seen[4].seconds_left == 0.0
    assert [each.last_done for each in seen] == ["", "task 0", "task 1", "task 2", "task 3"]
    after = tasks_status(store.folder)
    assert (after.done, after.running, after.pid, after.seconds_left) == (4, False, 0, None)
    assert after.bytes == sum(14 * (n + 1) + 1 for n in range(4))
    assert 4 * 0.02 <= after.seconds <= 4 * 0.2
    assert before.timestamp() - 0.001 <= after.begun.timestamp() <= after.last.timestamp()


def test_failed_tasks_are_those_of_the_last_bake(store):
    planned = [task(1, "fails"), *tasks(2)]
    with pytest.raises(MachineError):
        run_tasks(planned, BUNDLES, store, workers=Inline())
    status = tasks_status(store.folder)
    assert (status.planned, status.done) == (3, 2)
    assert [(each.name, each.reason) for each in status.failed] == [("task 1", "OSError: no light")]
    run_tasks(tasks(3), BUNDLES, store, workers=Inline())
    status = tasks_status(store.folder)
    assert (status.planned, status.done, status.failed) == (3, 3, ())


def test_files_that_went_or_were_cut_are_not_done(store):
    run_tasks(tasks(3), BUNDLES, store, workers=Inline())
    paths = [store.path(each.key) for each in tasks(3)]
    paths[0].unlink()
    paths[1].write_bytes(paths[1].read_bytes()[:-1])
    status = tasks_status(store.folder)
    assert (status.planned, status.done, status.bytes) == (3, 1, paths[2].stat().st_size)


@pytest.mark.parametrize(
    "junk",
    [
        b"", b"[]", b"{", b'{"kind": "andon tasks 2"}', b'{"kind": "andon tasks 1"}', b"\xff",
        b"[" * 100_000, b'{"kind": "andon tasks 1", "suffix": ".exr", "tasks": [1]}',
        b'{"kind": "andon tasks 1", "suffix": ".exr", "tasks": {"a": 1}}',
    ],
)  # fmt: skip
def test_plans_that_are_none_are_refused(store, junk):
    run_tasks(tasks(1), BUNDLES, store, workers=Inline())
    (store.folder / "plan.json").write_bytes(junk)
    with pytest.raises(InputError, match=r"plan\.json: is no plan of a bake; bake again"):
        tasks_status(store.folder)


def test_events_of_strangers_harm_nobody(store):
    run_tasks(tasks(2), BUNDLES, store, workers=Inline())
    with (store.folder / "journal.jsonl").open("a") as stream:
        for event in (
            {"event": "begun", "workers": "many", "time": "never"},
            {"event": "begun", "workers": 0, "time": 3},
            {"event": "given up", "key": ["a"]},
            {"event": "done"},
            {"event": "done", "key": tasks(2)[0].key, "bytes": "all", "seconds": "long"},
        ):
            stream.write(json.dumps(event) + "\n")
    status = tasks_status(store.folder)
    assert (status.planned, status.done, status.failed) == (2, 1, ())
