"""`andon relight` from files to files."""

import json
import subprocess
import sys

import numpy as np
import pytest

from andon.files.pictures import read_picture
from comparison import assert_agree, assert_same_picture
from worlds import block, write_glb, write_relight_files

from .command import run_andon

LAMP = "kind=point,position=-0.5,0.3,-1.2,flux_lm=800,temperature_k=2700"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    write_relight_files(tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def relight(capfd, *more, out="out.png"):
    base = ["relight", "photo.png", "--depth", "depth.npy", "--camera", "camera.toml"]
    outcome = run_andon(capfd, *base, *more, "-o", out)
    assert outcome.code == 0, outcome.err
    return outcome


def test_both_engines_write_the_same_picture(gpu, capfd, folder):
    for engine in ("gpu", "reference"):
        outcome = relight(
            capfd, "--lamp", LAMP, "--ambient-lux", 200, "--engine", engine,
            "--illuminance-map", f"{engine}.exr", "--illuminance-map", f"{engine}-lux.png",
            out=f"{engine}.png",
        )  # fmt: skip
        assert outcome.out == f"{engine}.png\n"
        assert engine in outcome.err
    pictures = {name: read_picture(folder / f"{name}.png").values for name in ("gpu", "reference")}
    assert_same_picture(pictures["gpu"], pictures["reference"], folder, share=0.01)
    photo = read_picture(folder / "photo.png").values
    assert np.abs(pictures["gpu"].astype(int) - photo).mean() > 3
    lux = {name: read_picture(folder / f"{name}.exr").values for name in ("gpu", "reference")}
    assert_agree(lux["gpu"], lux["reference"], rtol=3e-3, atol=0.1, share=0.01)
    scale = read_picture(folder / "gpu-lux.png").values
    assert scale.shape == (48, 64 + 74, 3)


def test_the_lux_of_the_file_are_those_of_the_lamp(capfd, folder):
    """Straight at the wall, 2.5 m away: 800 lm/4π over 2.5²; the red channel carries the warmth."""
    relight(
        capfd, "--lamp", "kind=point,position=0,0,0,flux_lm=800,shadow=false", "--ambient-lux", 200,
        "--engine", "reference", "--illuminance-map", "lux.exr",
    )  # fmt: skip
    lux = read_picture(folder / "lux.exr").values
    away = 2.5 * np.sqrt(1 + ((10 - 31.5) / 57.6) ** 2 + ((20 - 23.5) / 57.6) ** 2)
    assert lux[20, 10] == pytest.approx([800 / (4 * np.pi) * 2.5 / away**3] * 3, rel=1e-5)


@pytest.mark.parametrize(
    ("stated", "word"), [(["--ambient-lux", 200], "absolute"), ([], "relative")]
)
def test_numbers_say_their_unit_and_photometry(capfd, folder, stated, word):
    outcome = relight(
        capfd, "--lamp", LAMP, *stated, "--engine", "reference", "--illuminance-map", "lux.exr",
        out="light.exr",
    )  # fmt: skip
    import OpenEXR

    units = {}
    for name in ("lux.exr", "light.exr"):
        header = OpenEXR.File(str(folder / name)).header()
        assert header["andon:photometry"] == word
        units[name] = header["andon:unit"]
    assert units == {"lux.exr": "lx", "light.exr": "cd/m2"}
    assert ("300 lx assumed" in outcome.err) == (word == "relative")


def test_no_lamps_at_all_change_nothing(capfd, folder):
    relight(capfd, "--engine", "reference")
    photo = read_picture(folder / "photo.png").values
    assert (read_picture(folder / "out.png").values == photo).all()


def test_dimming_darkens(capfd, folder):
    relight(capfd, "--engine", "reference", "--dimming", 0.25)
    photo = read_picture(folder / "photo.png").values
    from andon.responses import srgb_decode, srgb_encode

    expected = np.rint(255 * srgb_encode(0.25 * srgb_decode(photo / 255)))
    assert_agree(read_picture(folder / "out.png").values, expected, atol=1)


def test_options_win_over_the_scene_and_lamps_add(capfd, folder):
    (folder / "scene.toml").write_text(
        '[rig.camera]\nfx = 57.6\n[capture]\nsource = "missing.png"\n'
        '[surface]\ndepth = "missing.npy"\n[ambient]\nilluminance_lux = 999.0\ndimming = 0.5\n'
        '[[lamp]]\nname = "first"\nkind = "sky"\nilluminance_lux = 70.0\n'
    )
    outcome = relight(
        capfd, "--scene", "scene.toml", "--ambient-lux", 200, "--engine", "reference",
        "--lamp", "kind=sky,illuminance_lux=30", "--illuminance-map", "lux.exr",
    )  # fmt: skip
    lux = read_picture(folder / "lux.exr").values
    # Two skies above a wall that faces the camera: half of 70 + 30.
    assert lux[30, 10] == pytest.approx([50, 50, 50], rel=1e-5)
    photo = read_picture(folder / "photo.png").values
    from andon.responses import srgb_decode, srgb_encode

    expected = 255 * srgb_encode(srgb_decode(photo[30, 10] / 255) * (0.5 + 50 / 200))
    assert_agree(read_picture(folder / "out.png").values[30, 10], np.rint(expected), atol=1)
    assert "assumed" not in outcome.err


def test_an_object_and_a_mesh(capfd, folder):
    from worlds import write_obj

    write_glb(folder / "box.glb", block((0.4, 0.4, 0.4), (0, 0, -1.5)))
    write_obj(folder / "room.obj", block((4, 3, 6), (0, 0, 0), inwards=True))
    outcome = run_andon(
        capfd, "relight", "photo.png", "--mesh", "room.obj", "--camera", "camera.toml",
        "--object", "box.glb", "--lamp", LAMP, "--engine", "reference", "-o", "out.png",
    )  # fmt: skip
    assert outcome.code == 0, outcome.err
    middle = read_picture(folder / "out.png").values[24, 32].astype(int)
    assert middle[0] > middle[1] > middle[2], "the box has the colour of its material"


def test_files_elsewhere_are_the_users_own_choice(capfd, folder, monkeypatch):
    """What the command line names may lie anywhere; only a scene file's names are confined."""
    inner = folder / "inner"
    inner.mkdir()
    monkeypatch.chdir(inner)
    outcome = run_andon(
        capfd, "relight", folder / "photo.png", "--depth", "../depth.npy", "--camera",
        folder / "camera.toml", "--engine", "reference", "-o", "out.jpg",
    )  # fmt: skip
    assert outcome.code == 0, outcome.err
    assert read_picture(inner / "out.jpg").shape == (48, 64)


def test_as_a_program_of_its_own(folder):
    """One real process: nothing but the path on stdout."""
    done = subprocess.run(
        [sys.executable, "-m", "andon", "relight", "photo.png", "--depth", "depth.npy",
         "--camera", "camera.toml", "--engine", "reference", "-o", "out.png"],
        capture_output=True, text=True, timeout=120, cwd=folder,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert done.stdout == "out.png\n"
    assert "Traceback" not in done.stderr


def test_help_imports_nothing_heavy():
    """`andon --help` within its time: what costs it is not loaded. (Times are not asserted.)"""
    code = (
        "import sys, json\n"
        "from andon.cli import main\n"
        "try:\n    main(['--help'])\nexcept SystemExit: pass\n"
        "heavy = ['cv2', 'wgpu', 'OpenEXR', 'PIL', 'embreex', 'pydantic', 'scipy', 'trimesh']\n"
        "print(json.dumps([name for name in heavy if name in sys.modules]), file=sys.stderr)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stderr.splitlines()[-1]) == []
    assert "relight" in done.stdout


def test_a_luminaire_of_the_users_own_file(capfd, folder):
    """A file named in --lamp may lie anywhere; its light is the file's."""
    from photometry_files import ies

    inner = folder / "inner"
    inner.mkdir()
    (inner / "lamp.ies").write_text(ies(candela=400))
    lamp = "kind=ies,position=0,0,0,direction=0,0,-1,shadow=false"
    outcome = relight(
        capfd, "--lamp", f"{lamp},file={inner / 'lamp.ies'}",
        "--engine", "reference", "--ambient-lux", 200, "--illuminance-map", "lux.exr",
    )  # fmt: skip
    assert outcome.code == 0, outcome.err
    lux = read_picture(folder / "lux.exr").values
    away = 2.5 * np.sqrt(1 + ((10 - 31.5) / 57.6) ** 2 + ((20 - 23.5) / 57.6) ** 2)
    assert lux[20, 10] == pytest.approx([400 * 2.5 / away**3] * 3, rel=1e-5)


TYPED_FILES = {
    "mesh": "kind=mesh,position=0,0,-1.2,flux_lm=9,mesh=here.obj",
    "shell": "kind=point,position=0,0,-1.2,flux_lm=9,shell.mesh=here.obj,shell.transmittance=0.5",
    "texture": "kind=rectangle,position=0,1,-1,direction=0,0,-1,width_m=0.4,height_m=0.4,flux_lm=9,"
    "texture=here.png",
}


@pytest.mark.parametrize("kind", TYPED_FILES)
def test_every_file_of_a_lamp_is_looked_for_in_the_current_folder(capfd, folder, kind):
    """The scene lies elsewhere; what stands beside it under the same name is no mesh."""
    from worlds import block, write_obj

    beside = folder / "scenes"
    beside.mkdir()
    (beside / "scene.toml").write_text(
        "[rig.camera]\nfx = 57.6\n[ambient]\nilluminance_lux = 200.0\n"
    )
    words = ["relight", "photo.png", "--scene", "scenes/scene.toml", "--depth", "depth.npy",
             "--engine", "reference", "-o", "out.png", "--lamp", TYPED_FILES[kind]]  # fmt: skip
    for name in ("here.obj", "here.png"):
        (beside / name).write_text("nothing that could be read")
    outcome = run_andon(capfd, *words)
    assert outcome.code == 2
    assert "here." in outcome.err
    assert "must exist" in outcome.err, "in the current folder there is none"
    assert "scenes" not in outcome.err, "the path that is named is the one that was tried"
    write_obj(folder / "here.obj", block((0.2, 0.2, 0.2), (0, 0, 0)))
    (folder / "here.png").write_bytes((folder / "photo.png").read_bytes())
    outcome = run_andon(capfd, *words)
    assert outcome.code == 0, outcome.err


def test_help_says_what_paths_are_relative_to(capfd):
    text = " ".join(run_andon(capfd, "relight", "--help").out.split())
    assert "relative to the current folder" in text


def test_exposure_and_tone_are_those_of_the_display(capfd, folder):
    """A photograph that nothing changes: half the exposure halves the linear screen value."""
    from andon.responses import srgb_decode, srgb_encode

    photo = srgb_decode(read_picture(folder / "photo.png").values / 255)
    usual = np.pi / 200
    relight(capfd, "--engine", "reference", "--ambient-lux", 200, "--exposure", usual / 2)
    half = read_picture(folder / "out.png").values
    assert_agree(half, np.rint(255 * srgb_encode(photo / 2)), atol=1)
    bright = ["--engine", "reference", "--ambient-lux", 200, "--exposure", 8 * usual]
    relight(capfd, *bright)
    clipped = (read_picture(folder / "out.png").values == 255).mean()
    relight(capfd, *bright, "--tone", "reinhard")
    assert (read_picture(folder / "out.png").values == 255).mean() < clipped / 2
    assert clipped > 0.5
    scene = "[rig.camera]\nfx = 57.6\n[surface]\ndepth = 'depth.npy'\n"
    scene += f"[ambient]\nilluminance_lux = 200.0\n[display]\nexposure = {usual}\n"
    (folder / "scene.toml").write_text(scene)
    outcome = run_andon(
        capfd, "relight", "photo.png", "--scene", "scene.toml", "--exposure", usual / 2,
        "--engine", "reference", "-o", "scene.png",
    )  # fmt: skip
    assert outcome.code == 0, outcome.err
    assert (read_picture(folder / "scene.png").values == half).all(), "options win"
