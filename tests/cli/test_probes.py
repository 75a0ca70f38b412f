"""`andon probes info` and `andon probes export`."""

import json

import numpy as np
import pytest

from andon.files import write_volume
from volume_files import flat_volume, two_rooms

from .command import run_andon, run_refused


@pytest.fixture
def folder(tmp_path, monkeypatch):
    write_volume(tmp_path / "two.glb", two_rooms())
    write_volume(tmp_path / "point.glb", flat_volume("point"))
    write_volume(tmp_path / "cells.glb", flat_volume("cells"))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_info_says_what_the_volume_holds(capfd, folder):
    outcome = run_andon(capfd, "probes", "info", "two.glb")
    assert outcome.code == 0, outcome.err
    text = " ".join(outcome.out.split())
    volume = two_rooms()
    mean = volume.states["day"][:, 0].mean(axis=0) / np.sqrt(4 * np.pi)
    photometric = mean @ [0.2126, 0.7152, 0.0722]
    for part in (
        "photometry absolute", "probes 10: 1 sky, 1 bounce, 1 bleeding, 7 general",
        "(0, -1, -1) … (6, 1.1, 0) m", "L2, 9 coefficients a channel", "1 probe, 3…3 m",
        f"day: mean {photometric:.4g} cd/m² (R {mean[0]:.4g},",
        "east: 5 probes, 2 tetrahedra, 6 facets, 2 boxes", "4 tetrahedra, 12 facets",
        "4² directions a probe, up to 100 m", "light 2.16 kB", "scene: zwei Räume",
    ):  # fmt: skip
        assert part in text, part


def test_info_of_a_volume_without_cells(capfd, folder):
    text = " ".join(run_andon(capfd, "probes", "info", "cells.glb").out.split())
    assert "nobody joined the probes yet" in text
    assert "relative units" in text
    assert "cd/m²" not in text
    assert "1 probe, 0 tetrahedra, 1 facet, all of space" in " ".join(
        run_andon(capfd, "probes", "info", "point.glb").out.split()
    )


def test_info_as_json(capfd, folder):
    facts = json.loads(run_andon(capfd, "probes", "info", "two.glb", "--json").out)
    assert facts["probes"] == 10
    assert facts["roles"] == {"sky": 1, "bounce": 1, "bleeding": 1, "general": 7}
    assert [state["name"] for state in facts["states"]] == ["day", "night"]
    assert facts["zones"][1]["boxes_m"][1] == [[7, 0, 0], [8.1, 1, 1]]
    assert facts["bytes"]["light"] == 2 * 10 * 9 * 3 * 4
    assert facts["bytes"]["file"] == (folder / "two.glb").stat().st_size
    assert facts["distances"] == {"side_px": 4, "far_m": 100}


def test_info_refuses_what_is_no_volume(capfd, folder):
    (folder / "x.glb").write_bytes(b"glTF\x02\0\0\0")
    assert "x.glb: must be a sound GLB file" in run_refused(
        capfd, folder, "probes", "info", "x.glb"
    )
    assert "must exist" in run_refused(capfd, folder, "probes", "info", "none.glb")
