"""Lamps between their keyframes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from andon.errors import InputError
from andon.scene import lamp_at, scene_from_dict


def scene_of(*keys, **lamp):
    table = {
        "kind": "spot",
        "position": [9, 9, 9],
        "direction": [0, 0, 1],
        "intensity_cd": 5,
        "temperature_k": 3000,
        "key": keys,
    }
    return scene_from_dict({"lamp": [table | lamp]})


def at(scene, time_seconds):
    return scene.at(time_seconds).lamp[0]


def test_without_keys_nothing_changes():
    scene = scene_of()
    assert scene.at(3.0) == scene


def test_linear_between_keys_and_constant_outside():
    scene = scene_of(
        {"time_seconds": 1, "position": [0, 0, 0], "temperature_k": 2000},
        {"time_seconds": 3, "position": [2, 4, 0]},
        {"time_seconds": 4, "position": [2, 4, 8], "temperature_k": 5000},
    )
    assert at(scene, 0).position == (0, 0, 0)
    assert at(scene, 1).position == (0, 0, 0)
    assert at(scene, 2).position == (1, 2, 0)
    assert at(scene, 3.5).position == (2, 4, 4)
    assert at(scene, 99).position == (2, 4, 8)
    assert at(scene, 2).temperature_k == 3000  # runs past the key that does not state it
    assert at(scene, 2).intensity_cd == 5
    assert at(scene, 2).key == ()


def test_one_key_is_a_constant():
    scene = scene_of({"time_seconds": 7, "direction": [0, 3, 0], "intensity_cd": 1})
    for time in (-1, 7, 99):
        assert at(scene, time).direction == (0, 1, 0)
        assert at(scene, time).intensity_cd == 1


def test_directions_turn_evenly():
    scene = scene_of(
        {"time_seconds": 0, "direction": [1, 0, 0]}, {"time_seconds": 3, "direction": [0, 2, 0]}
    )
    third = np.radians(30)
    assert np.allclose(at(scene, 1).direction, [np.cos(third), np.sin(third), 0])
    assert at(scene, -1).direction == (1, 0, 0)
    assert np.allclose(at(scene, 5).direction, [0, 1, 0])


def test_opposite_directions_are_refused():
    with pytest.raises(InputError, match=r"key\[1\].direction: is opposite .* add a key between"):
        scene_of(
            {"time_seconds": 0, "direction": [1, 0, 0]},
            {"time_seconds": 3, "direction": [-2, 0, 0]},
        )


@given(st.floats(-5, 5), st.lists(st.floats(-3, 3), min_size=6, max_size=6))
def test_directions_stay_unit_and_values_stay_between(time, numbers):
    a, b = np.array(numbers).reshape(2, 3) + np.array([4, 0, 0])
    scene = scene_of(
        {"time_seconds": -1, "direction": a, "position": a},
        {"time_seconds": 2, "direction": b, "position": b},
    )
    lamp = at(scene, time)
    assert np.linalg.norm(lamp.direction) == pytest.approx(1)
    assert (np.minimum(a, b) - 1e-12 <= lamp.position).all()
    assert (lamp.position <= np.maximum(a, b) + 1e-12).all()


def test_resolving_twice_is_resolving_once():
    scene = scene_of(
        {"time_seconds": 0, "intensity_cd": 0}, {"time_seconds": 1, "intensity_cd": 10}
    )
    assert scene.at(0.25).at(0.9) == scene.at(0.25)


@pytest.mark.parametrize("time", [float("nan"), float("inf")])
def test_times_are_finite(time):
    with pytest.raises(InputError, match="time_seconds"):
        lamp_at(scene_of().lamp[0], time)


def test_motion_from_a_file_is_refused_not_ignored():
    with pytest.raises(InputError, match=r"lamp\[0\].path: .*; use \[\[lamp.key\]\]"):
        scene_of(path="way.csv").at(0)
