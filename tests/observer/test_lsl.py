"""Gaze over LSL, through the real library on this machine's loopback."""

import time

import numpy as np
import pytest

import andon.observer.gaze.lsl as module
from andon.errors import MachineError
from andon.observer.gaze.lsl import CHANNELS, LslGaze, recording_of
from andon.scene.eye import Gaze
from gaze_files import EYES_M, looking_at
from requirements import required

PATIENCE_SECONDS = 20.0


def sample(distance_m, *, blind=None, confidence=1.0):
    """The 15 channels of eyes that look straight ahead at a distance."""
    directions = looking_at([(0.0, 0.0, distance_m)])[0]
    if blind is not None:
        directions[blind] = np.nan
    rays = np.stack([EYES_M, directions], axis=1).ravel()
    return [*rays.tolist(), confidence, 4.0, 4.0]


class Source:
    """An outlet of the real library."""

    def __init__(self, name, channels=CHANNELS):
        self.pylsl = required("pylsl")
        info = self.pylsl.StreamInfo(name, "Gaze", channels, 0.0, "double64", f"id of {name}")
        self.outlet = self.pylsl.StreamOutlet(info)

    def say(self, values, seconds_ago=0.0):
        self.outlet.push_sample(values, self.pylsl.local_clock() - seconds_ago)


def wait_until(condition):
    end = time.monotonic() + PATIENCE_SECONDS
    while not condition():
        assert time.monotonic() < end, "nothing came over the loopback"
        time.sleep(0.01)


def settings(name, **keys):
    return Gaze(source="lsl", stream=name, filter="none", **keys)


def test_a_stream_is_found_seen_lost_and_found_again():
    required("pylsl")
    name = f"andon test {time.time_ns()}"
    with LslGaze(settings(name, hold_seconds=0.3)) as gaze:
        assert gaze.at(gaze.seconds()) == (None, "fallback")
        source = Source(name)

        def sees(distance_m):
            source.say(sample(distance_m))
            dioptres, state = gaze.at(gaze.seconds())
            return state == "seen" and dioptres == pytest.approx(1 / distance_m, abs=1e-9)

        wait_until(lambda: sees(0.5))
        wait_until(lambda: sees(2.0))
        assert gaze.connections == 1

        last = gaze.at(gaze.seconds())[0]
        source.say(sample(1.0, blind=0))
        wait_until(lambda: gaze.at(gaze.seconds())[1] == "held")
        assert gaze.at(gaze.seconds())[0] in (last, None)
        wait_until(lambda: gaze.at(gaze.seconds()) == (None, "fallback"))
        assert gaze.rejected == {"one eye missing": 1}

        del source.outlet
        wait_until(lambda: gaze.losses == 1)
        source = Source(name)
        wait_until(lambda: sees(0.25))
        assert gaze.connections == 2


def test_a_stream_of_other_channels_is_refused_in_words():
    name = f"andon other {time.time_ns()}"
    source = Source(name, channels=22)
    with LslGaze(settings(name)) as gaze:
        wait_until(lambda: gaze.problem)
        assert "15 channels" in gaze.problem
        assert "has 22" in gaze.problem
        source.say([0.0] * 22)
        assert gaze.at(gaze.seconds()) == (None, "fallback")
        assert gaze.connections == 0


def test_a_clock_ahead_does_not_keep_a_dead_stream_alive():
    name = f"andon ahead {time.time_ns()}"
    source = Source(name)
    with LslGaze(settings(name, hold_seconds=0.2)) as gaze:

        def seen():
            source.say(sample(1.0), seconds_ago=-1000.0)
            return gaze.at(gaze.seconds())[1] == "seen"

        wait_until(seen)
        wait_until(lambda: gaze.at(gaze.seconds())[1] == "fallback")


def test_missing_package_is_the_machines_fault(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "pylsl", None)
    with pytest.raises(MachineError, match=r"pip install andon\[gaze\]"):
        LslGaze(Gaze(source="lsl"))


def test_impossible_numbers_are_missing_eyes():
    channels = np.array([sample(1.0)] * 5)
    channels[0, 0] = np.inf
    channels[1, 4] = 1e300
    channels[2, 6] = 500.0  # millimetres in metres' place
    channels[3, 12] = np.nan
    found = recording_of(np.arange(5.0), channels)
    missing = np.isnan(found.directions).any(axis=-1)
    assert missing.tolist() == [[1, 0], [1, 0], [0, 1], [0, 0], [0, 0]]
    assert found.confidence.tolist() == [1, 1, 1, 0, 1]


def test_the_layout_is_the_one_of_the_table():
    assert module.CHANNELS == len(sample(1.0)) == 15
