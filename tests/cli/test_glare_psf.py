"""`andon glare` and `andon glare psf`."""

import numpy as np
import pytest
import typer
from typer.testing import CliRunner

from andon.display.time_series import INK, PAPER
from andon.files.pictures import read_picture

from .command import run_andon, run_refused


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def near(picture, colour):
    """(H, W) where it is nearly that colour: lines have smooth edges."""
    return (np.abs(picture - np.array(colour)) <= 30).all(axis=-1)


def picture_of(path):
    return read_picture(path).values.astype(int)


def test_all_models(folder, capfd):
    """A curve of its own colour for each, in both diagrams; a tile for each below."""
    from andon.display.spread_plot import COLOURS

    outcome = run_andon(capfd, "glare", "psf", "-o", "psf.png")
    assert outcome.code == 0, outcome.err
    assert outcome.out == "psf.png\n"
    picture = picture_of(folder / "psf.png")
    assert picture.shape[1] == 1200
    for rows in (slice(0, 640), slice(640, 1040)):
        assert near(picture[rows], PAPER).mean() > 0.8
        for colour in COLOURS:
            assert near(picture[rows], colour).sum() > 100, colour
    tiles = picture[-300:, 4:296]
    assert tiles[150, 146].tolist() == [255, 255, 255]
    assert tiles[5, 5].max() < 40
    # Red lies outside of green, and that outside of blue.
    ray = tiles[150, 146:]
    radius = [int(np.argmax(ray[40:, c] - ray[40:].min(axis=1))) for c in range(3)]
    assert radius[0] > radius[1] > radius[2] > 20


def test_the_standard_observer_is_the_ratio_s_line(folder, capfd):
    """CIE 135 at 25 years lies on 1, the middle of the second diagram's axis; at 70 above it."""
    words = ("glare", "psf", "-o", "psf.png", "--model", "cie-total")
    run_andon(capfd, *words)
    young = picture_of(folder / "psf.png")[640:1040, 300:1170]
    run_andon(capfd, *words, "--age", "70")
    old = picture_of(folder / "psf.png")[640:1040, 300:1170]
    middle = 64 + (400 - 64 - 56) / 2
    assert abs(np.flatnonzero(near(young, INK).sum(axis=1) > 800).mean() - middle) <= 1
    # At 10° the ratio is 2.07, which is 0.32 of the upper half.
    column = round((np.log(10 / 0.01) / np.log(1e4)) * (1200 - 84 - 24) + 84) - 300
    rows = np.flatnonzero(near(old[64:343, column], INK)) + 64
    assert abs(rows.mean() - (middle - np.log10(2.0674) * 140)) <= 2


@pytest.mark.parametrize(
    "words",
    [
        ["--model", "cie135", *(w for age in range(20, 80, 5) for w in ("--age", age))],
        ["--model", "cie135", "--model", "spencer", *(w for a in range(6) for w in ("--age", a))],
    ],
)
def test_a_dozen_curves_look_different(folder, capfd, words, monkeypatch):
    from andon.display import spread_plot

    panels = []

    def drawn(given, **_):
        panels.extend(given)
        return np.zeros((4, spread_plot.WIDTH_PX, 3), np.uint8)

    monkeypatch.setattr(spread_plot, "drawn", drawn)
    outcome = run_andon(capfd, "glare", "psf", "-o", "psf.png", *words)
    assert outcome.code == 0, outcome.err
    for panel in panels:
        assert len({(curve.colour, curve.dash_px) for curve in panel.curves if curve.name}) == 12


def test_one_curve_by_two_names(folder, capfd):
    run_andon(capfd, "glare", "psf", "-o", "one.png", "--model", "cie135")
    run_andon(capfd, "glare", "psf", "-o", "two.png", "--model", "cie135", "--model", "cie-total")
    assert (folder / "one.png").read_bytes() == (folder / "two.png").read_bytes()


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (["-o", "psf.jpg"], "psf.jpg: --out: must end in .png, got 'psf.jpg'"),
        (["-o", "psf.png", "--model", "cie"], "model: must be one of cie135, "),
        (["-o", "psf.png", "--age", "121"], "eye.age_years: must be 0…120, got 121"),
        (["-o", "psf.png", "--pupil-mm", "0"], "eye.pupil_mm: must be 1…10, got 0"),
        (["-o", "psf.png", "--pigment", "2"], "eye.pigment: must be 0…1.2, got 2"),
        (
            ["-o", "psf.png", "--age", "20", "--age", "70"],
            "--model: 14 curves asked for, 1 to 12 can be told apart; fewer models or ages",
        ),
    ],
)
def test_refusals(folder, capfd, words, line):
    assert line in run_refused(capfd, folder, "glare", "psf", *words)


def test_a_picture_is_the_default_command():
    """What is no sub-command goes to `picture`, options too; --help is the group's."""
    from andon.cli.glare_app import PICTURE, glare_app

    taken = []
    app = typer.Typer(cls=glare_app.info.cls, no_args_is_help=True)

    @app.command(PICTURE)
    def picture(file: str, out: str = typer.Option(..., "-o")):
        taken.append((file, out))

    @app.command("psf")
    def psf(out: str = typer.Option(..., "-o")):
        taken.append(("psf", out))

    runner = CliRunner()
    for words in (["in.hdr", "-o", "out.png"], ["-o", "b.png", "in.exr"], ["psf", "-o", "c.png"]):
        assert runner.invoke(app, words).exit_code == 0
    assert taken == [("in.hdr", "out.png"), ("in.exr", "b.png"), ("psf", "c.png")]
    assert "psf" in runner.invoke(app, ["--help"]).output
