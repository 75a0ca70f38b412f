"""What the README tells to type works as it stands there."""

import re
import shlex
import shutil

import numpy as np
import pytest
from PIL import Image

from andon.cli import _run
from andon.files.pictures import read_picture, write_exr, write_picture
from andon.responses import SRGB

from .tree import ROOT

README = (ROOT / "README.md").read_text(encoding="utf-8")
COMMANDS = re.findall(r"`andon (relight [^`]*)`", README)
PROBE_COMMANDS = re.findall(r"`andon (probes [^`]*)`", README)
BAKE_COMMANDS = re.findall(r"`andon (bake [^`]*)`", README)
FOUND_COMMANDS = re.findall(r"`andon ((?:calibrate|depth fit) [^`]*)`", README)
GLARE_COMMANDS = re.findall(r"`andon (glare [^`]*)`", README)
PYTHON = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
FILES = dict(re.findall(r"```toml\n# ([\w.]+)[^\n]*\n(.*?)```", README, re.DOTALL))


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with the files that the README takes for granted, and those that it shows."""
    write_picture(tmp_path / "photo.png", np.full((90, 160, 3), 128, np.uint8))
    np.save(tmp_path / "depth.npy", np.full((90, 160), 2.0))
    brighter = np.broadcast_to(np.linspace(150, 190, 160)[None, :, None], (90, 160, 3))
    write_picture(tmp_path / "lamp-on.png", brighter.astype(np.uint8))
    for name, text in FILES.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_it_shows_something():
    assert len(COMMANDS) >= 4
    assert [command.split()[1] for command in PROBE_COMMANDS] == ["place", "bake", "show", "export"]
    names = {"camera", "night", "room", "probes", "ball", "eye"}
    assert set(FILES) == {f"{name}.toml" for name in names}
    assert [command.split()[1] for command in BAKE_COMMANDS] == [
        "room.toml",
        "cameras",
        "show",
        "status",
    ]
    assert len(GLARE_COMMANDS) == 5
    assert len(FOUND_COMMANDS) == 4
    assert len(PYTHON) == 4


@pytest.mark.parametrize("command", COMMANDS)
def test_command(command, folder, capsys):
    words = shlex.split(command)
    assert _run([*words, "--engine", "reference"], debug=True) == 0
    out = folder / words[words.index("-o") + 1]
    assert not np.array_equal(read_picture(out).values, read_picture(folder / "photo.png").values)
    for name in re.findall(r"--illuminance-map (\S+)", command):
        assert (folder / name).is_file()


def test_python(folder, capsys):
    names = {}
    exec(compile(PYTHON[0], "README.md", "exec"), names)
    assert names["frame"].illuminance.lux.max() > 10


@pytest.fixture
def series(folder):
    """What responses, curves and depth are found from: exposures, known light, relative depth."""
    random = np.random.default_rng(1)
    light = np.geomspace(0.01, 3.0, 160 * 90).reshape(90, 160, 1) * np.array([1.0, 0.8, 0.6])
    for name, stops in zip("abcde", range(-2, 3), strict=True):
        codes = 255 * np.clip(light * 2.0**stops / 4, 0, 1) ** (1 / 2.2)
        noisy = np.clip(np.rint(codes + random.normal(0, 0.5, codes.shape)), 0, 255)
        exif = Image.Exif()
        exif.get_ifd(0x8769).update({0x829A: 2.0**stops / 60, 0x829D: 4.0, 0x8827: 100})
        image = Image.fromarray(noisy.astype(np.uint8))
        image.save(folder / f"{name}.jpg", quality=98, exif=exif)
    texture = random.uniform(0.4, 0.6, (90, 160, 3))
    for name, lux in (("dim", 55), ("half", 210), ("full", 640)):
        codes = 255 * SRGB.encode(texture * lux / 700)
        write_picture(folder / f"{name}.png", np.rint(codes).astype(np.uint8))
    np.save(folder / "midas.npy", np.broadcast_to(np.linspace(0.3, 0.7, 160), (90, 160)))
    return folder


@pytest.mark.parametrize("command", FOUND_COMMANDS)
def test_found_from_pictures(command, series, capsys):
    words = shlex.split(command)
    assert _run(words, debug=True) == 0
    out = series / words[words.index("-o") + 1]
    assert (out / "surface_response.toml").is_file() if out.is_dir() else out.is_file()


def test_baked_light(folder, capsys):
    shutil.copy(ROOT / "examples" / "basic" / "room.glb", folder)
    for command in BAKE_COMMANDS:
        assert _run(shlex.split(command), debug=True) == 0
    assert "done" in capsys.readouterr().out
    assert (folder / "plan.png").is_file()
    assert (folder / "maps.png").is_file()
    words = ["relight", "--scene", "room.toml", "-o", "baked.png", "--engine", "reference"]
    assert _run([*words, "--uncovered", "gaps.png"], debug=True) == 0
    direct = FILES["room.toml"].partition("[baked]")[0].replace('"direct+bounce"', '"direct"')
    (folder / "direct.toml").write_text(direct, encoding="utf-8")
    words[2], words[4] = "direct.toml", "direct.png"
    assert _run(words, debug=True) == 0
    baked, alone = (read_picture(folder / f"{name}.png").values for name in ("baked", "direct"))
    assert (baked >= alone - 1.0).all()
    # What the bulb does not see is black without the walls' light.
    shadow = (alone.max(axis=-1) == 0) & (baked.max(axis=-1) > 0)
    assert shadow.mean() > 0.05
    assert (folder / "gaps.png").is_file()


def test_probes(folder, capsys):
    shutil.copy(ROOT / "examples" / "basic" / "room.glb", folder)
    for command in PROBE_COMMANDS:
        assert _run(shlex.split(command), debug=True) == 0
    assert (folder / "probes.png").is_file()
    assert (folder / "probes.json").is_file()
    names = {}
    exec(compile(PYTHON[1], "README.md", "exec"), names)
    assert names["light"].shape == (2, 9, 3)
    lux = names["andon"].harmonics.irradiance(names["light"], np.array([0.0, 1.0, 0.0]))
    assert (lux > 1000).all()


def test_glass(folder, capsys):
    command = re.search(r"`andon (glass ball[^`]*)`", README)[1]
    assert _run([*shlex.split(command), "--engine", "reference"], debug=True) == 0
    grey = read_picture(folder / "photo.png").values
    assert not np.array_equal(read_picture(folder / "ball.png").values, grey)
    shutil.copytree(ROOT / "examples" / "glass", folder / "examples" / "glass")
    names = {}
    exec(compile(PYTHON[2], "README.md", "exec"), names)
    assert names["left"].glass.layers.refracted.shape == (720, 1280, 3)
    told = float(re.search(r"background_mean  # ([\d.]+) D", README)[1])
    seen = names["left"].report.glass.vergences.background_mean
    assert seen == pytest.approx(told, abs=0.005)


@pytest.fixture
def lights(folder):
    """A picture of lights, and leaves, small ones."""
    light = np.full((48, 96, 3), 0.5, np.float32)
    light[20:22, 40:42] = 50_000
    write_exr(folder / "night.exr", light, unit="cd/m2", photometry="absolute")
    leaves = np.zeros((40, 60, 3), np.uint8)
    leaves[10:13, 20:23] = leaves[25:27, 40:42] = 255
    write_picture(folder / "leaves.png", leaves)
    return folder


# What makes a command quick here: its words are as in the README otherwise.
SHORTER = {
    "komorebi": ("--seconds", "0.1"),
    "figures": ("--figures", "4,6", "--width", "64", "--engine", "reference"),
}


@pytest.mark.parametrize("command", GLARE_COMMANDS)
def test_glare(command, lights, capsys):
    words = shlex.split(command)
    assert _run([*words, *SHORTER.get(words[1], ())], debug=True) == 0
    out = lights / words[words.index("-o") + 1]
    assert out.is_dir() or out.stat().st_size > 1000
    if "--report" in words:
        assert (lights / words[words.index("--report") + 1]).is_file()


def test_glare_in_python_and_in_a_scene(folder, capsys):
    names = {}
    exec(compile(PYTHON[3], "README.md", "exec"), names)
    told = float(re.search(r"veil_cd_m2  # ([\d.]+) cd", README)[1])
    assert names["seen"].numbers.veil_cd_m2 == pytest.approx(told, abs=0.02)
    without = FILES["eye.toml"].partition("[glare]")[0]
    (folder / "sharp.toml").write_text(without, encoding="utf-8")
    for name in ("eye", "sharp"):
        words = ["relight", "--scene", f"{name}.toml", "-o", f"{name}.png"]
        assert _run([*words, "--engine", "reference"], debug=True) == 0
    seen, sharp = (read_picture(folder / f"{name}.png").values for name in ("eye", "sharp"))
    assert (seen.astype(int) - sharp).max() > 30


def test_links():
    links = re.findall(r"\]\(([^)#:]+)\)", README)
    assert "CONVENTIONS.md" in links
    missing = [link for link in links if not (ROOT / link).exists()]
    assert missing == []
