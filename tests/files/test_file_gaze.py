"""Readers of gaze: columns, units, axes, gaps, clocks, and what is refused."""

import numpy as np
import pytest

from andon.errors import InputError
from andon.files import read_gaze
from andon.files.gaze import DistanceRecording, GazeRecording, read_eyelink, read_gaze_table
from andon.files.gaze.tables import PUPIL_COLUMNS
from andon.observer.gaze import fixations
from gaze_files import EYELINK, EYES_M, looking_at, own_gaze, pupil_gaze

POINTS = [(0.1, -0.05, 0.8), (0.0, 0.0, 2.0), (-0.3, 0.2, 0.5)]
TIMES = (100.0, 100.01, 100.03)


def read(folder, text, name="a.csv"):
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return read_gaze_table(path)


def test_our_own_table(tmp_path):
    found = read(tmp_path, own_gaze(TIMES, looking_at(POINTS), 0.9))
    assert isinstance(found, GazeRecording)
    np.testing.assert_allclose(found.times_seconds, [0, 0.01, 0.03], atol=1e-12)
    np.testing.assert_array_equal(found.origins_m, np.broadcast_to(EYES_M, (3, 2, 3)))
    np.testing.assert_allclose(found.directions, looking_at(POINTS), atol=1e-15)
    assert found.confidence.tolist() == [0.9] * 3
    assert found.dropped == {}


def test_pupil_labs_eye_0_is_the_right_one_in_millimetres(tmp_path):
    text = pupil_gaze(TIMES, looking_at(POINTS))
    header, first, *_ = text.splitlines()
    row = dict(zip(header.split(","), map(float, first.split(",")), strict=True))
    assert row["eye_center0_3d_x"] == 31.5
    assert row["eye_center1_3d_x"] == -31.5
    found = read(tmp_path, text)
    np.testing.assert_allclose(found.origins_m[0], EYES_M, atol=1e-15)
    np.testing.assert_allclose(found.directions, looking_at(POINTS), atol=1e-15)
    seen = fixations(found)
    np.testing.assert_allclose(1 / seen.dioptres, np.linalg.norm(POINTS, axis=1), rtol=1e-9)


def test_distances_and_dioptres(tmp_path):
    metres = read(tmp_path, "time_seconds,distance_m\n0,0.5\n0.1,\n0.2,2\n")
    powers = read(tmp_path, "dioptres,time_seconds,note\n2,0,a\nnan,0.1,b\n0.5,0.2,c\n", "b.csv")
    for found in (metres, powers):
        assert isinstance(found, DistanceRecording)
        np.testing.assert_array_equal(found.dioptres, [2, np.nan, 0.5])
        np.testing.assert_allclose(found.times_seconds, [0, 0.1, 0.2])
        assert found.confidence.tolist() == [1] * 3


def test_comments_blank_lines_and_a_byte_order_mark(tmp_path):
    path = tmp_path / "a.csv"
    path.write_bytes(
        b"\xef\xbb\xbf# by hand\r\ntime_seconds, dioptres\r\n\r\n0,1\r\n# more\r\n1,2\r\n"
    )
    np.testing.assert_array_equal(read_gaze(path).dioptres, [1, 2])


def test_an_eye_with_a_gap_is_missing_as_a_whole(tmp_path):
    directions = looking_at([(0, 0, 1)] * 4)
    directions[0, 0] = np.nan
    directions[1, 1, 2] = np.nan
    directions[2, 0] = 0.0
    found = read(tmp_path, own_gaze((0, 1, 2, 3), directions))
    missing = np.isnan(found.directions).any(axis=-1)
    assert missing.tolist() == [[1, 0], [0, 1], [1, 0], [0, 0]]
    np.testing.assert_array_equal(missing, np.isnan(found.origins_m).all(axis=-1))


def test_directions_of_any_length_become_unit(tmp_path):
    found = read(tmp_path, own_gaze((0, 1), 7 * looking_at([(0, 0, 1)] * 2)))
    np.testing.assert_allclose(np.linalg.norm(found.directions, axis=-1), 1)


def test_times_that_do_not_rise_are_dropped_and_counted(tmp_path):
    times = (5.0, 5.1, 5.1, 4.0, 5.05, np.nan, 5.2)
    found = read(tmp_path, own_gaze(times))
    np.testing.assert_allclose(found.times_seconds, [0, 0.1, 0.2], atol=1e-12)
    assert found.dropped == {"no time": 1, "time repeated": 1, "time went back": 2}


def test_no_confidence_where_there_is_a_column_is_none_at_all(tmp_path):
    found = read(tmp_path, "time_seconds,dioptres,confidence\n0,1,\n1,1,1.0005\n")
    assert found.confidence.tolist() == [0, 1]


@pytest.mark.parametrize(
    ("text", "rule"),
    [
        ("time_seconds\n1\n", "must have the columns"),
        ("time_seconds,distance_m,dioptres\n1,1,1\n", "must have the columns"),
        (
            ",".join(["gaze_timestamp", "confidence", *PUPIL_COLUMNS[1:]]) + "\n",
            "must have the col",
        ),
        ("time_seconds,dioptres\n", "at least one sample"),
        ("time_seconds,dioptres\n,1\n", "at least one sample"),
        ("time_seconds,dioptres\n0,1\n1\n", "line 3: must have 2 cells as the header has, has 1"),
        ("time_seconds,dioptres\n0,1,2\n", "has 3"),
        ("time_seconds,dioptres\n0,one\n", "line 2, dioptres: must be a number"),
        ("time_seconds,dioptres\n0,inf\n", "must be a number"),
        ("time_seconds,dioptres\n0,1_0\n", "must be a number"),
        ("time_seconds,dioptres\n0,1e300\n", "must be a number"),
        ("time_seconds,dioptres\n0,-1\n", "dioptres: must be 0…100"),
        ("time_seconds,distance_m\n0,0\n", "distance_m: must be 0.01…inf"),
        ("time_seconds,distance_m\n0,-1\n", "distance_m: must be 0.01…inf"),
        ("time_seconds,dioptres,confidence\n0,1,1.1\n", "confidence: must be 0…1"),
        ("time_seconds,dioptres,dioptres\n0,1,1\n", "twice"),
        ("time_seconds,dioptres\n0,\0\n", "zero bytes"),
    ],
)
def test_what_is_no_recording_is_refused(tmp_path, text, rule):
    with pytest.raises(InputError) as caught:
        read(tmp_path, text)
    assert rule in str(caught.value)
    assert "a.csv" in str(caught.value)


def test_millimetres_in_the_place_of_metres_are_refused(tmp_path):
    text = own_gaze((0.0,)).replace("0.0315", "31.5")
    with pytest.raises(InputError, match=r"origin of an eye, metres: must be 0…20, got 31\.5"):
        read(tmp_path, text)


# ── EyeLink ─────────────────────────────────────────────────────────────────────────────────────


def eyelink(folder, text):
    path = folder / "a.asc"
    path.write_text(text)
    return read_eyelink(path)


def test_both_eyes_of_an_eyelink(tmp_path):
    found = eyelink(tmp_path, EYELINK)
    np.testing.assert_allclose(found.times_seconds, [0, 0.002, 0.004, 0.006, 0.008])
    np.testing.assert_array_equal(found.pupils[:3], [[1121, 949], [1122, 951], [0, 0]])
    np.testing.assert_array_equal(found.gaze_px[0], [[655.6, 599.9], [773.1, 594.2]])
    assert np.isnan(found.gaze_px[2]).all()
    assert found.unit == "area"
    assert found.blinks == (("left", pytest.approx(0.004), pytest.approx(0.006)),)


def test_one_eye_of_an_eyelink(tmp_path):
    found = eyelink(tmp_path, "START\t10\tRIGHT\tSAMPLES\n10 1.0 2.0 300.0 ...\n12 . . 0.0 ...\n")
    np.testing.assert_array_equal(found.pupils, [[np.nan, 300], [np.nan, 0]])
    np.testing.assert_array_equal(found.gaze_px[0], [[np.nan] * 2, [1, 2]])


def test_events_alone_share_the_start_of_their_samples(tmp_path):
    samples = "START 1000 LEFT RIGHT\n1000 1 1 5 1 1 5 .....\n"
    events = "START 1000 LEFT RIGHT\nEBLINK R 1500 1600 102\n"
    assert eyelink(tmp_path, samples).times_seconds[0] == 0
    found = eyelink(tmp_path, events)
    assert found.blinks == (("right", 0.5, 0.6),)
    assert found.times_seconds.shape == (0,)


@pytest.mark.parametrize(
    ("text", "rule"),
    [
        ("MSG 1 hello\n", "at least one sample or blink"),
        ("1 2 3\n", "has 3 words"),
        ("1 2 3 4 ...\n2 2 3 4 2 3 4 .....\n", "has 7 words"),
        ("1 2 3 four ...\n", "must be a number"),
        ("1 2 3 -4 ...\n", "pupil: must be ≥ 0"),
        ("EBLINK L 5\n", "a start, an end and a duration"),
        ("EBLINK L 5 4 1\n", "must end after it starts"),
        ("EBLINK X 5 6 1\n", "must name the eye"),
        ("1 2 3 4 ....\n", "has 5 words"),
    ],
)
def test_what_is_no_eyelink_file_is_refused(tmp_path, text, rule):
    with pytest.raises(InputError) as caught:
        eyelink(tmp_path, text)
    assert rule in str(caught.value)
