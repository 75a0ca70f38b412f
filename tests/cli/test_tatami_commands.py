"""What the tatami room's README says: its commands, and which meshes are shells."""

import re
import shlex
from pathlib import Path

import pytest

from andon.cli.options import RelightOptions
from andon.cli.typed import scene_of
from andon.errors import InputError
from andon.lamps import resolve_lamps

ROOM = Path(__file__).resolve().parents[2] / "examples" / "tatami"
TEXT = (ROOM / "README.md").read_text(encoding="utf-8")
COMMANDS = re.findall(r"^andon relight (.+)$", TEXT, re.MULTILINE)


@pytest.mark.parametrize("command", COMMANDS)
def test_commands_name_scenes_and_lamps_that_are_there(monkeypatch, tmp_path, command):
    monkeypatch.chdir(ROOM)
    photo, *words = shlex.split(command)
    options = dict(zip(words[::2], words[1::2], strict=True))
    lamps = [options["--lamp"]] if "--lamp" in options else None
    typed = RelightOptions(
        Path(options["-o"]), Path(photo), scene=Path(options["--scene"]), lamps=lamps
    )
    scene = scene_of(typed)
    assert scene.path(scene.capture.source, "capture.source") == Path("photo.png")
    assert len(resolve_lamps(scene, 0.0)) > len(lamps or ())
    assert set(options) <= {"-o", "--scene", "--lamp", "--illuminance-map"}


def test_every_scene_has_its_command():
    assert len(COMMANDS) == 6
    for scene in ROOM.glob("*.toml"):
        assert scene.name == "camera.toml" or any(scene.name in command for command in COMMANDS)


@pytest.mark.parametrize("name", ["andon_shade", "drum_shade", "box_lantern", "chochin"])
def test_meshes_that_are_shells_and_one_that_is_none(monkeypatch, name):
    monkeypatch.chdir(ROOM)
    lamp = f"kind=point,position=0,0.5,0,flux_lm=9,shell.mesh={name}.obj"
    options = RelightOptions(
        Path("out.png"), Path("photo.png"), scene=Path("figure3.toml"), lamps=[lamp]
    )
    scene = scene_of(options)
    if name == "chochin":
        with pytest.raises(InputError, match="a shell is one layer of triangles"):
            resolve_lamps(scene, 0.0)
    else:
        assert any(part.name.startswith("point-1") for part in resolve_lamps(scene, 0.0))
