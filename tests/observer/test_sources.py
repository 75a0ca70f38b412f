"""The choice of a layer, playback of recordings, and the pointer."""

import numpy as np
import pytest

from andon.errors import InputError
from andon.observer.gaze.choice import LayerChoice
from andon.observer.gaze.mouse import MouseGaze
from andon.observer.gaze.track import GazeTrack, load_track
from andon.observer.model import DistanceRecording
from andon.scene.eye import Gaze
from gaze_files import EYELINK, looking_at, own_gaze

SURFACE, BACKGROUND = 3.0, 1.5


# ── layers ──────────────────────────────────────────────────────────────────────────────────────


def choices(values, hysteresis=0.3, surface=SURFACE, background=BACKGROUND):
    choice = LayerChoice(hysteresis)
    return "".join(choice.update(value, surface, background)[0] for value in values)


def test_the_nearer_layer_first_then_hysteresis():
    # The way is 1.5 D: marks at 3 − 0.8·1.5 = 1.8 and 3 − 0.2·1.5 = 2.7.
    assert choices([2.9, 2.0, 1.81, 1.79, 2.0, 2.69, 2.71, 2.0]) == "sssbbbss"
    assert choices([2.26]) == "s"
    assert choices([2.24]) == "b"


def test_without_hysteresis_the_middle_decides():
    assert choices([2.3, 2.2, 2.3, 2.2], hysteresis=0.0) == "sbsb"


def test_full_hysteresis_asks_for_the_other_layer_itself():
    assert choices([3.0, 1.51, 1.5, 2.99, 3.0], hysteresis=1.0) == "ssbbs"


def test_a_background_that_seems_nearer_or_behind_the_eye():
    assert choices([3.0, 5.0, 6.5, 5.0, 3.5], background=6.65) == "ssbbs"
    assert choices([3.0, 0.5, 0.0, 0.5, 2.5], surface=3.0, background=-2.28) == "ssss" + "s"
    assert choices([3.0, -1.3], surface=3.0, background=-2.28) == "sb"


def test_noise_around_the_middle_changes_nothing():
    noisy = 2.25 + np.random.default_rng(2).normal(0, 0.1, 3000)
    assert len(set(choices(noisy))) == 1
    assert len(set(choices(noisy, hysteresis=0.0))) == 2


def test_what_is_not_known_is_the_surface():
    choice = LayerChoice()
    assert choice.update(None, SURFACE, BACKGROUND) == "surface"
    assert choice.update(1.5, SURFACE, BACKGROUND) == "background"
    assert choice.update(1.5, SURFACE, float("nan")) == "background"
    assert choice.update(2.9, 1.5, 1.5) == "background"  # layers that look the same
    assert choice.update(float("nan"), SURFACE, BACKGROUND) == "surface"
    assert choice.changes == 2
    with pytest.raises(InputError):
        LayerChoice(1.5)


# ── playback ────────────────────────────────────────────────────────────────────────────────────


def test_playback_knows_only_the_past(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text(own_gaze((7.0, 7.1, 7.2), looking_at([(0, 0, 1), (0, 0, 2), (0, 0, 0.5)])))
    track = load_track(path, Gaze(source="file", file="a.csv", filter="none"))
    values = [track.at(time) for time in (-0.01, 0.0, 0.099, 0.1001, 0.25, 0.45, 0.71)]
    assert [state for _, state in values] == [
        "fallback", "seen", "seen", "seen", "seen", "held", "fallback"
    ]  # fmt: skip
    known = [value for value, _ in values[1:6]]
    assert known == pytest.approx([1, 1, 0.5, 2, 2])


def test_playback_is_what_a_live_one_would_have_been(tmp_path):
    generator = np.random.default_rng(1)
    times = np.arange(200) / 30
    whole = DistanceRecording(times, generator.uniform(0.5, 3, 200), np.ones(200))
    track = GazeTrack.of(whole, Gaze())
    for count in (1, 57, 150):
        part = DistanceRecording(times[:count], whole.dioptres[:count], np.ones(count))
        moment = float(times[count - 1])
        assert GazeTrack.of(part, Gaze()).at(moment) == track.at(moment)


def test_limits_of_the_scene_are_used(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text(own_gaze(confidence=0.7))
    assert GazeTrack.of(_read(path), Gaze()).fixation.good.all()
    strict = GazeTrack.of(_read(path), Gaze(minimum_confidence=0.8))
    assert strict.fixation.rejected == {"blink": 3}
    assert strict.at(0.05) == (None, "fallback")


def _read(path):
    from andon.files import read_gaze

    return read_gaze(path)


def test_a_recording_without_rays_is_refused(tmp_path):
    path = tmp_path / "a.asc"
    path.write_text(EYELINK)
    with pytest.raises(InputError, match="where on a screen"):
        load_track(path, Gaze())


# ── the pointer ─────────────────────────────────────────────────────────────────────────────────


def pointer(**keys):
    return MouseGaze(Gaze(source="mouse", filter="none", **keys))


def test_a_pointer_that_rests_is_believed():
    mouse = pointer()
    assert mouse.at(0.0) == (None, "fallback")
    mouse.point(0.1, 2.0)
    assert mouse.at(0.15) == (None, "fallback")
    assert mouse.at(0.21) == (0.5, "seen")
    assert mouse.at(60.0) == (0.5, "seen")


def test_a_pointer_that_crosses_an_edge_is_not():
    mouse = pointer()
    mouse.point(0.0, 1.0)
    assert mouse.at(0.2) == (1.0, "seen")
    mouse.point(0.30, 0.4)
    assert mouse.at(0.32) == (1.0, "seen")
    mouse.point(0.35, 1.02)
    assert mouse.at(0.6)[0] == pytest.approx(1 / 1.02)
    mouse.point(0.7, 0.4)
    for step in range(5):  # it moves on over the new thing
        mouse.point(0.72 + 0.02 * step, 0.4)
    assert mouse.at(0.83)[0] == pytest.approx(2.5)


def test_a_pointer_over_nothing_is_held_then_given_up():
    mouse = pointer(hold_seconds=0.5)
    mouse.point(0.0, 1.0)
    mouse.at(0.2)
    mouse.point(0.3, None)
    assert mouse.at(0.35) == (1.0, "seen")
    assert mouse.at(0.45) == (1.0, "held")
    assert mouse.at(1.0) == (None, "fallback")
    for nothing in (0.0, -1.0, float("nan")):
        mouse.point(1.1, nothing)
    assert mouse.at(1.5) == (None, "fallback")
