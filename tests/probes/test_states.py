"""States of a volume: chosen, mixed and added."""

import numpy as np
import pytest

from andon.errors import InputError
from andon.harmonics import irradiance
from andon.transport.probes.states import state_coefficients, with_state
from volume_files import light, two_rooms


def test_the_first_state_is_the_default():
    volume = two_rooms()
    assert state_coefficients(volume) is volume.states["day"]
    assert state_coefficients(volume, "night") is volume.states["night"]


def test_the_ends_of_a_blend_are_the_states_to_the_bit():
    volume = two_rooms()
    day, night = volume.states["day"], volume.states["night"]
    np.testing.assert_array_equal(state_coefficients(volume, "day", "night", 0.0), day)
    np.testing.assert_array_equal(state_coefficients(volume, "day", "night", 1.0), night)


def test_illuminance_of_a_blend_is_the_blend_of_illuminance():
    volume = two_rooms()
    normals = np.eye(3)
    mixed = irradiance(state_coefficients(volume, None, "night", 0.3)[2], normals)
    day, night = (irradiance(values[2], normals) for values in volume.states.values())
    np.testing.assert_allclose(mixed, 0.7 * day + 0.3 * night, rtol=1e-13)


def test_a_state_more():
    volume = two_rooms()
    dusk = light(volume.count, seed=3)
    found = with_state(volume, "dusk", dusk)
    assert list(found.states) == ["day", "night", "dusk"]
    assert list(volume.states) == ["day", "night"]
    np.testing.assert_array_equal(found.states["dusk"], dusk)
    again = with_state(found, "day", dusk)
    assert list(again.states) == ["day", "night", "dusk"]
    np.testing.assert_array_equal(state_coefficients(again), dusk)


@pytest.mark.parametrize(
    ("typed", "message"),
    [
        (("nigth",), "there is no state 'nigth', there is 'day', 'night'; did you mean 'night'"),
        (("day", "dusk", 0.5), "blend_state: there is no state 'dusk'"),
        (("day", None, 0.5), "blend: needs blend_state"),
        (("day", "night", 1.5), "blend: must be 0…1, got 1.5"),
        (("day", "night", float("nan")), "blend: must be 0…1"),
    ],
)
def test_refusals(typed, message):
    with pytest.raises(InputError, match=message):
        state_coefficients(two_rooms(), *typed)


def test_a_state_of_another_bake():
    with pytest.raises(InputError, match=r"must have the shape \(10, 9, 3\) .* has \(9, 9, 3\)"):
        with_state(two_rooms(), "dusk", light(9))
    with pytest.raises(InputError, match="must have a name"):
        with_state(two_rooms(), "", light(10))
