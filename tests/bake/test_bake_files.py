"""What bakes of one volume do to each other, to its other states, and to what they find there."""

import os
import signal
import subprocess
import sys
import threading

import numpy as np
import pytest
from worlds_of_probes import lamp_room

import andon.bake.bake as bake_module
from andon.bake import bake_file
from andon.bake.journal import Journal
from andon.bake.runner import Runner
from andon.bake.tasks.lock import locked
from andon.errors import InputError, MachineError
from andon.files.volumes import read_volume
from worlds import block, write_glb


def no_captures(monkeypatch):
    def first_light(pictures, index):
        raise AssertionError("captured")

    monkeypatch.setattr(bake_module, "first_light", first_light)


HAND = {"place": [{"position": [0, 1, 0]}], "placement": {"kind": "hand"}}
MORE = {"placement": {"kind": "lattice", "counts": [2, 2, 2], "low": [-0.8] * 3,
                      "high": [0.8, 0.8, 0.7]}}  # fmt: skip
ZONE = {"name": "room", "low": [-9, -9, -9], "high": [9, 9, 9]}


@pytest.mark.parametrize(
    ("probes", "what"),
    [
        (HAND, "8 probes, not 1"),
        (MORE, "4 probes at other places, as 'lattice-0-0-1'"),
        ({"order": 3}, "it has order 2, not 3;"),
        ({"zone": [ZONE | {"high": [9, 9, 8]}]}, "it has other zones;"),
    ],
)
def test_other_probes_are_refused_before_the_bake(tmp_path, monkeypatch, probes, what):
    bake_file(lamp_room(tmp_path, probes={"state": "day", "zone": [ZONE]}), engine="reference")
    before = (tmp_path / "probes.glb").read_bytes()
    other = lamp_room(tmp_path, probes={"state": "night", "zone": [ZONE]} | probes)
    with monkeypatch.context() as patched:
        no_captures(patched)
        with pytest.raises(InputError) as error:
            bake_file(other, engine="reference")
    assert "its state 'day' would be lost" in str(error.value)
    assert "--replace" in str(error.value)
    assert what in str(error.value)
    assert (tmp_path / "probes.glb").read_bytes() == before
    assert not (tmp_path / "probes.glb.bake").exists()
    written = bake_file(other, engine="reference", replaces=True)
    assert written.states == ("night",)
    assert any(part in what for part in written.replaced)


def test_the_only_state_may_get_other_probes(tmp_path):
    bake_file(lamp_room(tmp_path), engine="reference")
    assert bake_file(lamp_room(tmp_path), engine="reference").replaced == ()
    written = bake_file(lamp_room(tmp_path, probes={"order": 1}), engine="reference")
    assert written.replaced == ("order 2, not 1",)


@pytest.mark.parametrize("damaged", [True, False])
def test_what_is_no_volume_is_found_first_and_kept(tmp_path, monkeypatch, damaged):
    no_captures(monkeypatch)
    room = lamp_room(tmp_path)
    target = tmp_path / "probes.glb"
    if damaged:
        target.write_bytes((tmp_path / "room.glb").read_bytes()[:99])
    else:
        write_glb(target, block((1, 1, 1), (0, 0, 0)))
    before = target.read_bytes()
    with pytest.raises(InputError, match=r"probes\.glb.*move this file away"):
        bake_file(room, engine="reference")
    assert target.read_bytes() == before
    assert not (tmp_path / "probes.glb.bake").exists()


def test_nothing_stays_of_a_bake_that_was_refused(tmp_path):
    zone = {"name": "empty", "low": [50, 50, 50], "high": [51, 51, 51]}
    with pytest.raises(InputError, match="empty"):
        bake_file(lamp_room(tmp_path, probes={"zone": [ZONE, zone]}), engine="reference")
    dark = {"lit_by_probes": False, "mesh": "none.glb"}
    with pytest.raises(InputError, match=r"none\.glb"):
        bake_file(lamp_room(tmp_path, object=[dark]), engine="reference")
    lone = [{"position": [0, 1, 0], "panorama": "none.hdr"}]
    with pytest.raises(InputError, match=r"none\.hdr"):
        bake_file(lamp_room(tmp_path, probes={"place": lone}), engine="reference")
    assert not (tmp_path / "probes.glb.bake").exists()


def test_two_bakes_of_one_volume(tmp_path, monkeypatch):
    """The second is refused at once, and takes nothing from the first, --fresh or not."""
    genuine = bake_module.first_light
    started, go_on = threading.Event(), threading.Event()

    def first_light(pictures, index):
        if index == 3:
            started.set()
            assert go_on.wait(60)
        return genuine(pictures, index)

    monkeypatch.setattr(bake_module, "first_light", first_light)
    first = lamp_room(tmp_path, probes={"state": "day"})
    written = []
    thread = threading.Thread(target=lambda: written.append(bake_file(first, engine="reference")))
    thread.start()
    try:
        assert started.wait(60)
        second = lamp_room(tmp_path, probes={"state": "night"})
        message = rf"another bake of this volume is running \(pid {os.getpid()}\)"
        for fresh in (False, True):
            with pytest.raises(MachineError, match=message):
                bake_file(second, engine="reference", fresh=fresh)
        assert len(list((tmp_path / "probes.glb.bake").glob("*.probe"))) == 3
    finally:
        go_on.set()
        thread.join(60)
    assert written[0].report.captured == 8
    assert bake_file(second, engine="reference").states == ("day", "night")
    assert list(read_volume(tmp_path / "probes.glb").states) == ["day", "night"]
    assert not (tmp_path / "probes.glb.bake").exists()


def test_a_killed_bake_holds_nobody_up(tmp_path):
    code = (
        "import sys, time; from pathlib import Path; from andon.bake.tasks.lock import locked\n"
        "with locked(Path(sys.argv[1])): print('held', flush=True); time.sleep(60)"
    )
    folder = tmp_path / "kept"
    with subprocess.Popen(
        [sys.executable, "-c", code, str(folder)], stdout=subprocess.PIPE, env=os.environ
    ) as process:
        assert process.stdout.readline() == b"held\n"
        with pytest.raises(MachineError, match=rf"pid {process.pid}\)"), locked(folder):
            raise AssertionError("held by both")
        process.send_signal(signal.SIGKILL)
    assert (folder / "lock").exists()
    with locked(folder):
        (folder / "a.probe").write_bytes(b"")
    assert [path.name for path in folder.iterdir()] == ["a.probe"]


def test_results_that_somebody_removes_are_gone(tmp_path):
    Journal(tmp_path / "none").clear()
    journal = Journal(tmp_path / "kept")
    journal.put("a", {"x": np.zeros(1)})
    journal.clear()
    assert list((tmp_path / "kept").iterdir()) == []


def test_faults_of_ours_are_not_tried_again():
    calls = []

    def work(index):
        calls.append(index)
        raise KeyError("ours") if index == 1 else OSError("disk")

    runner = Runner(Journal(None), ["a", "b"], None)
    with pytest.raises(MachineError, match="1 of 1 probes failed 3 times: a") as error:
        runner.each("x", [0], str, work)
    assert isinstance(error.value.__cause__, OSError)
    with pytest.raises(KeyError, match="ours"):
        runner.each("x", [1], str, work)
    assert calls == [0, 0, 0, 1]
