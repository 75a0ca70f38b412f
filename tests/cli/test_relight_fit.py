"""`andon relight --fit-to`, from files to files."""

import json

import numpy as np
import pytest

from andon.files.pictures import read_picture, write_png

from .command import PHOTOGRAPHED, run_andon, run_refused

LAMPS = """
[[lamp]]
name = "warm, left"
kind = "point"
position = [-0.5, 0.3, -1.2]
flux_lm = 100.0
[[lamp]]
name = "right"
kind = "point"
position = [0.6, 0.2, -1.5]
flux_lm = 100.0
"""
TRUTH = LAMPS.replace("100.0", "700.0", 1).replace("100.0", "260.0")


@pytest.fixture
def folder(tmp_path, monkeypatch, capfd):
    from worlds import write_relight_files

    write_relight_files(tmp_path)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scene.toml").write_text(PHOTOGRAPHED + LAMPS)
    (tmp_path / "truth.toml").write_text(PHOTOGRAPHED + TRUTH)
    words = ["relight", "--scene", "truth.toml", "--engine", "reference", "-o", "on.png"]
    assert run_andon(capfd, *words).code == 0
    mask = np.zeros((48, 64, 3), np.uint8)
    mask[:, 8:56] = 255
    write_png(tmp_path / "mask.png", mask)
    return tmp_path


def fitted(capfd, *more, scene="scene.toml", reference="on.png"):
    words = ["relight", "--scene", scene, "--fit-to", reference, "--engine", "reference"]
    return run_andon(capfd, *words, "-o", "lit.png", *more)


def test_a_fit_writes_picture_report_figure_and_scene(capfd, folder):
    outcome = fitted(
        capfd, "--fit-mask", "mask.png", "--fit-report", "fit.json", "--fit-figure", "fit.png",
        "--fit-scene", "fitted.toml",
    )  # fmt: skip
    assert outcome.code == 0, outcome.err
    assert outcome.out == "lit.png\n"
    report = json.loads((folder / "fit.json").read_text())
    fluxes = {lamp["name"]: lamp["flux_lm"] for lamp in report["lamps"]}
    assert fluxes == pytest.approx({"warm, left": 700, "right": 260}, rel=0.02)
    inside = report["errors"]["inside"]
    assert inside["fitted"]["psnr_db"] > inside["gain_channels"]["psnr_db"] + 10
    for words in (
        "warm, left: flux_lm = ",
        "of the added light",
        "inside",
        "best gain",
        "absolute",
    ):
        assert words in " ".join(outcome.err.split())
    lit, wanted = (read_picture(folder / name).values.astype(int) for name in ("lit.png", "on.png"))
    assert np.abs(lit - wanted).max() <= 3
    figure = read_picture(folder / "fit.png").values
    assert figure.shape[0] > 2 * 48
    again = run_andon(
        capfd, "relight", "--scene", "fitted.toml", "-o", "again.png", "--engine", "reference"
    )
    assert again.code == 0, again.err
    assert (read_picture(folder / "again.png").values == lit).all()


def test_one_of_the_lamps_by_a_name_with_a_comma(capfd, folder):
    outcome = fitted(capfd, "--fit-lamps", "warm, left", "--fit-report", "fit.json")
    assert outcome.code == 0, outcome.err
    lamps = json.loads((folder / "fit.json").read_text())["lamps"]
    assert [lamp["name"] for lamp in lamps] == ["warm, left"]


def test_a_typed_scene_is_fitted_and_written(capfd, folder):
    typed = ["photo.png", "--depth", "depth.npy", "--camera", "camera.toml", "--ambient-lux", 200]
    lamps = [
        "--lamp", "kind=point,position=-0.5,0.3,-1.2,flux_lm=50",
        "--lamp", "kind=point,position=0.6,0.2,-1.5,flux_lm=50",
    ]  # fmt: skip
    outcome = run_andon(
        capfd, "relight", *typed, *lamps, "--fit-to", "on.png", "--fit-scene", "fitted.toml",
        "--engine", "reference", "-o", "lit.png",
    )  # fmt: skip
    assert outcome.code == 0, outcome.err
    again = run_andon(
        capfd, "relight", "--scene", "fitted.toml", "-o", "again.png", "--engine", "reference"
    )
    assert again.code == 0, again.err
    lit, other = (read_picture(folder / name).values for name in ("lit.png", "again.png"))
    assert (lit == other).all()


def test_dimming_bounce_and_response_are_said(capfd, folder):
    outcome = fitted(
        capfd, "--fit-dimming", "one", "--fit-bounce", "--fit-response", "--no-fit-colour"
    )
    assert outcome.code == 0, outcome.err
    for words in ("dimming: ", "bounce: from above", "RMSE of codes: "):
        assert words in " ".join(outcome.err.split())


def test_another_exposure_is_taken_up_unless_it_is_switched_off(capfd, folder):
    on = read_picture(folder / "on.png").values
    write_png(folder / "darker.png", (0.6 * on).astype(np.uint8))

    def psnr(*more):
        outcome = fitted(capfd, "--fit-report", "fit.json", *more, reference="darker.png")
        assert outcome.code == 0, outcome.err
        report = json.loads((folder / "fit.json").read_text())
        return report["errors"]["whole"]["fitted"]["psnr_db"], report["dimming"]

    alone, nothing = psnr("--fit-dimming", "off")
    assert nothing is None
    assert psnr()[0] > alone + 5


def test_a_scene_that_leaves_no_light_has_no_dimming_to_fit(capfd, folder):
    text = (folder / "scene.toml").read_text()
    assert "dimming" not in text
    dark = text.replace("[ambient]", "[ambient]\ndimming = 0.0")
    (folder / "dark.toml").write_text(dark)
    outcome = fitted(capfd, "--fit-report", "fit.json", scene="dark.toml")
    assert outcome.code == 0, outcome.err
    assert json.loads((folder / "fit.json").read_text())["dimming"] is None


def test_what_harms_a_fit_is_said(capfd, folder):
    """Holes that nobody closes, and E0 that is not the same everywhere."""
    depth = np.load(folder / "depth.npy")
    depth[:6, :20] = np.nan
    np.save(folder / "depth.npy", depth)
    uneven = read_picture(folder / "photo.png").values.copy()
    uneven[:, :32] //= 2
    write_png(folder / "photo.png", uneven)
    said = " ".join(fitted(capfd).err.split())
    assert "surface.depth.fill_px closes those" in said
    assert "andon calibrate ambient estimates a map" in said


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (["--fit-to", "gone.png"], "gone.png"),
        (["--fit-to", "small.png"], "small.png: is 10×10 px but the photograph is 64×48"),
        (["--fit-mask", "small.png"], "small.png: is 10×10 px"),
        (["--fit-mask", "black.png"], "black.png: selects nothing"),
        (["--fit-lamps", "left"], "--fit-lamps: there is no lamp 'left'"),
        (
            ["--fit-dimming", "two"],
            "--fit-dimming: must be one of auto, off, one, channels, got 'two'",
        ),
        (["--fit-align", "yes"], "--fit-align: must be one of auto, none"),
        (["--fit-report", "fit.txt"], "--fit-report: must end in .json"),
        (["--fit-figure", "fit.jpg"], "--fit-figure: must end in .png"),
        (["--fit-scene", "below/fitted.toml"], "--fit-scene: must lie in the scene's folder"),
        (["--fit-figure", "on.png"], "is also an input or another output"),
        (["--fit-report", "gone/fit.json"], "the folder 'gone' does not exist"),
    ],
)
def test_what_cannot_be_fitted_is_refused_before_anything_is_written(capfd, folder, more, words):
    write_png(folder / "small.png", np.zeros((10, 10, 3), np.uint8))
    write_png(folder / "black.png", np.zeros((48, 64, 3), np.uint8))
    (folder / "below").mkdir()
    given = ["relight", "--scene", "scene.toml", "--engine", "reference", "-o", "lit.png"]
    given += [] if "--fit-to" in more else ["--fit-to", "on.png"]
    assert words in run_refused(capfd, folder, *given, *more)


@pytest.mark.parametrize(
    "more", [["--no-fit-bounce"], ["--fit-mask", "mask.png"], ["--no-fit-colour"]]
)
def test_options_of_a_fit_need_one(capfd, folder, more):
    given = ["relight", "--scene", "scene.toml", "--engine", "reference", "-o", "lit.png"]
    line = run_refused(capfd, folder, *given, *more)
    assert "is of a fit, and there is none" in line
    assert more[0].replace("no-", "") in line


def test_files_beyond_the_folder_of_the_fitted_scene_are_refused(capfd, folder):
    (folder / "below").mkdir()
    typed = ["photo.png", "--depth", "depth.npy", "--camera", "camera.toml", "--ambient-lux", 200]
    lamp = ["--lamp", "kind=point,position=0,0.3,-1.2,flux_lm=50"]
    line = run_refused(
        capfd, folder, "relight", *typed, *lamp, "--fit-to", "on.png", "--fit-scene",
        "below/fitted.toml", "--engine", "reference", "-o", "lit.png",
    )  # fmt: skip
    assert "lies beyond its folder" in line
