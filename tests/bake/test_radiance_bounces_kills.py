"""Bakes by Radiance that are killed, and what the command refuses."""

import signal
import subprocess

import pytest
from worlds_of_probes import bake_command, lamp_room, stopped

SCENE = """
[surface]
mesh = "room.glb"

[[lamp]]
kind = "point"
position = [0.5, 1.2, -0.7]
intensity_cd = 200.0

[probes]
volume = "probes.glb"
cube_size_px = 8
bounces = 2

[[probes.place]]
position = [0.3, 0.1, -0.4]

[[probes.place]]
position = [-0.6, -0.2, 0.5]

[[probes.place]]
position = [0.5, 0.6, 0.9]

[[probes.place]]
position = [0.1, -0.7, 0.2]
"""


def command(folder, *more):
    return bake_command(folder, "--bounces-by", "radiance", *more)


def killed(folder, how, *more):
    """Ends a bake by a signal while light is traced; returns its exit code."""
    kept = folder / "probes.glb.bake"

    def results():
        return len(list(kept.glob("*.probe"))) + len(list(kept.glob("traced/*.npy")))

    return stopped(command(folder, *more), how, results, max(results(), 4) + 1)


def test_kill_at_any_moment_gives_the_same_bytes(tmp_path):
    lamp_room(tmp_path)
    (tmp_path / "scene.toml").write_text(SCENE)
    assert killed(tmp_path, signal.SIGKILL) == -signal.SIGKILL
    assert killed(tmp_path, signal.SIGKILL, "--workers", "2") == -signal.SIGKILL
    assert killed(tmp_path, signal.SIGINT) == 130
    assert not (tmp_path / "probes.glb").exists()
    done = subprocess.run(command(tmp_path), check=True, capture_output=True, text=True)
    assert "kept from before" in done.stderr
    assert "2, by Radiance" in done.stderr
    resumed = (tmp_path / "probes.glb").read_bytes()
    (tmp_path / "probes.glb").unlink()
    subprocess.run(command(tmp_path, "--workers", "1"), check=True, capture_output=True)
    assert (tmp_path / "probes.glb").read_bytes() == resumed
    assert not (tmp_path / "probes.glb.bake").exists()


@pytest.mark.parametrize(
    ("more", "rule"),
    [
        (["--bounces-by", "photons"], "must be probes or radiance"),
        (["--workers", "0"], "--workers"),
        (["--workers", "1", "--scheduler", "tcp://x:1"], "exclude each other"),
        (["--tls-ca", "a.pem"], "belongs to --scheduler"),
    ],
)
def test_options_that_cannot_be_are_refused(tmp_path, more, rule):
    lamp_room(tmp_path)
    (tmp_path / "scene.toml").write_text(SCENE)
    done = subprocess.run(command(tmp_path, *more), capture_output=True, text=True)
    assert done.returncode == 2
    assert rule in done.stderr
