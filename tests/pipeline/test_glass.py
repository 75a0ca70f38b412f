"""Glass in whole frames, on both engines: what it changes and leaves, and what is told of it."""

import numpy as np
import pytest
from PIL import Image

from andon.pipeline import Renderer
from andon.scene import scene_from_dict
from comparison import assert_agree, assert_same_picture
from gaze_files import looking_at, own_gaze
from glass_worlds import (
    BALL,
    EYE_Z,
    FOCAL,
    HEIGHT,
    WIDTH,
    glass_scene,
    glass_tables,
    write_glass_files,
)
from worlds import block, write_obj

LABELLED = BALL | {"texture": "label.png", "texture_transmittance": 0.4}
EYES = ((-0.0315, "left"), (0.0315, "right"))
# Metres from the eye: the front of the ball, and the board behind it.
FRONT_M, BOARD_M = 0.325, 0.6


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("glass")
    write_glass_files(folder, eyes=((0.0, "mono"), *EYES))
    return folder


def drawn(folder, engine, *glass, at=0.0, **tables):
    return Renderer(glass_scene(folder, *glass, **tables), engine).render(at)


def recording(folder, name, distances_m):
    """A second of 30 Hz at each distance, NaN: eyes closed."""
    points = np.zeros((30 * len(distances_m), 3))
    points[:, 2] = np.repeat(distances_m, 30)
    times = np.arange(len(points)) / 30
    (folder / name).write_text(own_gaze(times, looking_at(points)))
    return {"source": "file", "file": name, "filter": "none"}


def test_without_glass_nothing_changes(files, engine):
    plain = drawn(files, engine)
    looking = drawn(files, engine, gaze={"source": "surface"})
    np.testing.assert_array_equal(plain.image.rgb, looking.image.rgb)
    assert plain.glass is None
    assert plain.report.glass is None
    assert any(name.startswith("gaze") for name in looking.report.ignored_tables)
    assert not any(name.startswith("gaze") for name in plain.report.ignored_tables)


@pytest.mark.parametrize("kind", [{"kind": "surface"}, {"kind": "frame", "distance_m": BOARD_M}])
def test_glass_of_index_1_is_invisible(files, engine, kind):
    """On a photograph without edges: what is seen through glass is read over a pixel's pencil."""
    rows, columns = np.mgrid[:HEIGHT, :WIDTH]
    ramps = np.stack([columns, 2 * rows, 140 - columns // 2 - rows // 2], axis=-1) + 60
    Image.fromarray(ramps.astype(np.uint8)).save(files / "ramps.png")
    capture = {"source": "ramps.png", "luminance_per_unit": 240.0}
    plain = drawn(files, engine, capture=capture)
    air = drawn(files, engine, BALL | {"index": 1.0, "background": kind}, capture=capture)
    assert air.report.glass.counts.glass > 1000
    assert_agree(air.image.rgb, plain.image.rgb, atol=1)


def test_what_is_nearer_hides_glass(files, engine):
    write_obj(files / "screen.obj", block((0.2, 0.2, 0.01), (0, 0, 0)))
    screen = {"name": "screen", "mesh": "screen.obj", "position": [0.0, 0.0, 0.2]}
    hidden = drawn(files, engine, LABELLED, object=[screen])
    plain = drawn(files, engine, object=[screen])
    np.testing.assert_array_equal(hidden.image.rgb, plain.image.rgb)
    assert hidden.report.glass.counts.glass == 0


def test_the_sticker_is_as_far_away_as_it_is(files, engine):
    """Its disparity is f·b/d, parallel eyes; the ball's front bends away by less than a pixel."""
    label = np.zeros((256, 512, 4), np.uint8)
    label[124:132, 252:260] = 255
    Image.fromarray(label).save(files / "dot.png")
    tables = glass_tables(BALL | {"texture": "dot.png"})
    tables["rig"]["kind"] = "stereo"
    tables["capture"]["source"] = {"left": "left.png", "right": "right.png"}
    renderer = Renderer(scene_from_dict(tables, folder=files), engine)
    places = {}
    for name in renderer.view_names:
        alpha = renderer.render(0.0, name).glass.layers.surface_alpha
        places[name] = (alpha.sum(axis=0) @ np.arange(alpha.shape[1])) / alpha.sum()
    expected = FOCAL * 0.063 / (EYE_Z - 0.075)
    assert places["left"] - places["right"] == pytest.approx(expected, abs=0.5)


@pytest.mark.parametrize(
    ("gaze", "layer", "dioptres", "state"),
    [
        ({"source": "surface"}, "surface", 1 / FRONT_M, "seen"),
        ({"source": "background"}, "background", 6.6484, "seen"),
        ({"source": "background", "blur": "paper"}, "background", 1 / BOARD_M, "seen"),
        ({"source": "fixed", "distance_m": 0.5}, "distance", 2.0, "seen"),
        ({"source": "mouse"}, "surface", 1 / FRONT_M, "fallback"),
    ],
)
def test_what_the_eyes_are_focused_on(files, engine, gaze, layer, dioptres, state):
    focus = drawn(files, engine, LABELLED, gaze=gaze).report.glass.focus
    assert (focus.layer, focus.state, focus.clamped) == (layer, state, False)
    assert focus.dioptres == pytest.approx(dioptres, rel=1e-3)


@pytest.mark.parametrize("source", ["file", "capture"])
def test_recorded_gaze_chooses_the_layer_and_falls_back(files, engine, source):
    gaze = recording(files, "looks.csv", [FRONT_M, BOARD_M, np.nan, np.nan])
    tables = glass_tables(LABELLED, gaze=gaze)
    if source == "capture":
        tables["gaze"] = {"source": "capture", "filter": "none"}
        tables["capture"]["gaze"] = "looks.csv"
    renderer = Renderer(scene_from_dict(tables, folder=files), engine)
    found = [renderer.render(time).report.glass.focus for time in (0.5, 1.5, 2.2, 3.5)]
    assert [(focus.layer, focus.state) for focus in found] == [
        ("surface", "seen"),
        ("background", "seen"),
        ("background", "held"),
        ("surface", "fallback"),
    ]
    assert all(np.isfinite(focus.dioptres) for focus in found)


def test_old_eyes_cannot_focus_near(files, engine):
    gaze = {"source": "fixed", "distance_m": 0.3}
    old = drawn(files, engine, LABELLED, gaze=gaze, observer={"age": 70.0, "pupil_mm": 6.0})
    young = drawn(files, engine, LABELLED, gaze=gaze)
    assert old.report.glass.focus.clamped
    assert old.report.glass.focus.dioptres == pytest.approx(0.5)
    assert not young.report.glass.focus.clamped
    assert old.report.glass.blur_px["surface"] > 2 * young.report.glass.blur_px["surface"]


def test_the_report(files, engine):
    report = drawn(files, engine, LABELLED, gaze={"source": "surface"}).report.glass
    assert report.pupil_mm == 6.0
    assert report.interfaces == 2
    assert report.crossing_dioptres is None
    assert report.vergences.background_mean == pytest.approx(6.6484, rel=1e-3)
    assert report.vergences.background_straight == pytest.approx(1 / BOARD_M)
    assert report.other_vergences.background_mean == pytest.approx(-2.2785, rel=1e-3)
    # The ball's outline: a circle of tangent rays.
    radius = FOCAL * np.tan(np.arcsin(0.075 / EYE_Z))
    assert report.counts.glass == pytest.approx(np.pi * radius**2, rel=0.05)
    assert report.counts.lost == 0
    # Within a pixel of each other: A·ΔV·f.
    refracted = 0.006 * (6.6484 - 1 / FRONT_M) * FOCAL
    assert 0 < report.blur_px["refracted"] < 2 * refracted


def test_a_frame_is_the_same_again(files, engine):
    renderer = Renderer(glass_scene(files, LABELLED, gaze={"source": "background"}), engine)
    first, second = (renderer.render().image.rgb for _ in range(2))
    np.testing.assert_array_equal(first, second)


@pytest.mark.parametrize("blur", ["optical", "gaussian", "paper", "off"])
@pytest.mark.parametrize("look", ["surface", "background"])
def test_engines_agree(gpu, files, blur, look, tmp_path):
    """Without a bright lamp: its mirrored disc is cut at white, and edges of it differ by codes."""
    gaze = {"source": look, "blur": blur}
    expected, actual = (
        drawn(files, name, LABELLED, gaze=gaze).image.rgb for name in ("reference", "gpu")
    )
    assert_same_picture(actual, expected, tmp_path)
