"""`andon fuse` from photographs to pictures and light; `andon relight --seen`."""

import json

import numpy as np
import pytest
from PIL import Image

from andon.files.pictures import read_picture, write_png
from andon.files.responses import read_response
from capture.test_brackets import TIMES, hand_held, light, photographed
from worlds import write_relight_files

from .command import PHOTOGRAPHED, run_andon, run_refused

NAMES = ("dark.png", "middle.png", "bright.png")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    for name, codes in zip(NAMES, photographed(light(), TIMES), strict=True):
        write_png(tmp_path / name, codes)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def fused(capfd, *words, out="out.png"):
    outcome = run_andon(capfd, "fuse", *words, "-o", out)
    assert outcome.code == 0, outcome.err
    assert outcome.out == f"{out}\n"
    return outcome


def test_a_picture_needs_no_times(capfd, folder):
    outcome = fused(capfd, *NAMES, "--sheet", "sheet.png")
    assert outcome.err == ""
    picture = read_picture(folder / "out.png").values
    assert picture.shape == (120, 160, 3)
    assert 90 < picture.mean() < 165
    clipped = [(read_picture(name).values >= 250).mean() for name in NAMES]
    assert (picture >= 250).mean() < 0.3 * max(clipped)
    sheet = read_picture(folder / "sheet.png").values
    assert sheet.shape[1] == 4 * 160
    assert (sheet[-120:, -160:] == picture).mean() > 0.99


@pytest.mark.parametrize("suffix", ["exr", "hdr"])
def test_light_is_written_with_its_range(capfd, folder, suffix):
    out = f"out.{suffix}"
    words = [*NAMES, "--seconds", "1/320,1/80,0.05", "--response", "camera.csv"]
    outcome = fused(capfd, *words, "--sheet", "sheet.png", out=out)
    assert "relative light: 1 is white in middle.png as sRGB has it; range" in outcome.err
    picture = read_picture(folder / out)
    if suffix == "exr":
        assert picture.attributes["andon:photometry"] == "relative"
    known = light() * 0.4
    inside = (known > 0.02) & (known < 1.5)
    ratio = picture.values[inside] / known[inside]
    assert np.percentile(np.abs(np.log(ratio)), 95) < 0.1
    assert picture.values.max() > 2
    response = read_response(folder / "camera.csv")
    # At mid-grey the camera was sRGB's; white is where the recovered curve puts it.
    decoded = response.decode(np.array([[0.25] * 3, [0.5] * 3]))
    np.testing.assert_allclose(decoded[0] / decoded[1], 0.0509 / 0.2140, rtol=0.1)


def test_times_from_exif_and_from_a_list(capfd, folder):
    fused(capfd, *NAMES, "--seconds", "1/320,1/80,1/20", out="typed.exr")
    (folder / "list.txt").write_text("dark.png 0.003125\nmiddle.png 0.0125\nbright.png 0.05\n")
    fused(capfd, "--list", "list.txt", out="listed.exr")
    fused(capfd, *NAMES[::-1], "--list", "list.txt", out="chosen.exr")
    stated = []
    # The third was exposed as long as the second, but at four times the sensitivity.
    for name, seconds, iso in zip(NAMES, (1 / 320, 1 / 80, 1 / 80), (100, 100, 400), strict=True):
        exif = Image.Exif()
        exif[0x8769] = {0x829A: seconds, 0x829D: 5.6, 0x8827: iso}
        stated.append(f"exif-{name}")
        Image.open(name).save(stated[-1], exif=exif)
    fused(capfd, *stated, out="stated.exr")
    typed = read_picture("typed.exr").values
    for name in ("listed", "chosen", "stated"):
        np.testing.assert_allclose(read_picture(f"{name}.exr").values, typed, rtol=1e-4)


def test_hand_held_photographs_are_aligned_and_cropped(capfd, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    taken, _ = hand_held([(7, -4, 0), (0, 0, 0), (-12, 9, 0)])
    for name, codes in zip(NAMES, taken.codes, strict=True):
        write_png(tmp_path / name, codes)
    outcome = fused(capfd, *NAMES, "--align", "shift")
    assert "dark.png lies +7.0, -4.0 px off middle.png, turned by +0.00°: aligned" in outcome.err
    assert "cropped to 241×187 of 260×200 px" in outcome.err
    assert read_picture("out.png").shape == (187, 241)
    assert fused(capfd, *NAMES, "--align", "none").err == ""


REFUSED = [
    (["-o", "o.png"], "PHOTOS: are missing"),
    ([NAMES[0], "-o", "o.png"], "is one photograph, and no series of exposures"),
    ([*NAMES, "-o", "o.gif"], "must end in .png, .jpg, .jpeg, .exr, .hdr"),
    ([*NAMES, "-o", "o.exr"], "exposure times are not known"),
    ([*NAMES, "-o", "o.exr", "--seconds", "1,2"], "must be 3 exposures"),
    ([*NAMES, "-o", "o.exr", "--seconds", "1,2,x"], "numbers or fractions > 0, got 'x'"),
    ([*NAMES, "-o", "o.exr", "--seconds", "1,2,1/0"], "numbers or fractions > 0"),
    ([*NAMES, "-o", "o.exr", "--seconds", "1,2,nan"], "numbers or fractions > 0"),
    ([*NAMES, "-o", "o.exr", "--seconds", "4,2,1"], "though it is exposed longer"),
    ([*NAMES, "-o", "o.exr", "--seconds", "1,1,1"], "all photographs are exposed for 1 s"),
    ([*NAMES, "-o", "o.exr", "--seconds", "1,2,4", "--list", "l.txt"], "one of --seconds and"),
    ([*NAMES, "-o", "o.png", "--align", "magic"], "must be one of auto, none, shift, ecc"),
    ([*NAMES, "-o", "o.png", "--response", "r.csv"], "recovered where light is merged"),
    ([*NAMES, "-o", NAMES[1]], "would be overwritten"),
    ([*NAMES, "-o", "o.png", "--sheet", "o.png"], "would be overwritten"),
    ([*NAMES, "-o", "o.png", "--list", "list.txt"], "does not name 'dark.png'"),
    (["--list", "list.txt", "-o", "o.png"], "gone.png: must exist"),
    (["small.png", *NAMES, "-o", "o.png"], "is 160×120 px but small.png is 5×4"),
    (["light.exr", *NAMES, "-o", "o.png"], "is light already"),
]


@pytest.mark.parametrize(("words", "rule"), REFUSED)
def test_refusals(capfd, folder, words, rule):
    from andon.files.pictures import write_exr

    (folder / "list.txt").write_text("gone.png 1\nlost.png 2\n")
    write_png(folder / "small.png", np.full((4, 5, 3), 99, np.uint8))
    write_exr(folder / "light.exr", np.ones((120, 160, 3), np.float32), unit="relative")
    assert rule in run_refused(capfd, folder, "fuse", *words)


@pytest.fixture
def see_through(tmp_path, monkeypatch):
    write_relight_files(tmp_path)
    display = "[display]\nmode = 'ost'\npeak_luminance_cd_m2 = 200\ntransmittance = 0.5\n"
    lamp = "[[lamp]]\nname = 'bulb'\nkind = 'point'\nposition = [0.5, 0.3, -1.2]\nflux_lm = 900\n"
    (tmp_path / "ost.toml").write_text(PHOTOGRAPHED + display + lamp)
    (tmp_path / "vst.toml").write_text(PHOTOGRAPHED + lamp)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_simulated_view_of_a_see_through_display(engine, capfd, see_through):
    words = ["relight", "--scene", "ost.toml", "--engine", engine, "-o", "display.png"]
    outcome = run_andon(capfd, *words, "--seen", "seen.exr")
    assert outcome.code == 0, outcome.err
    assert "out of the display's reach: " in outcome.err
    assert "brighter than it can add" in outcome.err
    video = run_andon(capfd, "relight", "--scene", "vst.toml", "--engine", engine, "-o", "vst.exr")
    assert video.code == 0
    wanted, seen = read_picture("vst.exr").values, read_picture("seen.exr")
    assert seen.attributes["andon:unit"] == "cd/m2"
    # Reachable everywhere but where the lamp shines most; 8 bits of 200 cd/m² are coarse.
    near = np.abs(seen.values - wanted) <= 0.02 * wanted + 1.0
    assert near.mean() > 0.8
    assert run_andon(capfd, *words, "--seen", "seen.png").code == 0
    shown, codes = read_picture("seen.png").values, read_picture("display.png").values
    assert shown.shape == codes.shape
    assert shown.mean() > codes.mean()


def test_a_video_display_has_no_simulated_view(capfd, see_through):
    words = ["relight", "--scene", "vst.toml", "-o", "o.png", "--seen", "seen.png"]
    line = run_refused(capfd, see_through, *words)
    assert "--seen: simulates an optical see-through display" in line
    assert json.dumps("ost") in line
