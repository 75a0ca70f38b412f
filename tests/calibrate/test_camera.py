"""Responses from exposure series: known cameras come back, contradictions are refused."""

import json
from dataclasses import replace

import numpy as np
import pytest

from andon.calibrate.camera import calibrate_camera, check_calibration, check_still
from andon.calibrate.camera_figure import COLOURS, camera_figure
from andon.calibrate.camera_residuals import residuals_of
from andon.capture.brackets import bracket_of
from andon.errors import InputError
from andon.files.pictures import read_picture, write_png
from andon.files.responses import read_response
from capture.test_brackets import PLEASING, TIMES, bracket, hand_held, light, photographed
from cli.command import run_andon, run_refused

SEVEN = [2.0**-k for k in range(7)]
NAMES = [f"{k}.png" for k in range(7)]
NOISE = 1.5


@pytest.fixture(scope="module")
def series():
    return bracket(light(decades=3.5), SEVEN, response=PLEASING, noise=NOISE)


@pytest.fixture(scope="module")
def calibration(series):
    return calibrate_camera(series)


def test_a_known_camera_comes_back_and_only_its_noise_is_left(series, calibration):
    codes = np.arange(20, 236)
    wanted = PLEASING.decode(np.repeat(codes[:, None] / 255, 3, axis=1))
    wanted = wanted / PLEASING.decode(np.full((1, 3), 128 / 255))
    found = np.exp(calibration.recovery.curves[codes])
    np.testing.assert_allclose(found, wanted, rtol=0.04)
    # Noise of a photograph and of its prediction, and rounding of both.
    assert NOISE < calibration.residuals.rms_codes < 1.6 * NOISE
    assert calibration.residuals.photograph_codes.shape == (7,)
    assert np.abs(calibration.exposure_error_ev).max() < 0.01
    assert calibration.kept_share > 0.9
    check_calibration(series, calibration)


def test_the_residual_of_a_curve_that_knows_nothing_is_larger(series, calibration):
    straight = np.repeat(np.log((np.arange(256) + 0.5) / 128.5)[:, None], 3, axis=1)
    assert residuals_of(series, straight).rms_codes > 5 * calibration.residuals.rms_codes


@pytest.mark.parametrize(("count", "wrong"), [(7, 2), (7, 6), (3, 1)])
def test_a_wrong_time_is_told_from_the_pictures(count, wrong):
    is_wrong = np.arange(count) == wrong
    stated = np.array(SEVEN[:count]) * np.where(is_wrong, 2**0.5, 1)
    scene = light(decades=3.5)
    taken = bracket_of(NAMES[:count], photographed(scene, SEVEN[:count], noise=NOISE), stated)
    found = calibrate_camera(taken).exposure_error_ev
    assert found[wrong] == pytest.approx(-0.5, abs=0.06)
    assert np.abs(found[~is_wrong]).max() < 0.03


def test_two_photographs_say_nothing_of_their_times():
    taken = bracket(light(), [1.0, 2.0])
    assert np.isnan(calibrate_camera(taken).exposure_error_ev).all()


def test_a_time_that_the_picture_contradicts_is_refused():
    seconds = 4.0 ** -np.arange(5)
    stated = seconds * np.where(np.arange(5) == 2, 2.5, 1)  # still between its neighbours
    taken = bracket_of(NAMES[:5], photographed(light(decades=3.5), seconds), stated)
    with pytest.raises(InputError, match=r"2\.png: --seconds: is exposed 1\.\d EV less than stat"):
        check_calibration(taken, calibrate_camera(taken))


def test_codes_without_data_are_named():
    """A scene in two tones leaves most of the range to the neighbours."""
    scene = np.full((60, 80, 3), 0.05)
    scene[:, 40:] = 0.5
    found = calibrate_camera(bracket(scene, [0.5, 1.0, 2.0], noise=0.8))
    runs = found.unsupported(1)
    missing = sum(last - first + 1 for first, last in runs)
    assert 150 < missing < 250
    assert runs[0][0] == 0
    assert runs[-1][1] == 255
    support = found.recovery.channels[1].support
    for first, last in runs:
        assert (support[first : last + 1] < 4).all()


def dipping(codes):
    """From 120 to 200 the codes run backwards: more light, less code."""
    return np.where((codes >= 120) & (codes <= 200), 320 - codes.astype(int), codes).astype(
        np.uint8
    )


@pytest.fixture(scope="module")
def backwards():
    """Photographs of a camera whose response falls."""
    wide = photographed(light(decades=3.5), SEVEN, noise=0.5)
    return bracket_of(NAMES, [dipping(codes) for codes in wide], SEVEN)


def test_a_camera_without_a_rising_response_is_refused(backwards):
    found = calibrate_camera(backwards)
    for channel in found.recovery.channels:
        assert channel.fall is not None
        assert 115 <= channel.fall.codes[0] < channel.fall.codes[1] <= 205
        assert channel.fall.ev > 8 * channel.fall.noise_ev
        assert (np.diff(channel.rising) >= 0).all()
    with pytest.raises(InputError, match=r"response falls by|contradict each other by"):
        check_calibration(backwards, found)


def test_a_fall_beyond_noise_is_refused_and_one_within_it_is_levelled(series, calibration):
    from andon.capture.recovery import Fall, Recovery

    def fallen(fall):
        red = replace(calibration.recovery.channels[0], fall=fall)
        channels = (red, *calibration.recovery.channels[1:])
        return replace(calibration, recovery=Recovery(channels))

    check_calibration(series, fallen(Fall((200, 210), 0.15, 0.10)))
    with pytest.raises(InputError, match=r"red channel's response falls by 0\.50 EV from code 200"):
        check_calibration(series, fallen(Fall((200, 210), 0.5, 0.05)))


def test_what_moved_and_what_is_clipped_does_not_bend_the_curve(calibration):
    scene = light(decades=3.5)
    codes = photographed(scene, SEVEN, response=PLEASING, noise=NOISE)
    codes[1][20:60, 30:80] = 180
    codes[5][50:90, 90:130] = 90
    scene[:15, :40] = 1e4
    found = calibrate_camera(bracket_of(NAMES, codes, SEVEN))
    wanted = calibration.recovery.curves[20:236]
    assert np.abs(found.recovery.curves[20:236] - wanted).max() < 0.06
    assert found.kept_share < calibration.kept_share


def test_a_camera_that_moved_is_refused_with_how_far():
    taken, _ = hand_held([(7, -4, 0), (0, 0, 0), (-12, 9, 0)])
    with pytest.raises(InputError, match=r"lies \+7\.\d, -4\.\d px off .*after alignment"):
        check_still(taken)
    still, _ = hand_held([(0, 0, 0)] * 3)
    check_still(still)


def test_another_place_is_no_exposure_of_this_one():
    scenes = [light(decades=3.5, seed=s) for s in (1, 20, 40)]
    codes = [photographed(s, TIMES)[k] for k, s in enumerate(scenes)]
    taken = bracket_of(["a", "b", "c"], codes, TIMES)
    with pytest.raises(InputError, match=r"contradict each other by \d+ codes"):
        check_calibration(taken, calibrate_camera(taken))


def test_the_figure_has_three_diagrams_and_three_colours(series, calibration):
    picture = camera_figure(series, calibration)
    assert picture.shape == (560 + 340 + 300, 1200, 3)
    for colour in COLOURS:
        assert (np.abs(picture.astype(int) - colour).max(axis=-1) < 30).sum() > 500
    assert camera_figure(series, replace(calibration, exposure_error_ev=np.full(7, np.nan))).shape[
        0
    ] == (560 + 340)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    for name, codes in zip("abc", photographed(light(decades=3.0), TIMES), strict=True):
        write_png(tmp_path / f"{name}.png", codes)
    monkeypatch.chdir(tmp_path)
    return tmp_path


ABC = ["a.png", "b.png", "c.png"]
TYPED = [*ABC, "--seconds", "1/320,1/80,1/20"]


def test_the_command_writes_what_a_scene_names(capfd, folder):
    words = [*TYPED, "-o", "camera.csv", "--figure", "camera.png", "--json", "camera.json"]
    outcome = run_andon(capfd, "calibrate", "response", *words)
    assert outcome.code == 0, outcome.err
    assert outcome.out.split() == ["camera.csv", "camera.png", "camera.json"]
    assert "relative response, 1 is white" in outcome.err
    response = read_response("camera.csv")
    decoded = response.decode(np.array([[0.25] * 3, [0.5] * 3]))
    np.testing.assert_allclose(decoded[0] / decoded[1], 0.0509 / 0.2140, rtol=0.05)
    facts = json.loads((folder / "camera.json").read_text())
    assert facts["photometry"] == "relative"
    assert [p["file"] for p in facts["photographs"]] == ABC
    assert abs(facts["photographs"][1]["exposure_error_ev"]) < 0.02
    assert facts["channels"]["green"]["is_monotone"] is True
    assert read_picture("camera.png").shape == (1200, 1200)


REFUSED = [
    (["-o", "o.csv"], "PHOTOS: are missing"),
    ([*ABC, "-o", "o.csv"], "exposure times are not known"),
    ([ABC[0], "--seconds", "1", "-o", "o.csv"], "is one photograph, and no series"),
    ([*TYPED, "-o", "o.toml"], "must end in .csv"),
    ([*TYPED, "-o", "o.csv", "--figure", "o.svg"], "must end in .png"),
    ([*TYPED, "-o", "o.csv", "--json", "o.csv"], "must end in .json"),
    ([*TYPED, "-o", "o.csv", "--figure", "a.png"], "would be overwritten"),
    ([*ABC, "--seconds", "4,2,1", "-o", "o.csv"], "though it is exposed longer"),
    ([*ABC[:2], "small.png", "--seconds", "1,2,4", "-o", "o.csv"], "is 5×4 px but a.png is 160"),
    (["black.png", "white.png", "--seconds", "1,2", "-o", "o.csv"], "every pixel of every"),
    ([*TYPED, "--align", "x", "-o", "o.csv"], "must be one of auto, none"),
]


@pytest.mark.parametrize(("words", "rule"), REFUSED)
def test_refusals(capfd, folder, words, rule):
    write_png(folder / "small.png", np.full((4, 5, 3), 99, np.uint8))
    for name, code in (("black", 0), ("white", 255)):
        write_png(folder / f"{name}.png", np.full((9, 9, 3), code, np.uint8))
    assert rule in run_refused(capfd, folder, "calibrate", "response", *words)
