"""The tatami room in examples/: its files fit together, and its shades are what shells want."""

import importlib.util
import shutil
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

import andon
from andon.bake.maps import bake_maps
from andon.files.cameras import read_camera
from andon.files.meshes import read_mesh
from andon.files.pictures import read_picture
from map_scenes import Here

ROOM = Path(__file__).resolve().parents[1] / "examples" / "tatami"


def edges(name):
    """How often each undirected edge of a sheet is used, and its facing."""
    geometry = read_mesh(ROOM / name).geometry
    sides = np.concatenate([geometry.triangles[:, [i, (i + 1) % 3]] for i in range(3)])
    corners = geometry.positions[geometry.triangles]
    facets = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    away = np.einsum("nj,nj->n", facets, corners.mean(1))
    return Counter(tuple(sorted(side)) for side in sides.tolist()), away


@pytest.mark.parametrize(
    ("name", "open_edges"),
    [("andon_shade.obj", 2 * 4 * 6), ("drum_shade.obj", 2 * 48), ("box_lantern.obj", 0)],
)
def test_shades_are_single_sheets_that_face_outwards(name, open_edges):
    uses, away = edges(name)
    assert set(uses.values()) <= {1, 2}
    assert sum(count == 1 for count in uses.values()) == open_edges
    assert (away > 0).all()


@pytest.mark.parametrize("name", ["figure3", "figure4", "figure4-lamp", "figure5", "andon"])
def test_scenes_load(name):
    scene = andon.load_scene(ROOM / f"{name}.toml")
    assert scene.lamp[0].shell is not None
    assert scene.photometry == "absolute"


def test_pictures_have_the_size_of_the_camera():
    photo, e0 = read_picture(ROOM / "photo.png"), read_picture(ROOM / "e0.exr")
    assert photo.shape == e0.shape == (720, 1280)
    assert read_camera(ROOM / "camera.toml", size=(1280, 720)).shape == (720, 1280)
    assert e0.values.min() > 0


def test_photograph_is_exposed():
    codes = read_picture(ROOM / "photo.png").values
    middle = np.median(codes)
    assert 60 < middle < 140
    # Only the paper of the shoji, in the left third, is at the end of the range.
    assert (codes[:, 430:].max(axis=-1) == 255).mean() < 1e-3


def test_room_is_closed_and_small():
    geometry = read_mesh(ROOM / "room.glb").geometry
    assert 10_000 < len(geometry.triangles) <= 30_000
    low, high = geometry.positions.min(0), geometry.positions.max(0)
    np.testing.assert_allclose(high - low, [3.7, 2.46, 4.75], atol=0.2)
    textured = [material for material in geometry.materials if material.texture is not None]
    assert len(textured) > 10


def test_the_ball_of_figure_3_has_the_light_that_its_file_states(gpu):
    """L = t·I/(π r²), and under the ball t·I/h² in lux."""
    frame = andon.render(andon.load_scene(ROOM / "figure3.toml"), engine="gpu")
    ball = frame.surface.body_id == 0
    assert 1000 < ball.sum() < 10_000
    luminance = andon.photometric(frame.bodies.cd_m2)[ball]
    np.testing.assert_allclose(luminance, 0.65 * 100 / (np.pi * 0.075**2), rtol=5e-3)
    position = frame.surface.position
    below = np.linalg.norm(position[..., [0, 2]] - [1.0, -0.02], axis=-1) < 0.05
    below &= np.abs(position[..., 1]) < 0.005
    assert below.sum() > 20
    lux = andon.photometric(frame.illuminance.lux)[below]
    np.testing.assert_allclose(np.median(lux), 0.65 * 100 / 0.42**2, rtol=0.03)


def program_of_figures():
    """figures.py as a module."""
    spec = importlib.util.spec_from_file_location("tatami_figures", ROOM / "figures.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


# What makes the bake of figure 4 quick here: a hundredth of the pixels, one bounce instead of four.
SMALL = {
    "width = 480": "width = 48",
    "height = 270": "height = 27",
    "height = 360": "height = 36",
    'quality = "normal"': 'quality = "draft"',
    "bounces = 4": "bounces = 1",
}


def test_figure_4(tmp_path, gpu, monkeypatch):
    """One bake is for both scenes; the andon lights more than it sees, the lamp adds I·cos φ/d²."""
    for path in ROOM.iterdir():
        if path.is_file() and path.suffix != ".toml":
            shutil.copy(path, tmp_path)
    shutil.copy(ROOM / "camera.toml", tmp_path)
    scenes = {}
    for name in ("figure4", "figure4-lamp"):
        text = (ROOM / f"{name}.toml").read_text(encoding="utf-8")
        for key, small in SMALL.items():
            assert key in text
            text = text.replace(key, small)
        (tmp_path / f"{name}.toml").write_text(text, encoding="utf-8")
        scenes[name] = andon.load_scene(tmp_path / f"{name}.toml")
    report = bake_maps(scenes["figure4"], workers=Here())
    assert report.plan.parts == {"andon": "all"}

    renderers = [andon.Renderer(scene, "gpu") for scene in scenes.values()]
    alone, lamp = (renderer.render() for renderer in renderers)
    direct = tuple(t.model_copy(update={"transport": "direct"}) for t in scenes["figure4"].lamp)
    plain = scenes["figure4"].model_copy(update={"lamp": direct, "baked": None})
    plain = andon.render(plain, engine="gpu")
    for renderer, frame in zip(renderers, (alone, lamp), strict=True):
        assert not [note for note in renderer.prepared.surface.notes if "changed since" in note]
        # Of maps as large as the example states it is 0.002.
        assert frame.report.uncovered_share < 0.05
    baked, seen = (andon.photometric(frame.illuminance.lux) for frame in (alone, plain))
    real = alone.baked.covered & (alone.surface.body_id < 0) & ~alone.surface.is_object
    lit = real & (seen > 10)
    assert np.median(baked[lit] / seen[lit]) > 1.1
    assert baked[real & (seen == 0)].mean() > 0.5
    added = andon.photometric(lamp.illuminance.lux) - baked
    position = lamp.surface.position
    below = np.linalg.norm(position[..., [0, 2]] - [1.0, -0.02], axis=-1) < 0.05
    below &= np.abs(position[..., 1]) < 0.005
    assert below.sum() > 20
    np.testing.assert_allclose(np.median(added[below]), 60 / 0.42**2, rtol=0.03)

    figures = program_of_figures()
    monkeypatch.setattr(figures, "HERE", tmp_path)
    frames = {"figure4.toml": alone, "figure4-lamp.toml": lamp}
    monkeypatch.setattr(figures, "drawn", lambda name, engine: frames[name])
    sheet = figures.figure4("gpu")
    assert sheet.shape[1] == 2 * 2 * 48 + figures.GAP_PX
    # The paper of the andon is beyond white in (a).
    assert sheet[: len(sheet) // 3, : 2 * 48].max() == 255
