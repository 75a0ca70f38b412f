"""`andon glare IN -o OUT`: pictures, light, sheets, maps, reports, and what is refused."""

import json

import numpy as np
import pytest

from andon.display.false_colour import GAP_PX
from andon.files.pictures import read_picture, write_exr, write_hdr, write_png
from requirements import required

from .command import run_andon, run_refused

HEIGHT, WIDTH = 48, 64


def night():
    """A dim wall and a lamp, cd/m²."""
    light = np.full((HEIGHT, WIDTH, 3), 0.5, np.float32)
    light[20:23, 30:33] = [9e3, 7e3, 4e3]
    return light


@pytest.fixture
def folder(tmp_path, monkeypatch):
    write_exr(tmp_path / "night.exr", night(), unit="cd/m2")
    write_exr(tmp_path / "free.exr", night(), unit="relative", photometry="relative")
    write_hdr(tmp_path / "night.hdr", night() / 179, view_line="-vtv -vh 40 -vv 30.5")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def glared(capfd, *words, out="out.exr"):
    outcome = run_andon(capfd, "glare", *words, "--engine", "reference", "-o", out)
    assert outcome.code == 0, outcome.err
    assert outcome.out == f"{out}\n"
    return outcome


def test_light_in_light_out(capfd, folder):
    outcome = glared(capfd, "night.exr", "--hfov-degrees", "40", "--report", "r.json")
    assert "cd/m²" in outcome.err
    assert "relative" not in outcome.err
    seen = read_picture(folder / "out.exr")
    assert seen.attributes["andon:unit"] == "cd/m2"
    assert seen.attributes["andon:photometry"] == "absolute"
    # The wall near the lamp is veiled, the lamp itself has lost what it gave.
    assert (seen.values[18, 31] > 0.6).all()
    assert (seen.values[21, 31] < night()[21, 31]).all()
    told = json.loads((folder / "r.json").read_text())
    assert told["photometry"] == "absolute"
    assert told["view"]["hfov_degrees"] == pytest.approx(40, abs=0.01)
    assert told["view"]["angles_from"] == "stated"
    (source,) = told["sources"]
    assert source["luminance_cd_m2"] == pytest.approx(
        float(night()[21, 31] @ [0.2126, 0.7152, 0.0722]), rel=1e-4
    )
    assert 5 < told["observer"]["pupil_mm"] < 8
    assert told["veil_cd_m2"]["map_file"] is None


def test_a_radiance_picture_comes_back_as_one(capfd, folder):
    glared(capfd, "night.hdr", "--report", "r.json", out="seen.hdr")
    told = json.loads((folder / "r.json").read_text())
    assert told["pixels"]["cd_m2_per_unit"] == 179
    assert told["view"]["angles_from"] == "VIEW line of the header"
    after = read_picture(folder / "seen.hdr")
    assert after.view_line is not None
    assert after.view_line.startswith("-vtv -vh 40 ")
    glared(capfd, "night.hdr", out="seen.exr")
    light = read_picture(folder / "seen.exr").values
    assert after.values * 179 == pytest.approx(light, rel=0.02)


def test_ages_side_by_side(capfd, folder):
    words = ["free.exr", "--age", "20,45,70", "--compare", "--report", "r.json"]
    outcome = glared(capfd, *words, out="ages.png")
    assert "60°" in outcome.err
    assert "relative" in outcome.err
    sheet = read_picture(folder / "ages.png").values
    gap = GAP_PX
    assert sheet.shape[1] == 4 * WIDTH + 3 * gap
    tiles = [sheet[-HEIGHT:, at : at + WIDTH] for at in np.arange(4) * (WIDTH + gap)]
    # Paper between them, and captions of several lines over pictures as narrow as these.
    assert (sheet[:, WIDTH : WIDTH + gap] > 230).all()
    assert sheet.shape[0] > HEIGHT + 3 * 22
    # The wall beside the lamp, at one exposure for all: darker before than after, and so with age.
    beside = [tile[24:27, 34:37].mean() for tile in tiles]
    assert beside == sorted(beside)
    assert beside[3] > beside[0] + 3
    reports = json.loads((folder / "r.json").read_text())
    assert [told["observer"]["age_years"] for told in reports] == [20, 45, 70]
    veils = [told["veil_cd_m2"]["gaze"] for told in reports]
    assert veils == sorted(veils)


def test_a_night_stays_dark(capfd, folder):
    """A wall with bright windows in it is exposed lower than the wall alone."""
    rng = np.random.default_rng(5)
    wall = np.exp(rng.normal(0, 0.3, (HEIGHT, WIDTH, 1))) * np.ones(3)
    lights = wall.copy()
    lights[rng.random((HEIGHT, WIDTH)) < 0.03] *= 300
    shown: list[float] = []
    for name, light in (("even", wall), ("lights", lights)):
        write_exr(folder / f"{name}.exr", light.astype(np.float32), unit="cd/m2")
        outcome = glared(capfd, f"{name}.exr", "--hfov-degrees", "40", out="o.png")
        shown.append(float(outcome.err.partition("exposure ")[2].split()[0]))
    # Middle grey of the log mean, which is 1; lights are in 3 % of the pixels.
    assert shown[0] == pytest.approx(0.18, rel=0.1)
    assert shown[1] < 0.6 * shown[0]


def test_bright_walls_are_not_all_white(capfd, folder):
    """A third of a dark room is a lit wall, two decades up: the log mean alone would lose it."""
    light = np.full((30, 30, 3), 0.05, np.float32)
    light[20:] = 5.0
    write_exr(folder / "room.exr", light, unit="cd/m2")
    outcome = glared(capfd, "room.exr", "--hfov-degrees", "40", out="o.png")
    shown = float(outcome.err.partition("exposure ")[2].split()[0])
    assert shown == pytest.approx(1 / 5, rel=1e-3)


def test_the_first_command_is_shown(capfd):
    for words in ([], ["--help"]):
        outcome = run_andon(capfd, "glare", *words)
        assert outcome.code == 0
        assert "night.hdr" in outcome.out
        assert outcome.err == ""


def test_glare_alone(capfd, folder):
    glared(capfd, "night.exr", "--glare-only", out="veil.exr")
    veil = read_picture(folder / "veil.exr")
    assert veil.alpha is not None
    assert (veil.alpha == 0).all()
    assert (veil.values >= 0).all()
    glared(capfd, "night.exr", out="all.exr")
    whole = read_picture(folder / "all.exr").values
    assert (veil.values <= whole * 1.001).all()
    glared(capfd, "night.exr", "--glare-only", out="veil.png")
    picture = read_picture(folder / "veil.png").values
    assert picture[0, 0].max() < picture[18, 31].min()


def test_a_picture_without_sources_is_told(capfd, folder):
    write_exr(folder / "even.exr", np.full((8, 12, 3), 0.5, np.float32), unit="relative")
    words = ["even.exr", "--renderer", "per-source"]
    assert "nothing is scattered" in glared(capfd, *words).err
    assert (read_picture(folder / "out.exr").values == 0.5).all()
    whole = glared(capfd, "even.exr").err
    assert "nothing is scattered" not in whole
    assert "the eye is mesopic, its pupil 5 mm" in whole


def test_a_panorama_of_another_shape_is_told(capfd, folder):
    assert "64×48 is no 2:1" in glared(capfd, "night.exr", "--projection", "latlong").err
    assert "2:1" not in glared(capfd, "night.exr").err


def test_veil_maps(capfd, folder):
    words = ["night.exr", "--hfov-degrees", "40", "--gaze", "40,25", "--report", "r.json"]
    glared(capfd, *words, "--veil-map", "veil.exr", out="a.png")
    veil = read_picture(folder / "veil.exr")
    told = json.loads((folder / "r.json").read_text())["veil_cd_m2"]
    assert told["map_file"] == "veil.exr"
    assert told["gaze"] == pytest.approx(
        float(veil.values[25, 40] @ [0.2126, 0.7152, 0.0722]), rel=0.05
    )
    glared(capfd, *words, "--veil-map", "veil.png", out="b.png")
    assert read_picture(folder / "veil.png").values.shape[0] == HEIGHT


def test_eyes_differ(capfd, folder):
    def wall(*words, row=40, column=5):
        glared(capfd, "night.exr", *words)
        return float(read_picture(folder / "out.exr").values[row, column].mean())

    brown, blue = wall("--age", "60"), wall("--age", "60", "--pigment", "blue")
    assert blue > brown
    assert wall("--age", "60", "--pigment", "0.5") == pytest.approx(brown)
    assert wall("--age", "60", "--glasses", "contact") > brown
    assert wall("--age", "60", "--mist", "1") > brown
    # By IJspeert the pupil matters near the lamp alone.
    words = "--model", "ijspeert", "--pupil"
    small, wide = (wall(*words, mm, row=18, column=31) for mm in ("2", "7"))
    assert small != pytest.approx(wide, rel=1e-3)


def test_8_bits_are_taken_with_a_warning(capfd, folder):
    codes = np.full((HEIGHT, WIDTH, 3), 30, np.uint8)
    codes[20:23, 30:33] = 255
    write_png(folder / "lamp.png", codes)
    words = ["lamp.png", "--luminance-scale", "5000", "--report", "r.json"]
    outcome = glared(capfd, *words, out="out.png")
    assert "9 pixels are at the white" in outcome.err
    told = json.loads((folder / "r.json").read_text())
    assert told["photometry"] == "absolute"
    assert [source["clipped"] for source in told["sources"]] == [True]
    assert any("clipped" in line for line in told["warnings"])
    seen = read_picture(folder / "out.png").values
    assert abs(int(seen[0, 0, 0]) - 30) < 8


def test_what_is_no_light_is_counted(capfd, folder):
    light = night()
    light[0, 0], light[0, 1], light[0, 2] = np.nan, np.inf, -1
    write_exr(folder / "bad.exr", light, unit="cd/m2")
    glared(capfd, "bad.exr", "--report", "r.json")
    told = json.loads((folder / "r.json").read_text())
    assert [told["pixels"][key] for key in ("nan", "infinite", "negative")] == [1, 1, 1]
    assert np.isfinite(read_picture(folder / "out.exr").values).all()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["night.exr", "-o", "o.png", "--model", "spincer"], "perhaps spencer"),
        (["night.exr", "-o", "o.png", "--age", "121"], "--age"),
        (["night.exr", "-o", "o.png", "--age", "20,,70"], "--age"),
        (["night.exr", "-o", "o.png", "--age", "-1"], "--age"),
        (["night.exr", "-o", "o.png", "--pigment", "purple"], "--pigment"),
        (["night.exr", "-o", "o.png", "--pupil", "0"], "--pupil"),
        (["night.exr", "-o", "o.png", "--glasses", "sun"], "--glasses"),
        (["night.exr", "-o", "o.png", "--mist", "nan"], "--mist"),
        (["night.exr", "-o", "o.png", "--renderer", "fast"], "--renderer"),
        (["night.exr", "-o", "o.png", "--projection", "mercator"], "--projection"),
        (["night.exr", "-o", "o.png", "--projection", "latlong", "--hfov-degrees", "90"], "360"),
        (["night.exr", "-o", "o.png", "--hfov-degrees", "180"], "hfov"),
        (["night.exr", "-o", "o.png", "--luminance-scale", "0"], "> 0"),
        (["night.exr", "-o", "o.png", "--gaze", "64,3"], "--gaze"),
        (["night.exr", "-o", "o.png", "--gaze", "3"], "--gaze"),
        (["night.exr", "-o", "o.png", "--exposure", "bright"], "--exposure"),
        (["night.exr", "-o", "night.exr"], "overwritten"),
        (["night.exr", "-o", "o.exr", "--report", "o.json", "--veil-map", "o.exr"], "overwritten"),
        (["night.exr", "-o", "o.exr", "--age", "20,70"], "sheet"),
        (["night.exr", "-o", "o.exr", "--compare"], "sheet"),
        (["night.exr", "-o", "o.png", "--age", "20,70", "--veil-map", "v.exr"], "one eye"),
        (["night.exr", "-o", "nowhere/o.png"], "does not exist"),
        (["night.exr", "-o", "o.gif"], "must end in"),
        (["night.exr", "-o", "o.png", "--report", "r.txt"], "must end in"),
        (["night.exr", "-o", "o.png", "--evalglare"], "--report"),
        (
            [
                "free.exr",
                "-o",
                "o.png",
                "--evalglare",
                "--report",
                "r.json",
                "--projection",
                "latlong",
            ],
            "fish-eye",
        ),
        (["missing.exr", "-o", "o.png"], "must exist"),
        (["nothing.exr", "-o", "o.png"], "no pixel that is a number"),
        (["psff", "-o", "o.png"], "perhaps andon glare psf"),
        (["night.exr"], "see andon glare picture --help"),
        (["night.exr", "-o", "o.png", "--exposure", "0"], "number > 0"),
        (["night.exr", "-o", "o.png", "--camera", "none.toml"], "must exist"),
        (["night.exr", "-o", "o.png", "--camera", "c.toml", "--projection", "pinhole"], "--camera"),
        (["huge.hdr", "-o", "o.png"], "at most"),
        (["empty.hdr", "-o", "o.png"], "at least"),
        (["axial.hdr", "-o", "o.png"], "no angular scale"),
    ],
)
def test_refusals(capfd, folder, words, said):
    head = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n{}\n-Y {} +X {}\n"
    (folder / "huge.hdr").write_text(head.format("", 10000, 10000))
    (folder / "empty.hdr").write_text(head.format("", 0, 10))
    pixels = (folder / "night.hdr").read_bytes().replace(b"-vtv", b"-vtl")
    (folder / "axial.hdr").write_bytes(pixels)
    write_exr(folder / "nothing.exr", np.full((4, 8, 3), np.nan, np.float32), unit="cd/m2")
    outcome = run_refused(capfd, folder, "glare", *words)
    assert said in outcome


def test_radiances_numbers_stand_beside_ours(capfd, folder):
    required("pyradiance")
    view = ["--projection", "fisheye", "--hfov-degrees", "180"]
    glared(capfd, "night.exr", *view, "--evalglare", "--report", "r.json")
    told = json.loads((folder / "r.json").read_text())
    assert told["evalglare"]["sources"] == 1
    assert told["evalglare"]["E_v"] == pytest.approx(told["levels"]["vertical_lux"], rel=0.05)
    assert told["evalglare"]["ugr"] == pytest.approx(told["ugr"], abs=0.5)


def test_a_camera_file_gives_the_angles(capfd, folder):
    camera = f'[camera]\nprojection = "fisheye"\nwidth = {WIDTH}\nheight = {HEIGHT}\n'
    (folder / "c.toml").write_text(camera + "hfov_degrees = 120\n")
    glared(capfd, "night.exr", "--camera", "c.toml", "--report", "r.json")
    told = json.loads((folder / "r.json").read_text())
    assert told["view"]["projection"] == "fisheye"
    assert told["view"]["hfov_degrees"] == pytest.approx(120)
