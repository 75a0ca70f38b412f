"""`andon probes place` and `andon probes show`."""

import tomllib
from pathlib import Path

import numpy as np
import pytest

from andon.files.meshes.gltf import read_gltf_nodes
from andon.files.pictures import read_picture, write_png
from andon.files.volumes import ProbeVolume, write_volume
from andon.quantities import merged
from andon.scene import load_scene
from andon.transport.probes.placement import place_probes, zones_of
from requirements import required
from worlds import block, write_obj

from .command import run_andon, run_refused

required("scipy")

SCENE = """
[surface]
mesh = "room.obj"

[probes]
volume = "room.probes.glb"

[probes.placement]
kind = "lattice"
counts = [2, 2, 3]
offset_m = 0.5

[[probes.place]]
name = "pillar"
position = [0.1, 1.0, 0.0]
role = "sky"

[[probes.place]]
name = "door"
position = [1.2, 1.0, 0.1]
capture_position = [1.2, 1.0, 0.6]

[[probes.place]]
name = "door again"
position = [1.2, 1.0, 0.1]
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    room = block((4, 3, 4), (0, 1.5, 0), inwards=True)
    write_obj(tmp_path / "room.obj", merged(room, block((1, 3, 1), (0, 1.5, 0))))
    (tmp_path / "room.toml").write_text(SCENE)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "200")
    return tmp_path


def write_light(folder):
    """A volume of the scene: from above it is bright and blue, from below dim and red."""
    from andon.transport.probes.cells import build_cells

    scene = load_scene(folder / "room.toml")
    placed = place_probes(scene, block((4, 3, 4), (0, 1.5, 0), inwards=True))
    light = np.zeros((placed.count, 4, 3))
    light[:, 0], light[:, 1] = [60.0, 60.0, 60.0], [-20.0, 0.0, 30.0]
    zones = zones_of(scene, placed.positions)
    volume = ProbeVolume(
        placed.positions, placed.capture_positions, placed.names, placed.roles, placed.ranges_m,
        {"day": light, "night": light / 100}, zones, build_cells(placed.positions, zones),
    )  # fmt: skip
    write_volume(folder / "room.probes.glb", volume)
    return volume


def test_place_says_how_many_and_where(capfd, folder):
    outcome = run_andon(capfd, "probes", "place", "room.toml")
    assert outcome.code == 0, outcome.err
    lines = {line.split()[0]: " ".join(line.split()) for line in outcome.out.splitlines()}
    assert lines["probes"] == "probes 14"
    assert lines["roles"] == "roles 1 sky, 13 general"
    assert lines["bounds"] == "bounds -1.5…1.5 × 0.5…2.5 × -1.5…1.5 m"
    assert "m to the next probe" in lines["nearest"]
    assert lines["in"] == "in walls 1: pillar"
    assert "1 at the place of another" in lines["left"]
    assert "1 probe within 1 mm of another, left out: door again" in outcome.err
    assert "1 probe inside a wall or behind it: pillar" in outcome.err


def test_place_writes_tables_that_place_the_same(capfd, folder):
    outcome = run_andon(capfd, "probes", "place", "room.toml", "-o", "places.toml")
    assert outcome.code == 0, outcome.err
    assert outcome.out.splitlines()[-1] == "places.toml"
    text = (folder / "places.toml").read_text()
    assert text.startswith("# 14 probes of room.toml.")
    place = tomllib.loads(text)["probes"]["place"]
    assert len(place) == 14
    assert place[1] == {
        "name": "door",
        "position": [1.2, 1.0, 0.1],
        "capture_position": [1.2, 1.0, 0.6],
    }
    head = '[surface]\nmesh = "room.obj"\n[probes]\nvolume = "v.glb"\n'
    (folder / "hand.toml").write_text(head + text)
    again = run_andon(capfd, "probes", "place", "hand.toml").out.splitlines()
    assert again[:4] == outcome.out.splitlines()[:4]


def test_place_writes_locators(capfd, folder):
    outcome = run_andon(capfd, "probes", "place", "room.toml", "-o", "places.glb")
    assert outcome.code == 0, outcome.err
    nodes = read_gltf_nodes(folder / "places.glb")
    assert len(nodes) == 15
    assert [node.name for node in nodes[:3]] == ["probe_sky_pillar", "probe_door", "capture_door"]


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["missing.toml"], "missing.toml"),
        (["bare.toml"], "needs a [probes] table"),
        (["room.toml", "-o", "places.json"], "--out: must end in .toml, .glb"),
        (["room.toml", "-o", "room.toml"], "is also the input"),
        (["room.toml", "-o", "nowhere/p.toml"], "does not exist"),
        (["auto.toml"], "'automatic' is in the schema but not built yet"),
        (["normals.toml"], "normals"),
    ],
)
def test_refusals_of_place(capfd, folder, words, expected):
    (folder / "bare.toml").write_text("")
    auto = SCENE.replace('"lattice"', '"automatic"').replace(
        "counts = [2, 2, 3]", "spacing_m = 1.0"
    )
    (folder / "auto.toml").write_text(auto)
    (folder / "normals.toml").write_text(SCENE.replace("mesh =", "normals ="))
    assert expected in run_refused(capfd, folder, "probes", "place", *words)


@pytest.mark.parametrize(("shape", "message"), [(None, "p.png"), ((8, 9), "twice as wide")])
def test_place_looks_at_panoramas(capfd, folder, shape, message):
    if shape is not None:
        write_png(folder / "p.png", np.zeros((*shape, 3), np.uint8))
    text = SCENE.replace('role = "sky"', 'panorama = "p.png"')
    (folder / "room.toml").write_text(text)
    assert message in run_refused(capfd, folder, "probes", "place", "room.toml")


def test_what_moved_is_said_once(capfd, folder):
    (folder / "room.toml").write_text(SCENE.replace("0.5", "0.0"))
    outcome = run_andon(capfd, "probes", "place", "room.toml")
    assert (outcome.out + outcome.err).count("moved") <= 1


def test_bake_says_what_is_in_walls_once_and_succeeds(capfd, folder):
    text = SCENE.replace("counts = [2, 2, 3]", "counts = [2, 2, 2]")
    text = text.replace('"room.probes.glb"', '"room.probes.glb"\ncube_size_px = 8')
    (folder / "room.toml").write_text(text)
    outcome = run_andon(capfd, "probes", "bake", "room.toml", "--engine", "reference")
    assert outcome.code == 0, outcome.err
    assert outcome.err.count("pillar") == 1
    other = ["--state", "night", "--engine", "reference"]
    assert run_andon(capfd, "probes", "bake", "room.toml", *other).code == 0
    (folder / "room.toml").write_text(text.replace("[2, 2, 2]", "[2, 2, 3]"))
    words = ["probes", "bake", "room.toml", "--engine", "reference"]
    line = run_refused(capfd, folder, *words)
    assert "its state 'night' would be lost: it has 10 probes, not 14" in line
    outcome = run_andon(capfd, *words, "--replace")
    assert outcome.code == 0
    assert "the volume that was there is replaced: it had 10 probes, not 14" in outcome.err
    assert "--state: must be a name" in run_refused(capfd, folder, *words, "--state", "")


def test_a_frame_says_how_a_state_is_added(capfd, folder):
    write_light(folder)
    text = "[rig.camera]\nwidth = 8\nheight = 8\nfx = 8.0\n" + SCENE.replace(
        "[probes]", '[probes]\nstate = "dusk"'
    )
    (folder / "dusk.toml").write_text(text)
    line = run_refused(capfd, folder, "clip", "dusk.toml", "-o", "a.png")
    assert "probes.state: there is no state 'dusk'" in line
    assert line.endswith("andon probes bake dusk.toml --state dusk adds it")


def test_an_interrupted_bake_says_how_it_goes_on(capfd, folder, monkeypatch):
    def stopped(*words, **options):
        raise KeyboardInterrupt

    monkeypatch.setattr("andon.bake.bake_file", stopped)
    line = run_refused(capfd, folder, "probes", "bake", "room.toml", code=130)
    assert line == "andon: interrupted; run it again and it goes on"


def test_show_draws_the_places_before_a_bake(capfd, folder):
    outcome = run_andon(capfd, "probes", "show", "room.toml", "--size", "320x240")
    assert outcome.code == 0, outcome.err
    assert outcome.out.splitlines()[-1] == "probes.png"
    assert "room.probes.glb is not baked yet" in outcome.err
    assert "white is" not in outcome.err
    picture = read_picture(folder / "probes.png")
    assert picture.shape == (240, 320)
    assert np.ptp(picture.values) > 150


def test_show_draws_the_light(capfd, folder):
    write_light(folder)
    outcome = run_andon(
        capfd, "probes", "show", "room.toml", "-o", "light.png", "--size", "320x240",
        "--from", "0,1.5,6", "--at", "0,1.5,0", "--what", "balls", "--irradiance",
    )  # fmt: skip
    assert outcome.code == 0, outcome.err
    assert "cd/m², that is --exposure" in outcome.err
    values = read_picture(folder / "light.png").values.astype(int)
    blue, red = (values[..., 2] - values[..., 0]).max(), (values[..., 0] - values[..., 2]).max()
    assert blue > 60
    assert red > 40


def test_show_of_a_volume_alone_and_of_its_states(capfd, folder):
    write_light(folder)
    exposures = []
    for words in ([], ["--state", "night"]):
        outcome = run_andon(
            capfd, "probes", "show", "room.probes.glb", "-o", "v.png", "--size", "200x160", *words
        )
        assert outcome.code == 0, outcome.err
        exposures.append(float(outcome.err.split("--exposure")[1].split()[0]))
    assert exposures[1] == pytest.approx(100 * exposures[0], rel=0.02)


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["x.obj"], "must be a probe volume (.glb) or a scene (.toml)"),
        (["missing.glb"], "missing.glb"),
        (["bare.toml"], "needs a [probes] table"),
        (["room.toml", "-o", "p.jpg"], "--out: must end in .png"),
        (["room.toml", "--size", "20x20"], "--size: must be width x height"),
        (["room.toml", "--size", "big"], "--size: must be width x height"),
        (["room.toml", "--what", "bals"], "did you mean 'balls'"),
        (["room.toml", "--what", ","], "--what: must be of balls"),
        (["room.toml", "--from", "1,2"], "--from: must be three numbers"),
        (["room.toml", "--at", "1,2,nan"], "--at: must be three numbers"),
        (["room.toml", "--exposure", "0"], "--exposure: must be > 0"),
        (["room.probes.glb", "--state", "dusk"], "there is no state 'dusk'; it has day, night"),
        (["room.probes.glb", "--from", "0,5,0", "--at", "0,5,0"], "must lie apart"),
    ],
)
def test_refusals_of_show(capfd, folder, words, expected):
    write_light(folder)
    (folder / "bare.toml").write_text("")
    (folder / "x.obj").write_text("")
    assert expected in run_refused(capfd, Path(folder), "probes", "show", *words)


def test_help_has_examples(capfd, folder):
    text = " ".join(run_andon(capfd, "probes", "show", "--help").out.split())
    assert "andon probes show basic.toml -o probes.png" in text
    text = " ".join(run_andon(capfd, "probes", "place", "--help").out.split())
    assert "andon probes place basic-lattice.toml -o locators.glb" in text
