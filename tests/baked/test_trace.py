"""Light by rtrace: closed forms, the same bytes always, and every way in which it can fail."""

import os
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from andon.errors import InputError, MachineError
from andon.files import radiance_programs
from andon.lamps import PointLamp
from andon.transport.baked.radiance.quality import QUALITIES
from andon.transport.baked.radiance.trace import traced_illuminance
from baked.radiance_rooms import (
    CANDELA,
    UP,
    ball_lux,
    ball_points,
    ball_room,
    floor,
    sky,
)
from requirements import required

required("pyradiance")
DRAFT = QUALITIES["draft"]


@pytest.fixture(scope="module")
def ball(tmp_path_factory):
    return ball_room(tmp_path_factory.mktemp("ball") / "world")


def test_a_point_lamp_over_a_floor(tmp_path):
    """E = I·cos φ/d² exactly, at rtrace's own height of 0.1 mm."""
    folder = floor(tmp_path, [PointLamp("lamp", np.array([0.3, 1.0, 0.2]), CANDELA)])
    place = np.random.default_rng(0).uniform(-1.5, 1.5, (50, 3)) * [1, 0, 1]
    lux = traced_illuminance(folder, place, np.tile(UP, (50, 1)), quality=DRAFT, bounces=0)
    reach = np.array([0.3, 1.0, 0.2]) - place - 1e-4 * UP
    expected = (reach[:, 1] / np.linalg.norm(reach, axis=1) ** 3)[:, None] * CANDELA
    np.testing.assert_allclose(lux, expected, rtol=1e-5)
    assert lux.dtype == np.float32


@pytest.mark.parametrize("bounces", [0, 1, 2])
def test_an_integrating_sphere(ball, bounces):
    """All light, and what is reflected alone."""
    place, normal = ball_points(12)
    ask = {"quality": DRAFT, "bounces": bounces}
    lux = traced_illuminance(ball, place, normal, **ask)
    np.testing.assert_allclose(lux.mean(axis=0), ball_lux(bounces), rtol=0.02)
    reflected = traced_illuminance(ball, place, normal, part="bounce", **ask)
    np.testing.assert_allclose(reflected.mean(axis=0), ball_lux(bounces, first=1), rtol=0.03)
    direct = traced_illuminance(ball, place, normal, quality=DRAFT, bounces=0)
    np.testing.assert_allclose(lux, direct + reflected, rtol=1e-5)


@pytest.mark.parametrize("count", [12, 1500])
@pytest.mark.parametrize("quality", QUALITIES.values(), ids=lambda quality: quality.name)
def test_no_more_bounces_than_asked(ball, quality, count):
    """As Radiance's cache gives: a fifth of this light would come from a third and fourth one."""
    if quality.name == "fine" and count > 12:
        quality = replace(quality, share=0.05)  # of its points, for time
    ask = {"quality": quality, "bounces": 2, "part": "bounce"}
    reflected = traced_illuminance(ball, *ball_points(count), **ask)
    expected = ball_lux(2, first=1)
    np.testing.assert_allclose(reflected.mean(axis=0), expected, rtol=0.01)
    np.testing.assert_allclose(reflected, np.tile(expected, (count, 1)), rtol=0.1)


def test_a_sky_is_whole_at_its_first_bounce(tmp_path):
    """Rays of the hemisphere find it: nothing without, and nothing is reflected to a floor."""
    folder = floor(tmp_path, [sky(100.0)])
    place, normal = np.zeros((1, 3)), UP[None]
    ask = {"quality": DRAFT, "bounces": 2, "direct_bounces": 1}
    lux = traced_illuminance(folder, place, normal, **ask)
    np.testing.assert_allclose(lux, 100.0, rtol=1e-3)
    reflected = traced_illuminance(folder, place, normal, part="bounce", **ask)
    np.testing.assert_allclose(reflected, 0, atol=1e-3)


@pytest.mark.parametrize("count", [6, 1200])
def test_two_runs_and_other_folders_give_the_same_bytes(ball, tmp_path, count):
    """Smoothed and not; while others run beside."""
    place, normal = ball_points(count)
    copy = shutil.copytree(ball, tmp_path / "elsewhere")

    def ask(folder):
        return traced_illuminance(folder, place, normal, quality=DRAFT, bounces=2).tobytes()

    alone = ask(ball)
    with ThreadPoolExecutor(3) as pool:
        beside = list(pool.map(ask, [ball, copy, ball]))
    assert all(answer == alone for answer in beside)


def test_another_process_gives_the_same_bytes(ball):
    """Other environment, other clock, other process number."""
    script = (
        "import sys, numpy as np; from pathlib import Path\n"
        "from baked.radiance_rooms import ball_points\n"
        "from andon.transport.baked.radiance.quality import QUALITIES\n"
        "from andon.transport.baked.radiance.trace import traced_illuminance\n"
        "lux = traced_illuminance(Path(sys.argv[1]), *ball_points(6),\n"
        "    quality=QUALITIES['draft'], bounces=2, part='bounce')\n"
        "sys.stdout.buffer.write(lux.tobytes())"
    )
    environment = os.environ | {
        "PYTHONPATH": os.pathsep.join(sys.path),
        "RAYPATH": "/nowhere",
        "LC_ALL": "C",
    }
    other = subprocess.run(
        [sys.executable, "-c", script, str(ball)],
        env=environment, stdout=subprocess.PIPE, check=True,
    )  # fmt: skip
    ask = {"quality": DRAFT, "bounces": 2, "part": "bounce"}
    assert other.stdout == traced_illuminance(ball, *ball_points(6), **ask).tobytes()


def test_light_is_not_negative(ball):
    """What is left of a difference by rounding: none of it is, and the rest is the light."""
    ask = {"quality": DRAFT, "bounces": 0, "part": "bounce"}
    assert (traced_illuminance(ball, *ball_points(40), **ask) == 0).all()


def test_no_points_need_no_program(tmp_path, monkeypatch):
    monkeypatch.setattr(radiance_programs, "find_spec", lambda name: None)
    none = np.empty((0, 3))
    lux = traced_illuminance(tmp_path, none, none, quality=DRAFT, bounces=4)
    assert lux.shape == (0, 3)
    assert lux.dtype == np.float32


@pytest.mark.parametrize(
    ("place", "normal", "bounces", "field"),
    [
        (np.full((2, 3), np.nan), np.ones((2, 3)), 1, "position"),
        (np.full((2, 3), np.inf), np.ones((2, 3)), 1, "position"),
        (np.zeros((2, 2)), np.ones((2, 3)), 1, "position"),
        (np.zeros(3), np.ones(3), 1, "position"),
        (np.zeros((2, 3)), np.zeros((2, 3)), 1, "normal"),
        (np.zeros((2, 3)), np.full((2, 3), np.nan), 1, "normal"),
        (np.zeros((2, 3)), np.ones((3, 3)), 1, "normal"),
        (np.zeros((2, 3)), np.ones((2, 3)), -1, "bounces"),
    ],
)
def test_hostile_points(tmp_path, place, normal, bounces, field):
    with pytest.raises(InputError, match=field):
        traced_illuminance(tmp_path, place, normal, quality=DRAFT, bounces=bounces)


PROGRAMS = {
    "fails half-way": (
        "head -c 24 /dev/zero; echo 'rtrace: fatal - out of memory' >&2; exit 1",
        r"failed \(1\): rtrace: fatal - out of memory",
    ),
    "is killed": ("kill -9 $$", "killed by signal 9"),
    "has no room": ("echo 'No space left on device' >&2; exit 2", "No space left"),
    "answers too little": ("cat >/dev/null; head -c 24 /dev/zero", "24 bytes instead of 48"),
    "answers nothing": ("cat >/dev/null", "0 bytes instead of 48"),
    "answers too much": ("cat >/dev/null; head -c 72 /dev/zero", "72 bytes instead of 48"),
    "answers no numbers": (
        "cat >/dev/null; head -c 24 /dev/zero; head -c 24 /dev/zero | tr '\\000' '\\377'",
        "no finite numbers for 1 of 2",
    ),
    "never ends": ("exec sleep 30", r"more than 0\.3 s"),
    "does not read": ("exit 0", "0 bytes instead of 48"),
}


def _programs(folder, monkeypatch, text):
    """Has `rtrace` be a shell script."""
    (folder / "bin").mkdir(parents=True)
    program = folder / "bin" / "rtrace"
    program.write_text(text)
    program.chmod(0o755)
    monkeypatch.setattr(radiance_programs, "package_folder", lambda: folder)
    return program


def _ask(folder):
    return traced_illuminance(
        folder, np.zeros((2, 3)), np.ones((2, 3)),
        quality=DRAFT, bounces=1, time_limit_seconds=0.3,
    )  # fmt: skip


@pytest.mark.parametrize("how", PROGRAMS)
def test_a_program_that(how, tmp_path, monkeypatch):
    text, message = PROGRAMS[how]
    _programs(tmp_path / "fake", monkeypatch, f"#!/bin/sh\n{text}\n")
    with pytest.raises(MachineError, match=message):
        _ask(tmp_path)


def test_programs_that_are_not_there_or_cannot_run(tmp_path, monkeypatch):
    program = _programs(tmp_path / "fake", monkeypatch, "#!/no/such/shell\n")
    with pytest.raises(MachineError, match="cannot be started"):
        _ask(tmp_path)
    program.unlink()
    with pytest.raises(MachineError, match=r"rtrace is not in .*pip install 'andon\[radiance\]'"):
        _ask(tmp_path)
    monkeypatch.undo()
    monkeypatch.setattr(radiance_programs, "find_spec", lambda name: None)
    with pytest.raises(MachineError, match="programs are missing"):
        _ask(tmp_path)


def test_folders_without_a_scene(tmp_path):
    with pytest.raises(MachineError, match=r"failed \(\d\): .*scene\.oct"):
        _ask(tmp_path)
    with pytest.raises(MachineError, match="cannot be started"):
        _ask(tmp_path / "missing")
    (tmp_path / "scene.oct").write_bytes(b"no octree")
    with pytest.raises(MachineError, match="failed"):
        _ask(tmp_path)


def test_the_programs_find_files_of_their_folder_and_radiances_own(tmp_path):
    (tmp_path / "mine.cal").write_text("mine(x) : 2*x;")
    words = ["-f", "mine.cal", "-e", "$1=mine($1)"]
    here = radiance_programs.run_radiance("rcalc", words, b"21\n", 10.0, cwd=tmp_path)
    assert float(here) == 42
    own = ["-f", "rayinit.cal", "-e", "$1=PI"]
    found = radiance_programs.run_radiance("rcalc", own, b"0\n", 10.0, cwd=tmp_path)
    assert float(found) == pytest.approx(np.pi, rel=1e-4)
    assert Path.cwd() != tmp_path
