"""`andon gaze`: pictures, tables and a report of a recording; refusals."""

import csv
import json

import numpy as np
import pytest

from andon.files.pictures import read_picture
from gaze_files import EYELINK, looking_at, own_gaze

from .command import run_andon, run_refused

FILES = {"gaze.png", "histogram.png", "fixations.csv", "report.json"}


@pytest.fixture
def recording(tmp_path):
    """Four seconds at 30 Hz: 1 m, then 0.5 m, a blink, an eye lost for a second."""
    times = np.arange(120) / 30
    points = np.zeros((120, 3))
    points[:, 2] = np.where(times < 2, 1.0, 0.5)
    directions = looking_at(points)
    directions[30:36] = np.nan
    directions[90:, 0] = np.nan
    path = tmp_path / "rays.csv"
    path.write_text(own_gaze(times, directions))
    return path


def test_it_says_what_it_found(recording, capfd):
    out = recording.parent / "out"
    outcome = run_andon(capfd, "gaze", recording, "-o", out)
    assert outcome.code == 0, outcome.err
    assert {path.name for path in out.iterdir()} == FILES
    report = json.loads((out / "report.json").read_text())
    assert report["samples"] == 120
    assert report["good"] == 84
    assert report["rejected"] == {"blink": 6, "one eye missing": 30}
    assert report["blinks"] == 1
    assert report["median_rate_hz"] == pytest.approx(30)
    assert report["vergence_dioptres"]["p95"] == pytest.approx(2.0)
    assert report["filter"] == "one-euro"
    assert set(report["filters"]) == {"none", "paper", "mean", "one-euro"}
    assert all(row["not_finite"] == 0 for row in report["filters"].values())
    assert "one eye missing  30 (25.0%)" in outcome.out
    assert "one-euro *" in outcome.out


def test_fixations_are_those_of_the_filter(recording, capfd):
    out = recording.parent / "out"
    run_andon(capfd, "gaze", recording, "-o", out, "--filter", "none")
    with (out / "fixations.csv").open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == 120
    assert float(rows[0]["dioptres"]) == pytest.approx(1.0)
    assert rows[30]["dioptres"] == ""
    assert [rows[i]["state"] for i in (0, 30, 36, 91, 119)] == [
        "seen", "held", "seen", "held", "fallback"
    ]  # fmt: skip
    assert float(rows[91]["smoothed_dioptres"]) == pytest.approx(2.0)
    assert rows[119]["smoothed_dioptres"] == ""


def test_pictures_show_the_curves_the_blink_and_the_loss(recording, capfd):
    from andon.cli.gaze_report import SHADES
    from andon.display.time_series import COLOURS

    out = recording.parent / "out"
    run_andon(capfd, "gaze", recording, "-o", out)
    picture = read_picture(out / "gaze.png").values.astype(int)
    assert picture.shape == (680, 1200, 3)

    def columns(colour, rows):
        near = (np.abs(picture[rows] - np.array(colour)) <= 4).all(axis=-1)
        return np.flatnonzero(near.sum(axis=0) > 60) / 1200

    upper = slice(64, 280)  # below the legend, which shows the same colours
    blink, lost = (columns(SHADES[name], upper) for name in ("blink", "rejected"))
    assert 0.28 < blink.min() < blink.max() < 0.38
    assert lost.max() > 0.95
    assert not ((lost > 0.4) & (lost < 0.7)).any()
    for colour in COLOURS[1:3]:
        near = (np.abs(picture[upper] - np.array(colour)) <= 25).all(axis=-1)
        rows = np.flatnonzero(near.any(axis=1))
        assert np.ptp(rows) > 60, "from 1 m to 0.5 m"


def test_settings_come_from_the_scene(recording, capfd):
    scene = recording.parent / "scene.toml"
    scene.write_text('[gaze]\nsource = "file"\nfile = "rays.csv"\nfilter = "paper"\nsamples = 5\n')
    out = recording.parent / "out"
    outcome = run_andon(capfd, "gaze", recording, "-o", out, "--scene", scene)
    assert outcome.code == 0, outcome.err
    report = json.loads((out / "report.json").read_text())
    assert report["filter"] == "paper"
    assert report["settings"]["samples"] == 5


def test_a_thinned_recording_and_one_of_distances(recording, capfd, tmp_path):
    assert run_andon(capfd, "gaze", recording, "-o", tmp_path / "a", "--rate", "10").code == 0
    assert json.loads((tmp_path / "a" / "report.json").read_text())["samples"] == 40
    plain = tmp_path / "plain.csv"
    plain.write_text("time_seconds,distance_m\n0,1\n0.1,\n0.2,2\n")
    outcome = run_andon(capfd, "gaze", plain, "-o", tmp_path / "b")
    assert outcome.code == 0, outcome.err
    figures = json.loads((tmp_path / "b" / "report.json").read_text())["filters"]["none"]
    assert figures["jitter_dioptres"] is None
    rule = run_refused(capfd, tmp_path, "gaze", plain, "-o", tmp_path / "c", "--rate", "10")
    assert "--rate" in rule


def test_a_recording_of_one_sample_and_one_without_a_good_one(capfd, tmp_path):
    for name, text in {
        "one.csv": "time_seconds,dioptres\n3,1\n",
        "none.csv": "time_seconds,dioptres\n0,\n1,\n2,\n",
    }.items():
        (tmp_path / name).write_text(text)
        outcome = run_andon(capfd, "gaze", tmp_path / name, "-o", tmp_path / name[:3])
        assert outcome.code == 0, outcome.err
        assert {path.name for path in (tmp_path / name[:3]).iterdir()} == FILES


@pytest.mark.parametrize(
    ("words", "rule"),
    [
        (("missing.csv", "-o", "out"), "must exist"),
        (("rays.csv", "-o", "no/out"), "make it"),
        (("rays.csv", "-o", "rays.csv"), "must be a folder"),
        (("rays.csv", "-o", "out", "--filter", "one-eur"), "did you mean 'one-euro'"),
        (("rays.csv", "-o", "out", "--rate", "0"), "--rate"),
        (("eye.asc", "-o", "out"), "where on a screen"),
        (("rays.txt", "-o", "out"), "must be one of .asc, .csv"),
        (("bad.csv", "-o", "out"), "must have the columns"),
    ],
)
def test_refusals_write_nothing(recording, capfd, monkeypatch, words, rule):
    folder = recording.parent
    monkeypatch.chdir(folder)
    (folder / "eye.asc").write_text(EYELINK)
    (folder / "rays.txt").write_text("a")
    (folder / "bad.csv").write_text("a,b\n1,2\n")
    assert rule in run_refused(capfd, folder, "gaze", *words)
