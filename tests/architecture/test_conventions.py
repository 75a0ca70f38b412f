"""One test for each convention of CONVENTIONS.md: it fails if the convention is turned round.

Here those of programs and files; space and light are beside.
"""

import re
from pathlib import Path

import numpy as np
import pytest

import andon
from andon.cli import _run
from andon.errors import InputError, MachineError
from andon.files.pictures import read_picture, write_exr, write_picture
from andon.lamps import resolve_lamps

from .settings import X, close, grey, relit
from .tree import ROOT


def test_the_document_and_the_tests_are_one_list():
    text = (ROOT / "CONVENTIONS.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\|.*\|([^|]*)\|$", text, re.MULTILINE)
    told = [name for row in rows for name in re.findall(r"`(\w+)`", row)]
    files = sorted(Path(__file__).parent.glob("test_conventions*.py"))
    found = re.findall(r"^def test_(\w+)", "\n".join(f.read_text("utf-8") for f in files), re.M)
    here = set(found) - {"the_document_and_the_tests_are_one_list"}
    assert len(found) == len(here) + 1
    assert len(told) == len(set(told))
    assert set(told) == here


def test_time():
    keys = [
        {"time_seconds": 0.0, "position": [0, 0, 0]},
        {"time_seconds": 2.0, "position": [4, 0, 0]},
    ]
    lamp = {"kind": "point", "position": [0, 0, 0], "intensity_cd": 1, "key": keys}
    scene = andon.scene_from_dict({"lamp": [lamp]})
    close(resolve_lamps(scene, 0.5)[0].position_m, X)


def test_eyes():
    rig = {"kind": "stereo", "right": {"fx": 1.0}, "left": {"fx": 1.0}}
    scene = andon.scene_from_dict({"rig": rig})
    assert [name for name, _ in scene.rig.cameras] == ["left", "right"]
    scene = andon.scene_from_dict({"rig": {"camera": {"fx": 1.0}}})
    assert [name for name, _ in scene.rig.cameras] == ["mono"]


def test_pictures_for_people(tmp_path):
    frame = relit(grey(200))
    assert frame.image.rgb.dtype == np.uint8
    write_picture(tmp_path / "a.png", frame.image.rgb)
    picture = read_picture(tmp_path / "a.png")
    assert picture.encoding == "srgb"
    np.testing.assert_array_equal(picture.values, grey(200))


def test_numbers_for_machines(tmp_path):
    lux = np.full((2, 2, 3), 123456.5, np.float32)
    write_exr(tmp_path / "a.exr", lux, unit="lx", photometry="relative")
    picture = read_picture(tmp_path / "a.exr")
    assert picture.encoding == "linear"
    np.testing.assert_array_equal(picture.values, lux)
    assert picture.attributes["andon:unit"] == "lx"
    assert picture.attributes["andon:photometry"] == "relative"


def test_seeds():
    from andon.verify.rooms import furnished_room

    one, same, other = (furnished_room(4000, seed).positions for seed in (1, 1, 2))
    np.testing.assert_array_equal(one, same)
    assert one.shape != other.shape or not np.array_equal(one, other)
    assert andon.scene_from_dict({}).scene.seed == 0


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (None, 0),
        (ZeroDivisionError("a bug"), 1),
        (InputError("must be > 0"), 2),
        (MachineError("disk full"), 3),
        (KeyboardInterrupt(), 130),
    ],
)
def test_exit_codes(error, code, monkeypatch, capsys):
    def doctor():
        if error is not None:
            raise error

    monkeypatch.setattr("andon.cli.doctor.run", doctor)
    assert _run(["doctor"], debug=False) == code
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 1 or code in (0, 130)
