"""`andon bake cameras`: the table, the tables to paste, the plan."""

import tomllib

import numpy as np
import pytest
import typer
from typer.testing import CliRunner

from andon.bake.maps import plan_maps
from andon.cli.bake_cameras import camera_tables, cameras
from andon.errors import InputError
from andon.files.pictures import read_picture
from andon.quantities import merged
from andon.scene import load_scene
from andon.scene.camera import Camera
from andon.scene.dump import toml_text
from andon.spaces import View, look_at, pinhole_view
from andon.transport.baked.placement import suggested_views
from worlds import block, write_obj

SCENE = """
[rig.camera]
width = 320
height = 240
fx = 200.0
position = [-1.5, 1.6, 1.5]
look_at = [0.5, 1.0, -1.0]

[surface]
mesh = "room.obj"

[baked]
folder = "maps"
"""
ROOM = merged(block((4, 3, 4), (0, 1.5, 0), inwards=True), block((0.6, 3, 0.6), (0, 1.5, 0)))


@pytest.fixture
def folder(tmp_path, monkeypatch):
    write_obj(tmp_path / "room.obj", ROOM)
    (tmp_path / "room.toml").write_text(SCENE)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "200")
    return tmp_path


def run(*words):
    app = typer.Typer()
    app.command()(cameras)
    return CliRunner().invoke(app, list(words))


def test_the_table_says_what_each_camera_adds(folder):
    outcome = run("room.toml", "-o", "plan.png")
    assert outcome.exit_code == 0, outcome.output
    lines = outcome.stdout.splitlines()
    assert "1 (frame)  -1.50 1.60 1.50" in lines[1]
    assert "all around" in lines[2]
    shares = [float(line.split()[-1].rstrip("%")) for line in lines[1:] if line.strip()]
    assert shares == sorted(shares)
    assert shares[-1] >= 99
    assert read_picture(folder / "plan.png").shape[0] > 500


def test_its_tables_can_be_pasted(folder):
    outcome = run("room.toml", "--toml")
    (folder / "stated.toml").write_text(SCENE + outcome.stdout)
    stated = load_scene(folder / "stated.toml").baked.camera
    frame = load_scene(folder / "room.toml").rig.camera.view("mono")
    found = suggested_views(ROOM, [frame], coverage=0.99, most_cameras=12, map_size_px=384)
    assert len(stated) == len(found.views) > 1
    for table, view in zip(stated, found.views, strict=True):
        same_view(table.view("map"), view)


def same_view(a, b):
    assert (a.projection, a.width, a.height) == (b.projection, b.width, b.height)
    np.testing.assert_allclose(a.world_from_camera, b.world_from_camera, atol=1e-6)
    if a.projection != "latlong":
        assert (a.fx, a.fy, a.cx, a.cy) == (b.fx, b.fy, b.cx, b.cy)


def test_they_are_those_of_the_bake(folder):
    """Of a scene in which something moves as well: it is seen where it is at the beginning."""
    write_obj(folder / "screen.obj", block((0.1, 2.6, 2.6), (0, 0, 0)))
    moving = """lamps = ["lamp"]

[[lamp]]
kind = "point"
name = "lamp"
position = [-1.2, 2.0, -1.2]
intensity_cd = 100.0
transport = "baked"

[[object]]
mesh = "screen.obj"
key = [{ time_seconds = 0, position = [1.2, 1.4, 0.0] },
       { time_seconds = 1, position = [1.2, 1.4, 0.5] }]
"""
    (folder / "room.toml").write_text(SCENE + moving)
    scene = load_scene(folder / "room.toml")
    tables = tomllib.loads(run("room.toml", "--toml").stdout)["baked"]["camera"]
    planned = plan_maps(scene).views
    assert len(tables) == len(planned) > 1
    for table, view in zip(tables, planned, strict=True):
        same_view(Camera.model_validate(table, strict=False).view("map"), view)


def test_every_kind_of_view_survives_its_table():
    pose = look_at(np.array([0.1, 0.2, 0.3]), np.array([1, -2, 0.5]))
    fisheye = View("fisheye", 100, 80, 31.7, 32.1, 48.2, 40.9, world_from_camera=pose)
    latlong = View("latlong", 96, 48, world_from_camera=pose)
    views = (pinhole_view(64, 48, 50.123456789, pose), fisheye, latlong)
    for table, view in zip(camera_tables(views), views, strict=True):
        back = Camera.model_validate(tomllib.loads(toml_text(table)), strict=False).view("map")
        same_view(back, view)
        np.testing.assert_array_equal(back.world_from_camera, view.world_from_camera)


def test_what_is_not_reached_is_said(folder):
    (folder / "room.toml").write_text(SCENE + "most_cameras = 1\n")
    outcome = run("room.toml")
    assert "baked.most_cameras is 1" in outcome.stderr


def test_a_scene_without_the_table_is_refused(folder):
    (folder / "room.toml").write_text(SCENE.split("[baked]")[0])
    outcome = run("room.toml")
    assert isinstance(outcome.exception, InputError)
    assert "[baked]" in str(outcome.exception)


def test_the_plan_is_a_png(folder):
    outcome = run("room.toml", "-o", "plan.jpg")
    assert isinstance(outcome.exception, InputError)
