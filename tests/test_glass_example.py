"""examples/glass: its files fit together, and say what its page says."""

import sys
from pathlib import Path

import numpy as np
import pytest

import andon
from andon.engines.prepared import prepare
from andon.files.gaze import read_gaze
from andon.files.pictures import read_picture
from andon.observer.gaze import fixations
from andon.responses import SRGB

ROOT = Path(__file__).parents[1]
FOLDER = ROOT / "examples" / "glass"


@pytest.fixture(scope="module")
def prepared():
    return prepare(andon.load_scene(FOLDER / "scene.toml"))


def test_it_is_the_papers_scene(prepared):
    (ball,) = prepared.glass.model.solids
    assert ball.shape.radius_m == pytest.approx(0.075)
    assert ball.index == (1.51, 1.51, 1.51)
    assert ball.sticker.transmittance == pytest.approx(0.8)
    assert prepared.glass.model.pupil_m == pytest.approx(0.006)
    left, right = (frame.view for frame in prepared.frames.values())
    np.testing.assert_allclose(right.position - left.position, [0.063, 0, 0], atol=1e-12)
    assert 2 * left.fx * np.tan(np.arcsin(0.075 / 0.4)) == pytest.approx(671, abs=1)


def test_its_background_is_nearer_than_its_front(prepared):
    vergences = prepared.glass.vergences
    assert vergences.surface == pytest.approx(1 / 0.325)
    assert vergences.background_mean == pytest.approx(6.65, abs=0.01)


def test_photographs_and_pattern_are_of_the_same_board(prepared):
    """Without the lamp, what an eye saw is what the rectified board shows there."""
    scene = andon.load_scene(FOLDER / "scene.toml")
    (ball,) = prepared.glass.model.solids
    board, (lamp,) = ball.backdrop, scene.lamp
    for frame in prepared.frames.values():
        origin, rays = frame.view.rays_world()
        chosen = rays[20::40, 20::40].reshape(-1, 3)
        points = origin + chosen * ((-0.2 - origin[2]) / chosen[:, 2])[:, None]
        reach = np.array(lamp.position) - points
        far = np.linalg.norm(reach, axis=1)
        lux = lamp.intensity_cd * reach[:, 2] / far**3
        rows, columns = board.picture.shape[:2]
        u = (points[:, 0] / 0.4 + 1) / 2 * columns
        v = (1 - points[:, 1] / 0.3) / 2 * rows
        texels = board.picture[v.astype(int), u.astype(int)] * (500 / (500 + lux))[:, None]
        seen = frame.linear[20::40, 20::40].reshape(-1, 3)
        # Edges within a pixel, and JPEG, scatter; light and place agree.
        assert (texels * seen).sum() / (seen**2).sum() == pytest.approx(1, abs=0.03)
        assert np.corrcoef(texels.ravel(), seen.ravel())[0, 1] > 0.95


def test_the_recording_looks_at_the_label_the_board_and_the_label():
    series = fixations(read_gaze(FOLDER / "gaze.csv"))
    time, dioptres = series.times_seconds, series.dioptres
    for start, end, distance in ((0, 1.5, 0.325), (2.0, 3.3, 0.6), (4.0, 5.0, 0.325)):
        during = (time >= start) & (time < end)
        assert np.nanmedian(dioptres[during]) == pytest.approx(1 / distance, abs=0.06)
    blink = (time > 2.46) & (time < 2.66)
    assert np.isnan(dioptres[blink]).all()
    assert series.good.mean() > 0.9


def test_the_files_are_what_the_tool_makes():
    sys.path.insert(0, str(ROOT / "tools"))
    try:
        from glass_ball.label import label
        from glass_ball.pattern import pattern
    finally:
        sys.path.pop(0)
    made = label(2048)
    from PIL import Image

    with Image.open(FOLDER / "label.png") as picture:
        off = np.abs(np.asarray(picture).astype(int) - made)
    # Another version of the font's renderer may draw an edge otherwise.
    assert (off.max(axis=-1) > 8).mean() < 0.01
    drawn = SRGB.decode(pattern(1024, 768, 20211)[::8, ::8] / 255)
    stored = read_picture(FOLDER / "pattern.jpg").values[8::16, 8::16] / 255
    assert np.corrcoef(drawn.ravel(), SRGB.decode(stored).ravel())[0, 1] > 0.5


def test_it_stays_small():
    assert sum(path.stat().st_size for path in FOLDER.iterdir()) < 1_500_000
