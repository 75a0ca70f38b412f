"""The street in examples/: its three lamps are sources of glare, its windows are none."""

import filecmp
import runpy
import sys
from pathlib import Path

import numpy as np

import andon
from andon.glare.sources.find import find_sources

ROOT = Path(__file__).resolve().parents[1]
STREET = ROOT / "examples" / "street"


def test_lamps_are_sources():
    scene = andon.load_scene(STREET / "street.toml")
    camera = scene.rig.camera.model_copy(update={"width": 90, "height": 120})
    update = {"rig": scene.rig.model_copy(update={"camera": camera}), "glare": None}
    frame = andon.render(scene.model_copy(update=update), engine="reference")
    view = frame.captured.view
    found = find_sources(frame.luminance.cd_m2.astype(float), view)
    lit = [source for source in found.sources if source.illuminance_lux.mean() > 0.1]
    lamps = [lamp for lamp in scene.lamp if lamp.kind == "sphere"]
    assert len(lit) == len(lamps) == 3
    towards = np.array([lamp.position for lamp in lamps]) - camera.position
    towards = towards / np.linalg.norm(towards, axis=1, keepdims=True)
    seen = [view.world_from_camera[:3, :3] @ source.direction for source in lit]
    nearest = np.degrees(np.arccos((np.array(seen) @ towards.T).clip(-1, 1)))
    assert sorted(nearest.argmin(axis=1).tolist()) == [0, 1, 2]
    assert nearest.min(axis=1).max() < 0.4


def test_mesh_is_what_the_tool_makes(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    monkeypatch.setattr(sys, "argv", ["make_street.py", str(tmp_path)])
    runpy.run_path(str(ROOT / "tools" / "make_street.py"), run_name="__main__")
    assert filecmp.cmp(tmp_path / "street.glb", STREET / "street.glb", shallow=False)
