"""Who walks in examples/basic is lit by its probes alone, the same on both engines."""

import shutil
import tomllib
from pathlib import Path

import numpy as np
import pytest

import andon
from andon.bake.to_file import bake_file
from andon.pipeline import Renderer

FOLDER = Path(__file__).parents[1] / "examples" / "basic"
# Beside the red, the green and the blue wall.
MOMENTS = (0.2, 3.4, 5.8)
CAMERA = {"width": 240, "height": 135, "hfov_degrees": 60.0}


@pytest.fixture(scope="module")
def place(gpu, tmp_path_factory):
    """A folder with the room and its baked probes; the tables of the walk, without lamps."""
    folder = tmp_path_factory.mktemp("basic")
    for name in ("room.glb", "walker.glb"):
        shutil.copy(FOLDER / name, folder)
    tables = tomllib.loads((FOLDER / "walk.toml").read_text(encoding="utf-8"))
    tables["probes"]["cube_size_px"] = 32
    bake_file(andon.scene_from_dict(tables, folder=folder), engine="gpu")
    # No lamp and no shadow edge: what is seen is the probes' light alone.
    return folder, tables | {"lamp": [], "capture": {"luminance_per_unit": 6000.0}}


def walking(place, mesh, animation):
    """Renderers of both engines for somebody who walks in the room."""
    folder, tables = place
    walker = tables["object"][0] | {"mesh": mesh, "animation": animation}
    camera = CAMERA | {"position": [0.6, 1.65, 5.4], "look_at": [-0.05, 1.0, 0.0]}
    tables = tables | {"object": [walker], "rig": {"camera": camera}}
    scene = andon.scene_from_dict(tables, folder=folder)
    return Renderer(scene, "gpu"), Renderer(scene, "reference")


def person(frame, renderer):
    """(H, W) bool: the one who walks."""
    info = renderer.prepared.surface.objects_table[-1]
    numbers = frame.surface.material_id
    return (numbers >= info.first_slot) & (numbers < info.first_slot + info.slots)


def assert_walks(renderers):
    colours = []
    for moment in MOMENTS:
        frames = [renderer.render(moment) for renderer in renderers]
        masks = [person(frame, renderers[0]) for frame in frames]
        depths = [np.nan_to_num(frame.surface.depth, nan=1e3) for frame in frames]
        # Two rasterisers may choose either side of an outline.
        same = (masks[0] == masks[1]) & (np.abs(depths[0] / depths[1] - 1) < 0.01)
        assert same.mean() > 0.99
        assert (masks[0] & same).sum() > 200
        codes = [frame.image.rgb.astype(int) for frame in frames]
        difference = np.abs(codes[0] - codes[1]).max(axis=-1)[same]
        assert (difference > 5).mean() <= 1e-3
        assert difference.mean() <= 0.5
        colours.append(frames[0].luminance.cd_m2[masks[0]].mean(axis=0))
    assert (np.array(colours) > 100).all(), "in the light of a bright day"
    share = np.array(colours) / np.sum(colours, axis=1, keepdims=True)
    assert share[0, 0] > share[2, 0] + 0.01, "redder beside the red wall than beside the blue one"
    assert share[2, 2] > share[0, 2] + 0.01


def test_the_mannequin(place):
    assert_walks(walking(place, "walker.glb", "walk"))


def test_cesium_man(place, data_dir):
    shutil.copy(data_dir / "gltf_models" / "CesiumMan.glb", place[0])
    assert_walks(walking(place, "CesiumMan.glb", "0"))
