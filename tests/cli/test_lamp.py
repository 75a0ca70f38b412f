"""`andon lamp`."""

import json

import pytest

from andon.files.pictures import read_picture
from andon.scene import LAMP_KINDS
from photometry_files import ies, ldt

from .command import run_andon, run_refused


@pytest.fixture
def folder(tmp_path, monkeypatch):
    (tmp_path / "a.ies").write_text(
        ies(labels=["[MANUFAC] Maker", "[LUMCAT] L-1", "[_ABSOLUTELUMENS] 600"], candela=100)
    )
    (tmp_path / "b.ldt").write_text(ldt())
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_show_says_what_the_file_holds(capfd, folder):
    outcome = run_andon(capfd, "lamp", "show", "a.ies")
    assert outcome.code == 0, outcome.err
    text = " ".join(outcome.out.split())
    # 100 cd below the horizon: 2π·100 lm; the hard edge is met to a step of 0.1°.
    for part in (
        "L-1", "Maker", "628.319 lm", "600 lm, the integral differs by +4.72%", "100 cd",
        "180.1° in C0-C180", "type C", "12.5 W", "400 mm along C0, 200 mm along C90",
    ):  # fmt: skip
        assert part in text, part


def test_show_draws(capfd, folder):
    outcome = run_andon(capfd, "lamp", "show", "b.ldt", "-o", "b.png")
    assert outcome.code == 0, outcome.err
    assert outcome.out.splitlines()[-1] == "b.png"
    assert read_picture(folder / "b.png").shape == (828, 720)
    assert "1600 lm, the integral differs" in outcome.out


def test_relative_photometry_names_the_bare_lamps(capfd, folder):
    (folder / "c.ies").write_text(ies(head="1 2000 1 {v} {h} {type} 2 0 0 0", candela=100))
    text = " ".join(run_andon(capfd, "lamp", "show", "c.ies").out.split())
    assert "2000 lm of the bare lamps, of which 31.4% leave" in text
    assert "a point" in text


def test_a_label_cannot_paint_the_terminal(capfd, folder):
    (folder / "d.ies").write_text(ies(labels=["[LUMCAT] \x1b[31mred [bold]x[/] \x07"]))
    outcome = run_andon(capfd, "lamp", "show", "d.ies")
    assert outcome.code == 0, outcome.err
    assert "\x1b" not in outcome.out
    assert "\x07" not in outcome.out
    assert "[bold]x[/]" in outcome.out


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["missing.ies"], "missing.ies: must exist"),
        (["x.txt"], "must be one of .ies, .ldt"),
        (["cut.ies"], "cut short"),
        (["a.ies", "-o", "a.jpg"], "--out: must end in .png"),
        (["a.ies", "-o", "nowhere/a.png"], "does not exist"),
        (["a.png", "-o", "a.png"], "is also the input"),
    ],
)
def test_refusals(capfd, folder, words, expected):
    (folder / "x.txt").write_text("x")
    (folder / "cut.ies").write_text(ies()[:-20])
    (folder / "a.png").write_text("x")
    assert expected in run_refused(capfd, folder, "lamp", "show", *words)


def test_the_group_alone_prints_its_help(capfd, folder):
    outcome = run_andon(capfd, "lamp")
    assert outcome.code == 0
    assert "show" in outcome.out
    assert outcome.err == ""


def test_help_has_examples(capfd, folder):
    assert "andon lamp show office.ldt -o office.png" in " ".join(
        run_andon(capfd, "lamp", "show", "--help").out.split()
    )


def test_presets_are_listed(capfd, folder):
    from andon.scene.presets import PRESETS

    outcome = run_andon(capfd, "lamp", "presets")
    assert outcome.code == 0
    for name, preset in PRESETS.items():
        assert name in outcome.out
        assert f"{preset.keys['temperature_k']:g}" in outcome.out


def test_presets_are_legible_in_80_columns(capfd, folder, monkeypatch):
    from andon.scene.presets import PRESETS

    monkeypatch.setenv("COLUMNS", "80")
    text = run_andon(capfd, "lamp", "presets").out
    assert max(map(len, text.splitlines())) <= 80
    assert len(text.splitlines()) <= 2 * len(PRESETS) + 1
    words = set(text.split())
    for preset in PRESETS.values():
        assert set(preset.what.split()) <= words, "no word is broken"
    assert "EN 60064" not in text
    assert "EN 60064" in run_andon(capfd, "lamp", "presets", "--long").out


def test_presets_as_json_are_lamps(capfd, folder):
    from andon.scene import scene_from_dict
    from andon.scene.presets import PRESETS

    entries = json.loads(run_andon(capfd, "lamp", "presets", "--json").out)
    assert [entry["preset"] for entry in entries] == list(PRESETS)
    place = {"position": [0, 0, -1], "direction": [0, 0, -1]}
    for entry in entries:
        keys = entry["keys"]
        table = LAMP_KINDS[keys["kind"]].model_fields
        lamp = keys | {key: value for key, value in place.items() if key in table}
        scene_from_dict({"lamp": [lamp]})
        assert entry["source"]
