"""docs/baked-light.md: its scene bakes by its commands, its tables are what the code has."""

import re
import shlex
import shutil
from pathlib import Path

import numpy as np
import pytest

from andon.cli import _run
from andon.files.pictures import read_picture
from andon.scene.ambient import Baked
from andon.scene.lamp_base import LampTable
from andon.scene.probes import Probes
from andon.transport.baked.radiance.quality import FEW_POINTS, QUALITIES
from andon.transport.baked.rims import REACH
from andon.transport.baked.texels import BORDER_TEXELS, EDGE_TEXELS, NORMAL_COSINES

ROOT = Path(__file__).parents[2]
MANUAL = (ROOT / "docs" / "baked-light.md").read_text(encoding="utf-8")
TEXT = " ".join(MANUAL.split())
COMMANDS = [
    line.removeprefix("andon ")
    for block in re.findall(r"```sh\n(.*?)```", MANUAL, re.DOTALL)
    for line in block.splitlines()
]


def rows(heading):
    """The cells of the table under a row that begins with `heading`."""
    table = MANUAL.partition(f"\n| `{heading}` |")[2].partition("\n\n")[0]
    return [line.strip("| ").split(" | ") for line in table.splitlines()[2:]]


def test_errors_and_times_of_the_qualities():
    told = {cells[0].strip("`"): cells[1:] for cells in rows("quality")}
    assert told == {
        quality.name: [
            f"{quality.median_error:.1%}".replace("%", " %"),
            f"{quality.p95_error:.0%}".replace("%", " %"),
            f"{quality.seconds_per_100k_points:g}",
            f"{quality.share:.0%} of the points, with {quality.ambient_divisions} rays".replace(
                "%", " %"
            ),
        ]
        for quality in QUALITIES.values()
    }
    assert f"Maps of fewer than {FEW_POINTS} points" in TEXT


def test_it_names_all_choices():
    for heading, model, key in (
        ("transport", LampTable, "transport"),
        ("mode", Baked, "mode"),
        ("quality", Baked, "quality"),
    ):
        choices = model.model_fields[key].annotation.__args__
        assert [cells[0].strip("`") for cells in rows(heading)] == list(choices)


@pytest.mark.parametrize("key", ["depth_tolerance_m", "coverage", "most_cameras"])
def test_defaults(key):
    assert f"`{key}` ({Baked.model_fields[key].default:g})" in TEXT


def test_numbers_of_the_projection():
    apart, alike = np.degrees(np.arccos(NORMAL_COSINES))
    assert f"fully up to {alike:.0f}°, not at all from {apart:.0f}° on" in TEXT
    assert f"{BORDER_TEXELS:g} texels towards its border and {EDGE_TEXELS} towards" in TEXT
    assert f"up to {REACH} pixels of it" in TEXT


def test_what_few_bounces_leave_out():
    (told,) = re.findall(r"`bounces` = (\d).*?reflectance of ([\d.]+) (\d+) % of", TEXT)
    bounces, reflectance, percent = int(told[0]), float(told[1]), float(told[2])
    assert bounces == Baked.model_fields["bounces"].default
    assert 100 * reflectance ** (bounces + 1) == pytest.approx(percent, abs=0.5)
    assert 0.8 ** (bounces + 1) == pytest.approx(1 / 3, abs=0.01)


def test_its_keys_of_probes():
    (table,) = re.findall(r"```toml\n\[probes\]\n(.*?)```", MANUAL, re.DOTALL)
    assert set(re.findall(r"^(\w+) =", table, re.MULTILINE)) <= set(Probes.model_fields)


def test_its_commands(tmp_path, monkeypatch, capsys):
    (scene,) = re.findall(r"```toml\n# lantern.toml[^\n]*\n(.*?)```", MANUAL, re.DOTALL)
    (tmp_path / "lantern.toml").write_text(scene, encoding="utf-8")
    shutil.copy(ROOT / "examples" / "basic" / "room.glb", tmp_path)
    monkeypatch.chdir(tmp_path)
    assert len(COMMANDS) == 7
    for command in COMMANDS:
        extra = ["--engine", "reference"] if command.startswith("relight") else []
        assert _run([*shlex.split(command), *extra], debug=True) == 0
    said = capsys.readouterr().out
    assert said.count("[[baked.camera]]") == 3
    for name in ("maps", "gaps", "plan"):
        assert (tmp_path / f"{name}.png").stat().st_size > 1000
    assert 20 < read_picture(tmp_path / "lit.png").values.mean() < 200
