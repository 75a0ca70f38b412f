"""`andon bake`: maps, status, and what it refuses."""

import io
import json
import os
import stat

import pytest

from andon.bake.maps import bake_maps, drive
from andon.bake.tasks import Store
from andon.cli.bake import size
from andon.cli.bar import Bar
from andon.cli.durations import duration
from andon.files.illuminance_maps import read_manifest
from andon.files.radiance_programs import package_folder
from map_scenes import Here, artefacts, room_scene, room_tables, write_room
from requirements import required

from .command import run_andon, run_refused

required("pyradiance")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    write_room(tmp_path)
    (tmp_path / "room.toml").write_text(room_scene(tmp_path).to_toml())
    monkeypatch.chdir(tmp_path)
    return tmp_path


def words_of(text):
    return " ".join(text.split())


def test_a_bake_from_start_to_end(capfd, folder):
    planned = run_andon(capfd, "bake", "room.toml", "--dry-run", "--workers", "2")
    assert planned.code == 0
    for part in (
        "2 stated; 48×36 px, 100% of the pixels show a surface", "1: nothing moves",
        "left (all light), right (reflected light)", "draft, 1 bounce; errors",
        "4 of light, 6912 points", "with 2 workers, if nothing is kept",
    ):  # fmt: skip
        assert part in words_of(planned.err), part
    assert not (folder / "maps").exists()
    assert "no bake has begun" in run_andon(capfd, "bake", "status", "room.toml").out

    baked = run_andon(capfd, "bake", "room.toml", "--workers", "1")
    assert baked.code == 0, baked.err
    assert baked.out.strip() == str(folder / "maps")
    assert "tasks 6 done" in words_of(baked.err)
    assert f"andon bake show {folder / 'maps'}" in baked.err
    assert list(read_manifest(folder / "maps").missing()) == []

    for place in ("room.toml", "maps"):
        status = run_andon(capfd, "bake", "status", place)
        assert status.code == 0
        assert "maps: done" in status.out
        assert "6 of 6 done, 0 left" in status.out

    before = artefacts(folder / "maps")
    again = run_andon(capfd, "bake", "maps", "room.toml")
    assert "tasks 0 done, 6 kept from before" in words_of(again.err)
    assert artefacts(folder / "maps") == before

    shown = run_andon(capfd, "bake", "show", "maps", "-o", "maps.png")
    assert shown.code == 0, shown.err
    assert (folder / "maps.png").stat().st_size > 1000


def test_what_maps_have_otherwise_than_frames_is_said_once(capfd, folder):
    lamps = room_tables()["lamp"]
    sky = {"name": "sky", "kind": "sky", "illuminance_lux": 50.0}
    baked = {"lamps": ["left", "sky"], "bounces": 0}
    lamps = [lamps[0] | {"shadow": False}, sky | {"transport": "baked"}]
    scene = room_scene(folder, lamp=lamps, baked=baked)
    (folder / "sky.toml").write_text(scene.to_toml())
    for words in (["--dry-run"], ["--workers", "1"]):
        outcome = run_andon(capfd, "bake", "sky.toml", *words)
        assert outcome.code == 0, outcome.err
        said = words_of(outcome.err)
        assert said.count("left: casts no shadow in frames, but does in its maps") == 1
        assert said.count("sky: surfaces hide this sky in its maps") == 1


@pytest.mark.parametrize(
    "sky",
    [
        {"kind": "sky", "illuminance_lux": 50.0},
        {"kind": "hemisphere", "illuminance_lux": 50.0, "ground_illuminance_lux": 5.0},
    ],
)
def test_what_is_reflected_of_a_sky_alone_is_refused(capfd, folder, sky):
    lamp = sky | {"name": "outside", "transport": "direct+bounce"}
    scene = room_scene(folder, lamp=[lamp], baked={"lamps": ["outside"]})
    (folder / "sky.toml").write_text(scene.to_toml())
    line = run_refused(capfd, folder, "bake", "sky.toml", "--dry-run")
    assert f"lamp[0].transport: the {sky['kind']} 'outside' has no shadow in frames" in line
    assert 'state transport = "baked"' in line


def test_the_bar_has_the_time_left(monkeypatch):
    from rich.console import Console

    stream = io.StringIO()
    terminal = Console(file=stream, force_terminal=True, width=120)
    monkeypatch.setattr("rich.console.Console", lambda **_: terminal)
    with Bar("looking") as bar:
        bar.show(1, 4, "left, camera-1", 200.0)
    assert "left, camera-1" in stream.getvalue()
    assert "3 min 20 s left" in stream.getvalue()


def test_a_bake_tells_how_long_it_takes_and_status_too(capfd, folder):
    seen = []
    bake_maps(
        room_scene(folder),
        workers=Here(),
        progress=lambda done, of, what, left: seen.append(
            (done, of, left, run_andon(capfd, "bake", "status", "maps").out)
        ),
    )
    done, of, left, status = seen[-2]
    assert (done, of) == (5, 6)
    assert left > 0
    assert "left     about" in status
    assert "finished right, camera-1, 0 s" in status
    assert seen[-1][2] == 0.0
    assert seen[0][2] is None


def test_quality_is_that_of_the_command(capfd, folder):
    planned = run_andon(capfd, "bake", "room.toml", "--dry-run", "--quality", "fine")
    assert "fine, 1 bounce" in words_of(planned.err)


def test_help_tells_errors_and_times_of_the_qualities(capfd, monkeypatch):
    from andon.transport.baked.radiance.quality import QUALITIES

    monkeypatch.setenv("COLUMNS", "200")
    text = words_of(run_andon(capfd, "bake", "maps", "--help").out)
    assert "QUALITIES" not in text
    for name, quality in QUALITIES.items():
        assert f"{name}: errors {quality.median_error:.1%} median, {quality.p95_error:.1%}" in text
        assert f"{quality.seconds_per_100k_points:g} s" in text
    group = run_andon(capfd, "bake", "--help").out
    assert all(name in group for name in ("status", "cameras", "show"))


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["room.toml", "--quality", "best"], "--quality: must be draft, normal or fine"),
        (["room.toml", "--tls-ca", "a.pem"], "belongs to --scheduler"),
        (["room.toml", "--scheduler", "tcp://h:1", "--workers", "2"], "exclude each other; keep"),
        (["room.toml", "--scheduler", "tls://h:1", "--tls-ca", "a.pem"], "belong together"),
        (["none.toml"], "none.toml"),
        (["plain.toml"], "plain.toml: baked: is missing: nothing says what to bake; add [baked]"),
        (["status", "plain.toml"], "needs a [baked] table"),
        (["staus"], "there is no command 'staus' and no scene file of that name; perhaps andon ba"),
    ],
)
def test_what_is_refused(capfd, folder, words, message):
    (folder / "plain.toml").write_text('[surface]\nmesh = "room.glb"\n')
    assert message in run_refused(capfd, folder, "bake", *words)


def test_included_programs_need_trust(capfd, folder):
    (folder / "desk.rad").write_text("!genbox wood desk 1 1 1\n")
    scene = room_scene(folder, baked={"include": ["desk.rad"]})
    (folder / "desk.toml").write_text(scene.to_toml())
    assert "--trust" in run_refused(capfd, folder, "bake", "desk.toml")


def test_interrupted(capfd, folder, monkeypatch):
    def stop(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(drive, "run_tasks", stop)
    outcome = run_andon(capfd, "bake", "room.toml")
    assert outcome.code == 130
    assert outcome.err.strip() == "andon: interrupted; run it again and it goes on"


def test_another_bake_is_running(capfd, folder):
    with Store(folder / "maps").locked():
        line = run_refused(capfd, folder, "bake", "room.toml", code=3)
        status = run_andon(capfd, "bake", "status", "room.toml")
    assert f"is running (pid {os.getpid()})" in line
    assert status.code == 0


RTRACE = """#!/bin/sh
count=$(cat {counter} 2>/dev/null || echo 0)
echo $((count + 1)) > {counter}
if [ "$count" -ge {runs} ]; then echo "rtrace: out of memory" >&2; exit 1; fi
exec {real} "$@"
"""


def broken_radiance(folder, runs):
    """A folder with a `pyradiance` whose `rtrace` fails after some runs."""
    real, package = package_folder(), folder / "programs" / "pyradiance"
    (package / "bin").mkdir(parents=True)
    (package / "__init__.py").write_text("")
    (package / "lib").symlink_to(real / "lib")
    for program in (real / "bin").iterdir():
        if program.name != "rtrace":
            (package / "bin" / program.name).symlink_to(program)
    script = package / "bin" / "rtrace"
    text = RTRACE.format(counter=folder / "count", runs=runs, real=real / "bin" / "rtrace")
    script.write_text(text)
    script.chmod(script.stat().st_mode | stat.S_IXUSR)
    return package.parent


def test_radiance_that_fails_half_way(capfd, folder, monkeypatch):
    with monkeypatch.context() as patch:
        patch.syspath_prepend(str(broken_radiance(folder, 3)))
        outcome = run_andon(capfd, "bake", "room.toml", "--workers", "1")
    assert outcome.code == 3
    assert "failed 3 times" in outcome.err
    assert "out of memory" in outcome.err
    assert "Traceback" not in outcome.err
    status = run_andon(capfd, "bake", "status", "room.toml").out
    assert "stopped; run it again and it goes on" in status
    assert "failed   " in status
    again = run_andon(capfd, "bake", "room.toml", "--workers", "1")
    assert again.code == 0, again.err
    assert "kept from before" in again.err
    assert "maps: done" in run_andon(capfd, "bake", "status", "maps").out


def test_frames_of_a_baked_scene(capfd, folder):
    """What a bake leaves is what frames take: the relit room has light of lamps that are baked."""
    run_andon(capfd, "bake", "room.toml", "--workers", "1")
    view = "\n[rig.camera]\nwidth = 48\nheight = 36\nhfov_degrees = 90\nposition = [0, 0.5, 2]\n"
    white = "look_at = [0, -0.5, 0]\n[capture]\nluminance_per_unit = 50.0\n"
    text = (folder / "room.toml").read_text() + view + white
    (folder / "seen.toml").write_text(text)
    outcome = run_andon(
        capfd, "relight", "--scene", "seen.toml", "-o", "a.png", "--illuminance-map", "a.exr",
        "--engine", "reference",
    )  # fmt: skip
    assert outcome.code == 0, outcome.err
    assert "changed since" not in outcome.err
    from andon.files.pictures import read_picture

    lux = read_picture(folder / "a.exr").values
    assert float(lux.mean()) > 20


@pytest.mark.parametrize(
    ("seconds", "words"),
    [(0.041, "0.041 s"), (4.24, "4.2 s"), (59.4, "59 s"), (200, "3 min 20 s"), (7500, "2 h 5 min")],
)
def test_durations_as_people_say_them(seconds, words):
    assert duration(seconds) == words


def test_sizes():
    assert (size(2048), size(3 * 2**20)) == ("2 KiB", "3.0 MiB")


def test_status_of_a_folder_that_is_no_bake_s(capfd, folder):
    (folder / "maps").mkdir()
    (folder / "maps" / "plan.json").write_text(json.dumps({"kind": "other"}))
    line = run_refused(capfd, folder, "bake", "status", "maps")
    assert "is no plan of a bake" in line
    assert room_tables()["baked"]["folder"] == "maps"
