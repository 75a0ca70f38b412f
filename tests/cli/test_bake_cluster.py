"""`andon bake --scheduler`: processes of a cluster give what this machine gives, kills included."""

import os
import signal

import pytest

from andon.cli.bar import Bar
from map_scenes import artefacts, room_scene, write_room
from requirements import required

from .command import run_andon

required("pyradiance")
distributed = required("distributed")


@pytest.fixture
def folders(tmp_path):
    """Two folders with the same scene."""
    for name in ("here", "there"):
        (tmp_path / name).mkdir()
        write_room(tmp_path / name)
        (tmp_path / name / "room.toml").write_text(room_scene(tmp_path / name).to_toml())
    return tmp_path / "here", tmp_path / "there"


def test_a_cluster_whose_workers_are_killed_bakes_the_same_bytes(capfd, folders, monkeypatch):
    here, there = folders
    assert run_andon(capfd, "bake", here / "room.toml", "--workers", "1").code == 0
    killed = []

    def show(self, done, of, what, seconds_left=None):
        """In the middle of the bake all workers die at once; their nannies start others."""
        if done == 3 and not killed:
            killed.extend(nanny.pid for nanny in cluster.workers.values())
            for pid in killed:
                os.kill(pid, signal.SIGKILL)

    monkeypatch.setattr(Bar, "show", show)
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, protocol="tcp", host="127.0.0.1",
        dashboard_address=None, local_directory=str(there / "dask"),
    ) as cluster:  # fmt: skip
        words = ("bake", there / "room.toml", "--scheduler", cluster.scheduler_address)
        outcome = run_andon(capfd, *words)
        assert outcome.code == 0, outcome.err
        left = [path for path in (there / "dask").rglob("andon-inputs*") if path.is_dir()]
        assert left == []
    assert len(killed) == 2
    assert "by 2 workers" in outcome.err
    assert artefacts(there / "maps") == artefacts(here / "maps")
