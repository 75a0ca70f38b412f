"""Bakes of maps that are begun again: after changes, kills and faults."""

import errno
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from andon.bake.maps import bake_maps
from andon.bake.tasks import LocalWorkers, Store
from andon.errors import InputError, MachineError
from andon.files import atomic
from andon.files.illuminance_maps import read_manifest
from andon.transport.baked.radiance import trace
from map_scenes import CAMERAS, artefacts, bake, camera, room_scene, room_tables, write_room
from requirements import required
from worlds import ball, write_glb

required("pyradiance")


def lamps(**of_left):
    tables = room_tables()["lamp"]
    return [tables[0] | of_left, tables[1]]


def test_nothing_is_done_twice(tmp_path):
    first, done = bake(room_scene(tmp_path))
    before = artefacts(tmp_path / "maps")
    second, again = bake(room_scene(tmp_path))
    assert (len(done), again) == (6, [])
    assert (second.computed, second.kept, second.removed) == (0, 6, 0)
    assert artefacts(tmp_path / "maps") == before
    assert first.disk_bytes == second.disk_bytes


def test_a_moved_lamp_leaves_the_others_as_they_are(tmp_path):
    bake(room_scene(tmp_path))
    before = artefacts(tmp_path / "maps")
    report, done = bake(room_scene(tmp_path, lamp=lamps(position=[-1.0, 0.7, -0.7])))
    assert done == ["left, camera-1, 0 s", "left, camera-2, 0 s"]
    assert (report.kept, report.removed) == (4, 2)
    after = artefacts(tmp_path / "maps")
    kept = {name for name in before if name.endswith(".exr")} & set(after)
    assert len(kept) == 4
    assert all(before[name] == after[name] for name in kept)


def test_a_moved_body_changes_what_it_stands_in(tmp_path):
    shell = {"radius_m": 0.1, "transmittance": 0.5}
    direct = {"bounces": 0}
    bake(room_scene(tmp_path, lamp=lamps(shell=shell), baked=direct))
    moved = lamps(shell=shell, position=[-1.0, 0.7, -0.7])
    assert len(bake(room_scene(tmp_path, lamp=moved, baked=direct))[1]) == 4


def test_another_camera_adds_its_own_maps(tmp_path):
    bake(room_scene(tmp_path))
    third = camera((1.5, 1, 2), (0, 0, 0))
    _, done = bake(room_scene(tmp_path, baked={"camera": [*CAMERAS, third]}))
    assert done == ["geometry, camera-3, 0 s", "left, camera-3, 0 s", "right, camera-3, 0 s"]


def test_cameras_in_another_order_are_the_same_maps(tmp_path):
    bake(room_scene(tmp_path))
    assert bake(room_scene(tmp_path, baked={"camera": CAMERAS[::-1]}))[1] == []


def test_what_light_does_not_depend_on_changes_nothing(tmp_path):
    bake(room_scene(tmp_path))
    scene = room_scene(
        tmp_path,
        lamp=lamps(shadow_map_size=256, visible_radius_m=0.02),
        display={"exposure": 0.01},
        baked={"mode": "first_valid", "depth_tolerance_m": 0.1},
    )
    assert bake(scene)[1] == []


@pytest.mark.parametrize(
    ("baked", "count"),
    [({"bounces": 2}, 4), ({"quality": "normal"}, 4), ({"lamps": ["right", "left"]}, 0)],
)
def test_other_settings(tmp_path, baked, count):
    bake(room_scene(tmp_path))
    assert len(bake(room_scene(tmp_path, baked=baked))[1]) == count


def test_another_part_of_a_lamp_is_another_map(tmp_path):
    bake(room_scene(tmp_path))
    _, done = bake(room_scene(tmp_path, lamp=lamps(transport="direct+bounce")))
    assert done == ["left, camera-1, 0 s", "left, camera-2, 0 s"]


def test_a_thing_in_the_room_changes_all_light(tmp_path):
    bake(room_scene(tmp_path))
    write_glb(tmp_path / "ball.glb", ball(0.3, (0, 0, 0.5), 2))
    _, done = bake(room_scene(tmp_path, object=[{"name": "ball", "mesh": "ball.glb"}]))
    assert len(done) == 6


def test_an_included_thing_changes_light_and_no_geometry(tmp_path):
    bake(room_scene(tmp_path))
    (tmp_path / "desk.rad").write_text(
        "void plastic wood 0 0 5 .5 .5 .5 0 0\nwood sphere desk 0 0 4 0 0 0.5 0.3\n"
    )
    _, done = bake(room_scene(tmp_path, baked={"include": ["desk.rad"]}))
    assert len(done) == 4
    assert not any("geometry" in name for name in done)


def test_fresh_keeps_nothing(tmp_path):
    bake(room_scene(tmp_path))
    before = artefacts(tmp_path / "maps")
    _, done = bake(room_scene(tmp_path), fresh=True)
    assert len(done) == 6
    assert artefacts(tmp_path / "maps") == before, "and gives the same bytes"


def test_other_files_in_the_folder_stay(tmp_path):
    (tmp_path / "maps").mkdir()
    (tmp_path / "maps" / "notes.exr").write_bytes(b"mine")
    bake(room_scene(tmp_path))
    bake(room_scene(tmp_path, lamp=lamps(intensity_cd=1.0)), fresh=True)
    assert (tmp_path / "maps" / "notes.exr").read_bytes() == b"mine"


def test_a_damaged_map_is_made_again(tmp_path):
    bake(room_scene(tmp_path))
    before = artefacts(tmp_path / "maps")
    manifest = read_manifest(tmp_path / "maps")
    path = tmp_path / "maps" / manifest.light["left", 1, 0].name
    path.write_bytes(path.read_bytes()[:-7])
    report, done = bake(room_scene(tmp_path))
    assert done == ["left, camera-2, 0 s"]
    assert report.damaged == 1
    assert artefacts(tmp_path / "maps") == before


class _Broken:
    """`rtrace` that fails after some runs."""

    def __init__(self, monkeypatch, runs):
        self.left, self.real = runs, trace.run_radiance
        monkeypatch.setattr(trace, "run_radiance", self)

    def __call__(self, program, *rest, **options):
        self.left -= 1
        if self.left < 0:
            raise MachineError("Radiance's rtrace failed (1): out of memory")
        return self.real(program, *rest, **options)


def test_radiance_that_fails_half_way(tmp_path, monkeypatch):
    whole = tmp_path / "whole"
    whole.mkdir()
    bake(room_scene(whole))
    with monkeypatch.context() as patch:
        _Broken(patch, 2)
        with pytest.raises(MachineError, match=r"tasks failed 3 times: .*out of memory") as caught:
            bake(room_scene(tmp_path))
    assert "bake again" in str(caught.value)
    assert not (tmp_path / "maps" / "maps.json").exists()
    kept = len(list((tmp_path / "maps").glob("*.exr")))
    assert 2 <= kept < 6
    report, _ = bake(room_scene(tmp_path))
    assert (report.kept, report.computed) == (kept, 6 - kept)
    assert artefacts(tmp_path / "maps") == artefacts(whole / "maps")


def test_a_bake_that_fails_leaves_the_maps_before_it(tmp_path, monkeypatch):
    bake(room_scene(tmp_path))
    before = artefacts(tmp_path / "maps")
    with monkeypatch.context() as patch:
        _Broken(patch, 0)
        with pytest.raises(MachineError):
            bake(room_scene(tmp_path, lamp=lamps(intensity_cd=1.0)))
    after = artefacts(tmp_path / "maps")
    assert all(after[name] == data for name, data in before.items() if name != "plan.json")


def test_a_full_disk(tmp_path, monkeypatch):
    written = []

    def full(path):
        written.append(path)
        if len(written) > 4:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as patch:
        patch.setattr(atomic, "_flush_to_disk", full)
        with pytest.raises(MachineError, match="No space left"):
            bake(room_scene(tmp_path))
    assert not (tmp_path / "maps" / "maps.json").exists()
    report, _ = bake(room_scene(tmp_path))
    assert report.kept >= 1
    assert list(read_manifest(tmp_path / "maps").missing()) == []


def test_a_folder_that_cannot_be_written(tmp_path, monkeypatch):
    def refuse(*_, **__):
        raise OSError(errno.EROFS, os.strerror(errno.EROFS))

    monkeypatch.setattr(os, "open", refuse)
    scene = room_scene(tmp_path)
    with pytest.raises(MachineError, match=r"maps.*Read-only file system; choose a folder"):
        bake(scene)


def test_two_bakes_of_one_folder(tmp_path):
    scene = room_scene(tmp_path)
    with (
        Store(tmp_path / "maps").locked(),
        pytest.raises(
            MachineError, match=rf"another bake of .*maps is running \(pid {os.getpid()}"
        ),
    ):
        bake(scene)
    assert len(bake(scene)[1]) == 6


def test_what_radiance_cannot_be_told_names_the_scene(tmp_path, monkeypatch):
    from andon.bake.maps import jobs

    def refuse(*_, **__):
        raise InputError("must be 0…1", field="materials[0].reflectance")

    monkeypatch.setattr(jobs, "radiance_bundle", refuse)
    with pytest.raises(InputError, match=r"^scene: materials\[0\]\.reflectance: must be 0…1"):
        bake(room_scene(tmp_path))


DRIVER = """
import sys
sys.path.insert(0, {tests!r})
from pathlib import Path
from andon.bake.maps import bake_maps
from andon.bake.tasks import LocalWorkers
from map_scenes import room_scene
bake_maps(room_scene(Path({folder!r})), workers=LocalWorkers(1))
print("done")
"""


def driver(folder):
    tests = str(Path(__file__).parents[1])
    code = DRIVER.format(tests=tests, folder=str(folder))
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    return subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, text=True, env=environment
    )


@pytest.mark.parametrize("count", [0, 1, 3, 5])
def test_a_killed_bake_goes_on(tmp_path, count):
    """kill -9 once `count` maps are there; then the rest alone is done, to the same bytes."""
    whole, killed = tmp_path / "whole", tmp_path / "killed"
    for folder in (whole, killed):
        folder.mkdir()
        write_room(folder)
    bake(room_scene(whole))
    process = driver(killed)
    deadline = time.monotonic() + 120
    while (
        not (killed / "maps" / "plan.json").exists()
        or len(list((killed / "maps").glob("[0-9a-f]*.exr"))) < count
    ):
        assert time.monotonic() < deadline
        assert process.poll() is None, "killed before it is done"
        time.sleep(0.005)
    process.kill()
    process.wait()
    before = {
        path.name: path.stat().st_mtime_ns for path in (killed / "maps").glob("[0-9a-f]*.exr")
    }
    report = bake_maps(room_scene(killed), workers=LocalWorkers(1))
    assert report.kept >= count
    assert report.kept + report.computed == 6
    times = {path.name: path.stat().st_mtime_ns for path in (killed / "maps").glob("*.exr")}
    repeated = [name for name in before if times.get(name) != before[name]]
    assert repeated == []
    assert artefacts(killed / "maps") == artefacts(whole / "maps")
