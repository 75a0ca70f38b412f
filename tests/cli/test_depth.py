"""`andon depth fit` and `andon depth import`, from files to files."""

import json

import numpy as np
import pytest

from andon.files import read_camera, read_depth_array, read_picture, write_camera, write_png
from andon.files.captures import FORMATS
from andon.scene import load_scene
from andon.surface.load import load_surface
from calibrate.rooms import HEIGHT_M, PARTS, VIEW, Z, affine, length
from captures.folders import WRITERS
from comparison import assert_agree

from .command import run_andon, run_refused

BACK, FLOOR, ACROSS = (
    length((10, 20), (70, 20)),
    length((30, 110), (100, 110)),
    length((150, 40), (20, 100)),
)


def word(known):
    (x1, y1), (x2, y2) = known.first, known.second
    return f"{x1},{y1},{x2},{y2}={known.metres:.9f}"


LENGTHS = [w for known in (BACK, FLOOR, ACROSS) for w in ("--length", word(known))]


@pytest.fixture(params=["inverse", "depth"])
def kind(request):
    return request.param


@pytest.fixture
def folder(tmp_path, monkeypatch):
    for kind in ("inverse", "depth"):
        np.save(tmp_path / f"{kind}.npy", affine(kind)[0].values)
    write_camera(tmp_path / "cam.toml", VIEW)
    mask = np.where(PARTS["floor"].mask, 255, 0).astype(np.uint8)
    write_png(tmp_path / "floor.png", mask)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def fitted(capfd, kind, *words, out="out.exr"):
    outcome = run_andon(
        capfd,
        "depth",
        "fit",
        f"{kind}.npy",
        "--kind",
        kind,
        "--camera",
        "cam.toml",
        *words,
        "-o",
        out,
    )
    assert outcome.code == 0, outcome.err
    assert outcome.out == f"{out}\n"
    return outcome


def test_lengths_become_metres(capfd, folder, kind):
    outcome = fitted(capfd, kind, *LENGTHS, "--json", "fit.json", "--figure", "fit.png")
    assert_agree(read_depth_array(folder / "out.exr"), Z, rtol=1e-6)
    report = json.loads((folder / "fit.json").read_text())
    _, a, b = affine(kind)
    assert_agree([report["scale"], report["shift"]], [a, b], rtol=1e-6)
    assert not report["shift_is_assumed"]
    assert [row["unit"] for row in report["constraints"]] == ["m"] * 3
    assert max(abs(row["residual"]) for row in report["constraints"]) < 1e-6
    assert 0.01 < report["depth"]["median"]["standard_error_share"] < 0.05
    assert "length 10,20 to 70,20" in outcome.err
    assert "±" in outcome.err
    figure = read_picture(folder / "fit.png").values
    assert figure.shape[1] > 2 * 900
    assert len(np.unique(figure.reshape(-1, 3), axis=0)) > 50


def test_a_table_for_the_scene_says_the_same(capfd, folder, kind):
    fitted(capfd, kind, *LENGTHS, out="surface.toml")
    table = (folder / "surface.toml").read_text()
    (folder / "scene.toml").write_text(f'[rig.camera]\nfile = "cam.toml"\n{table}')
    model = load_surface(load_scene(folder / "scene.toml"), {"mono": VIEW})
    fitted(capfd, kind, *LENGTHS)
    assert_agree(model.depth["mono"], read_depth_array(folder / "out.exr"), rtol=1e-6)
    assert_agree(model.depth["mono"], Z, rtol=1e-7)


def test_holes_stay_in_both(capfd, folder):
    values = affine("inverse")[0].values.copy()
    values[3, 4] = -1.0
    np.save(folder / "inverse.npy", values)
    for out in ("out.exr", "surface.toml"):
        fitted(capfd, "inverse", *LENGTHS, "--invalid", "-1", out=out)
    assert np.isnan(read_depth_array(folder / "out.exr")[3, 4])
    assert "invalid = [-1.0]" in (folder / "surface.toml").read_text()


def test_a_floor_by_a_painted_mask_and_its_height(capfd, folder):
    outcome = fitted(capfd, "inverse", "--floor", "floor.png", "--height", HEIGHT_M)
    assert_agree(read_depth_array(folder / "out.exr"), Z, rtol=1e-6)
    assert "floor's slope" in outcome.err
    fitted(capfd, "inverse", "--floor", "40,110,80,9", "--height", HEIGHT_M)
    assert_agree(read_depth_array(folder / "out.exr"), Z, rtol=1e-6)


def test_planes_at_right_angles(capfd, folder):
    words = ["--plane", "20,20,40,30", "--plane", "146,10,12,60", "--perpendicular", "1,2"]
    fitted(capfd, "inverse", *words, "--length", word(BACK))
    assert_agree(read_depth_array(folder / "out.exr"), Z, rtol=1e-6)


def test_metric_depth_in_millimetres(capfd, folder):
    sparse = np.where(np.arange(160) % 5 == 0, np.round(Z * 1000), 0).astype(np.uint16)
    write_png(folder / "lidar.png", sparse)
    outcome = fitted(capfd, "inverse", "--known", "lidar.png", "--known-scale-to-m", "0.001")
    assert_agree(read_depth_array(folder / "out.exr"), Z, rtol=1e-3)
    assert "outliers" in outcome.err


def test_depth_of_half_the_pixels_takes_pixels_of_the_photograph(capfd, folder):
    large = VIEW.resized(320, 240)
    write_camera(folder / "cam.toml", large)
    doubled = [f"{2 * x + 0.5}" for end in (BACK.first, BACK.second) for x in end]
    words = ["--length", ",".join(doubled) + f"={BACK.metres}", *LENGTHS[2:2]]
    words += ["--floor", "80,220,160,18"]
    fitted(capfd, "inverse", *words)
    assert_agree(read_depth_array(folder / "out.exr"), Z, rtol=1e-6)


def test_what_is_not_determined_is_said(capfd, folder):
    outcome = fitted(capfd, "inverse", "--length", word(BACK), "--json", "fit.json")
    assert "the shift is undetermined: taken as 0" in outcome.err
    assert json.loads((folder / "fit.json").read_text())["shift_is_assumed"]
    write_png(
        folder / "codes.png", np.round(affine("inverse")[0].values * 20).astype(np.uint8) - 20
    )
    outcome = run_andon(capfd, "depth", "fit", "codes.png", "--camera", "cam.toml", *LENGTHS,
                        "-o", "o.exr")  # fmt: skip
    assert outcome.code == 0, outcome.err


REFUSED = [
    ([], "the scale is undetermined; add --length"),
    (["--length", "1,2,3=4"], "must be X1,Y1,X2,Y2=METRES, got '1,2,3=4'"),
    (["--length", "1,2,3,4"], "must be X1,Y1,X2,Y2=METRES"),
    (["--length", "1,2,3,400=1"], "the pixel 3,400 is outside the photograph of 160×120 px"),
    (["--length", "1,2,1,2=1"], "it has no length"),
    (["--length", "10,20,70,20=0"], "must be > 0 m"),
    (["--at", "x,2=1"], "--at: must be X,Y=METRES"),
    (["--height", "1.5"], "is over a floor, and none is stated"),
    (["--plane", "0,0,900,2"], "must lie in the photograph"),
    (["--plane", "gone.png"], "must exist"),
    (["--plane", "small.png"], "is 8×6 px but the camera is 160×120"),
    (["--plane", "black.png", *LENGTHS], "--plane 1: selects 0 pixels with a depth"),
    (["--perpendicular", "1,2", *LENGTHS], "there are 0 planes, got '1,2'"),
    (["--known", "small.npy"], "is 12×6 px, the relative depth 160×120"),
    (["--known", "depth.npy", "--known-scale-to-m", "0"], "--known-scale-to-m: must be > 0"),
    ([*LENGTHS, "--length", "10,20,80,20=9"], "what is known contradicts itself"),
    ([*LENGTHS, "--kind", "depth"], "try --kind inverse"),
    ([*LENGTHS, "--figure", "fit.gif"], "must end in .png"),
    ([*LENGTHS, "--json", "cam.toml"], "must end in .json"),
    ([*LENGTHS, "-o", "x.npy"], "must end in .exr, .toml"),
    ([*LENGTHS, "-o", "sub/x.toml"], "a scene names no file outside its own folder"),
]


@pytest.mark.parametrize(("words", "rule"), REFUSED)
def test_bad_words_are_refused(capfd, folder, words, rule):
    (folder / "sub").mkdir()
    write_png(folder / "small.png", np.full((6, 8), 255, np.uint8))
    write_png(folder / "black.png", np.zeros((120, 160), np.uint8))
    np.save(folder / "small.npy", np.ones((6, 12)))
    base = ["depth", "fit", "inverse.npy", "--camera", "cam.toml"]
    out = [] if "-o" in words else ["-o", "o.exr"]
    assert rule in run_refused(capfd, folder, *base, *words, *out)


# ── captures ──────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("name", [name for name in FORMATS if name != "record3d"])
def test_an_imported_frame_is_a_scene(capfd, tmp_path, name):
    source = tmp_path / "capture"
    source.mkdir()
    intrinsics = WRITERS[name](source)
    outcome = run_andon(capfd, "depth", "import", source, "-o", tmp_path / "out")
    assert outcome.code == 0, outcome.err
    assert "1 of 1" in outcome.err
    scene = load_scene(tmp_path / "out" / "scene.toml")
    assert scene.scene.photometry == "relative"
    view = read_camera(scene.path(scene.rig.camera.file, "rig.camera.file"))
    assert_agree([view.fx, view.fy, view.cx, view.cy], intrinsics, rtol=1e-6)
    assert read_picture(scene.path(scene.capture.source, "capture.source")).shape == view.shape
    depth = read_depth_array(scene.path(scene.surface.depth.file, "surface.depth.file"))
    assert_agree(np.nanmax(depth), 4.0, rtol=1e-6)


def test_a_frame_by_name_by_number_and_another_camera(capfd, tmp_path):
    source = tmp_path / "capture"
    source.mkdir()
    WRITERS["slambook"](source)
    write_camera(tmp_path / "cam.toml", VIEW.resized(640, 480))
    base = ["depth", "import", source, "-o", tmp_path / "out"]
    for words in (["--frame", "2"], ["--frame", "0", "--camera", tmp_path / "cam.toml"]):
        outcome = run_andon(capfd, *base, *words)
        assert outcome.code == 0, outcome.err
    assert "intrinsics" not in outcome.err
    view = read_camera(tmp_path / "out" / "camera.toml")
    assert view.fx == VIEW.resized(640, 480).fx
    assert view.position[2] != 0  # the pose stays the capture's
    line = run_refused(capfd, tmp_path, *base, "--frame", "7")
    assert "must be one of 2, or a number below 1, got '7'" in line


def test_bad_captures_are_refused(capfd, tmp_path):
    (tmp_path / "empty").mkdir()
    (tmp_path / "file").write_text("x")
    for words, rule in [
        (["empty", "-o", "out"], "is no capture of a known format"),
        (["gone", "-o", "out"], "must exist"),
        (["empty", "-o", "file"], "must be a folder"),
        (["empty", "-o", "a/b"], "does not exist; make it"),
        (["empty", "-o", "empty"], "is the capture itself"),
    ]:
        paths = [tmp_path / w if not w.startswith("-") else w for w in words]
        assert rule in run_refused(capfd, tmp_path, "depth", "import", *paths)
