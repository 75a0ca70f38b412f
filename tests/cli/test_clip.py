"""`andon clip` from a scene to moving pictures and folders."""

import numpy as np
import pytest
from PIL import Image

from andon.files.pictures import read_picture
from andon.files.pictures.moving import frame_times, write_moving
from andon.pipeline import Renderer
from andon.scene import load_scene
from worlds import block, write_glb, write_relight_files

from .command import PHOTOGRAPHED, run_andon, run_refused

SCENE = f"""{PHOTOGRAPHED}
[scene]
duration_seconds = 0.6
frames_per_second = 10
[[object]]
mesh = "box.glb"
[[object.key]]
time_seconds = 0.0
position = [-0.5, 0.0, -1.5]
[[object.key]]
time_seconds = 0.6
position = [0.5, 0.0, -1.5]
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    write_relight_files(tmp_path)
    write_glb(tmp_path / "box.glb", block((0.4, 0.4, 0.4), (0, 0, 0)))
    (tmp_path / "slide.toml").write_text(SCENE)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def clip(capfd, *more, out, engine="reference"):
    outcome = run_andon(capfd, "clip", "slide.toml", "-o", out, "--engine", engine, *more)
    assert outcome.code == 0, outcome.err
    assert outcome.out == f"{out}\n"


def frames_of(path):
    with Image.open(path) as image:
        frames, times = [], []
        for number in range(image.n_frames):
            image.seek(number)
            frames.append(np.asarray(image.convert("RGB")))  # decodes, then the time is known
            times.append(image.info["duration"])
        return frames, times


@pytest.mark.parametrize(("suffix", "codes"), [(".png", 0), (".webp", 20), (".gif", 20)])
def test_every_format_has_the_frames_of_the_session(capfd, folder, suffix, codes):
    clip(capfd, out=f"slide{suffix}")
    frames, times = frames_of(folder / f"slide{suffix}")
    assert times == [100] * 6, "the frame of the end is left out"
    renderer = Renderer(load_scene(folder / "slide.toml"), "reference")
    for number, frame in enumerate(frames):
        expected = renderer.render(number / 10).image.rgb
        difference = np.abs(frame.astype(int) - expected)
        assert difference.mean() <= codes / 2, number
        assert (difference > 2 * codes).mean() < 0.02, number
    assert (frames[0] != frames[5]).any()


def test_a_folder_gets_numbered_pictures(capfd, folder, engine):
    clip(capfd, "--from", 0.2, "--to", 0.5, "--fps", 20, out="frames", engine=engine)
    names = sorted(path.name for path in (folder / "frames").iterdir())
    assert names == [f"{number:04d}.png" for number in range(6)]
    renderer = Renderer(load_scene(folder / "slide.toml"), engine)
    for number in (0, 5):
        expected = renderer.render(0.2 + number / 20).image.rgb
        found = read_picture(folder / "frames" / f"{number:04d}.png").values
        assert (found == expected).all()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["-o", "a.mp4"], "--out: must end in .webp, .png, .apng, .gif, or be a folder"),
        (["-o", "photo.png"], "--out: is also the scene's photograph"),
        (["-o", "none/a.webp"], "the folder 'none' does not exist; make it"),
        (["-o", "."], "the folder has something in it, which frames would mix with"),
        (["-o", "a.webp", "--to", 0], "--to: must be after --from, 0 s, got 0"),
        (["-o", "a.webp", "--to", "nan"], "--to: must be finite, got nan"),
        (["-o", "a.webp", "--fps", 0], "--fps: must be > 0, got 0"),
        (["-o", "a.webp", "--to", 1e9], "--to: more than 1000000 frames; check --fps"),
        (["-o", "a.webp", "--fps", 1000, "--to", 500], "GB, at most 2 are held; name a folder"),
        (["-o", "a.gif", "--fps", 60], "at most 50 frames a second for .gif, got 60"),
        (["-o", "a.webp", "--view", "left"], "there is no view 'left', this rig has mono"),
    ],
)  # fmt: skip
def test_what_is_refused_before_anything_is_drawn(capfd, folder, words, message):
    assert message in run_refused(capfd, folder, "clip", "slide.toml", *words)


@pytest.mark.parametrize("suffix", [".png", ""])
def test_a_still_is_one_frame(capfd, folder, suffix):
    (folder / "slide.toml").write_text(SCENE.replace("duration_seconds = 0.6", ""))
    outcome = run_andon(capfd, "clip", "slide.toml", "-o", f"a{suffix}", "--engine", "reference")
    assert outcome.code == 0, outcome.err
    assert "the scene has no scene.duration_seconds: it is a still, of one frame" in outcome.err
    path = folder / f"a{suffix}" if suffix else folder / "a" / "0000.png"
    assert suffix or len(list(path.parent.iterdir())) == 1
    renderer = Renderer(load_scene(folder / "slide.toml"), "reference")
    np.testing.assert_array_equal(read_picture(path).values, renderer.picture(0.0))


VIRTUAL = """
[scene]
duration_seconds = 0.2
frames_per_second = 10
[rig.camera]
width = 64
height = 48
fx = 57.6
fy = 60.0
cx = 30.0
[ambient]
illuminance_lux = 200.0
[[object]]
mesh = "box.glb"
position = [0.0, 0.0, -1.5]
"""


def test_previews_see_the_same_with_fewer_pixels(capfd, folder):
    (folder / "box.toml").write_text(VIRTUAL)
    pictures = {}
    for scale in (1, 0.5):
        words = ["-o", f"of-{100 * scale:g}", "--engine", "reference", "--scale", scale]
        outcome = run_andon(capfd, "clip", "box.toml", *words)
        assert outcome.code == 0, outcome.err
        pictures[scale] = read_picture(folder / f"of-{100 * scale:g}" / "0001.png").values.astype(
            float
        )
    assert pictures[0.5].shape == (24, 32, 3)
    halved = pictures[1].reshape(24, 2, 32, 2, 3).mean(axis=(1, 3))
    assert np.ptp(halved) > 20
    assert np.median(np.abs(halved - pictures[0.5])) <= 1
    assert np.mean(np.abs(halved - pictures[0.5]) > 8) < 0.1
    lit = [
        np.argwhere(picture.max(axis=-1) > 40).mean(axis=0) for picture in (halved, pictures[0.5])
    ]
    np.testing.assert_allclose(*lit, atol=0.1)


@pytest.mark.parametrize(
    ("file", "scale", "message"),
    [
        ("slide.toml", 0.5, "--scale: needs a scene without a photograph"),
        ("box.toml", 0, "--scale: must be > 0 and at most 8, got 0"),
        ("box.toml", "nan", "--scale: must be > 0"),
        ("file.toml", 0.5, "needs the width and height of the camera mono"),
    ],
)
def test_previews_that_cannot_be(capfd, folder, file, scale, message):
    (folder / "box.toml").write_text(VIRTUAL)
    sized = VIRTUAL.split("width")[0] + 'file = "c.toml"\n[ambient]' + VIRTUAL.split("[ambient]")[1]
    (folder / "file.toml").write_text(sized)
    words = ["clip", file, "-o", "a", "--engine", "reference", "--scale", scale]
    assert message in run_refused(capfd, folder, *words)


def test_an_interrupted_folder_keeps_its_frames(capfd, folder, monkeypatch):
    genuine = Renderer.picture

    def picture(self, time=0.0, view=None):
        if time > 0.25:
            raise KeyboardInterrupt
        return genuine(self, time, view)

    monkeypatch.setattr(Renderer, "picture", picture)
    outcome = run_andon(capfd, "clip", "slide.toml", "-o", "f", "--engine", "reference")
    assert outcome.code == 130
    assert outcome.err == "andon: interrupted; 3 of 6 frames are in f\n"
    assert sorted(path.name for path in (folder / "f").iterdir()) == [
        "0000.png", "0001.png", "0002.png",
    ]  # fmt: skip


def test_frame_times_lose_nothing():
    assert frame_times(3, 30) == [33, 34, 33]
    assert sum(frame_times(90, 30)) == 3000
    assert sum(frame_times(100, 30, 10)) == 3330
    assert set(frame_times(100, 30, 10)) == {30, 40}


def test_one_frame_is_a_picture(tmp_path):
    picture = np.full((4, 5, 3), 77, np.uint8)
    for suffix in (".png", ".gif", ".webp"):
        path = write_moving(tmp_path / f"one{suffix}", [picture], 25)
        with Image.open(path) as image:
            assert getattr(image, "n_frames", 1) == 1
            assert np.abs(np.asarray(image.convert("RGB")).astype(int) - 77).max() <= 1
