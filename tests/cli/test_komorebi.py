"""``andon glare komorebi``: masks, pictures and lists as films, and what is refused."""

import numpy as np
import pytest
from PIL import Image

from andon.cli import main


@pytest.fixture
def mask(tmp_path):
    picture = np.zeros((40, 64), np.uint8)
    picture[10:13, 12:15] = picture[20:22, 40:44] = 255
    Image.fromarray(picture).save(tmp_path / "mask.png")
    return tmp_path / "mask.png"


def komorebi(*words):
    """The exit code."""
    with pytest.raises(SystemExit) as ended:
        main(["glare", "komorebi", *map(str, words), "--engine", "reference"])
    return ended.value.code


def test_a_mask_as_a_film(mask, tmp_path, capfd):
    out = tmp_path / "film.webp"
    assert komorebi(mask, "-o", out, "--seconds", 2, "--fps", 2, "--seed", 5) == 0
    with Image.open(out) as film:
        assert film.n_frames == 4
        assert film.size == (64, 40)
    said = capfd.readouterr()
    assert "2 gaps" in said.err
    assert said.out.strip() == str(out)


def test_a_seed_is_a_film(mask, tmp_path):
    def frames(name, *words):
        words = ("--seconds", 0.5, "--fps", 4, *words)
        assert komorebi(mask, "-o", tmp_path / name, *words) == 0
        return [path.read_bytes() for path in sorted((tmp_path / name).iterdir())]

    first = frames("a")
    assert len(first) == 2
    assert first == frames("b")
    assert first != frames("c", "--seed", 1)
    assert first != frames("d", "--age", 75)


def test_a_list_as_a_picture(tmp_path, capfd):
    listed = tmp_path / "gaps.csv"
    listed.write_text("azimuth_degrees,elevation_degrees,diameter_degrees\n3,4,0.3\n-9,2,0.2\n")
    assert komorebi(listed, "-o", tmp_path / "a.png", "--seconds", 0.01) == 0
    assert "2 gaps" in capfd.readouterr().err
    with Image.open(tmp_path / "a.png") as picture:
        assert picture.size == (960, 540)


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (["--seconds", 0], "--seconds: must be > 0"),
        (["--fps", 0], "--fps: must be > 0"),
        (["--gaps", 0], "--gaps: must be ≥ 1"),
        (["--z", 2.5], "flicker.z: must be > 1 and < 2"),
        (["--age", 200], "eye.age_years"),
        (["--through", 3], "sun.transmitted: must be in 0…1"),
        (["--model", "cie13"], "--model: must be one of"),
        (["--sun-at", "3"], "X,Y in pixels"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(mask, tmp_path, capfd, words, line):
    assert komorebi(mask, "-o", tmp_path / "a.webp", *words) == 2
    said = capfd.readouterr().err
    assert line in said
    assert said.count("\n") == 1
    assert not (tmp_path / "a.webp").exists()


def test_a_mask_without_gaps_is_named(tmp_path, capfd):
    Image.new("L", (20, 20)).save(tmp_path / "dark.png")
    assert komorebi(tmp_path / "dark.png", "-o", tmp_path / "a.webp") == 2
    assert "dark.png" in capfd.readouterr().err
