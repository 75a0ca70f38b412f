"""The example of headlights: where the lamps are, and how much they give to whom."""

from pathlib import Path

import numpy as np
import pytest

from andon.lamps import intensity_cd, resolve_lamps
from andon.quantities import photometric
from andon.scene import load_scene

FOLDER = Path(__file__).parents[1] / "examples/headlights"


@pytest.fixture(scope="module")
def scene():
    return load_scene(FOLDER / "scene.toml")


def lamps_at(scene, time_seconds):
    return {lamp.name: lamp for lamp in resolve_lamps(scene, time_seconds)}


def candela(lamp, kerb_degrees, up_degrees, *, ahead, kerb):
    h, v = np.radians(kerb_degrees), np.radians(up_degrees)
    towards = np.cos(v) * (np.cos(h) * np.array(ahead) + np.sin(h) * np.array(kerb))
    return float(photometric(intensity_cd(lamp, towards + np.sin(v) * np.array([0.0, 1, 0]))))


COMING = {"ahead": (0.0, 0, 1), "kerb": (-1.0, 0, 0)}
OWN = {"ahead": (0.0, 0, -1), "kerb": (1.0, 0, 0)}
BEAMS = [("left headlight", COMING), ("own right headlight", OWN)]


@pytest.mark.parametrize(("name", "axes"), BEAMS)
def test_the_beam_is_that_of_a_european_low_beam(scene, name, axes):
    """Bright where the road is and on the kerb's side, dark towards oncoming eyes; right-hand
    traffic, names and sides of the test points of UN R112.
    """
    lamp = lamps_at(scene, 1.0)[name]
    assert candela(lamp, -3.43, 0.57, **axes) <= 350  # B50L, oncoming eyes
    assert candela(lamp, 1.15, -0.57, **axes) >= 10_000  # 75R, kerb's side at 75 m
    assert candela(lamp, 1.72, -0.86, **axes) >= 10_000  # 50R
    assert candela(lamp, -3.43, -0.86, **axes) <= 13_200  # 50L
    assert candela(lamp, 8.0, 1.2, **axes) > 3 * candela(lamp, -8.0, 1.2, **axes)


def test_the_car_passes_the_observer(scene):
    def middle(time):
        lamps = lamps_at(scene, time)
        return (lamps["left headlight"].position_m + lamps["right headlight"].position_m) / 2

    assert np.allclose(middle(0.0), [-1.85, 0.64, -79.95])
    assert np.allclose(middle(6.0) - middle(0.0), [0, 0, 84.0])
    eye = np.array(scene.rig.camera.position)
    assert middle(5.6)[2] < eye[2] < middle(6.0)[2]


def test_light_at_the_eye_grows_until_the_car_is_near(scene):
    eye = np.array(scene.rig.camera.position)

    def lux(time):
        total = 0.0
        for name in ("left headlight", "right headlight"):
            lamp = lamps_at(scene, time)[name]
            away = eye - lamp.position_m
            distance = np.linalg.norm(away)
            total += float(photometric(intensity_cd(lamp, away / distance))) / distance**2
        return total

    found = [lux(time) for time in (0.0, 2.0, 3.5, 4.5, 5.0)]
    assert (np.diff(found) > 0).all()
    # As on a road: some hundredths of a lux far off, and less than ten just before it passes.
    assert 0.02 < found[0] < 0.5
    assert 1 < found[-1] < 10


def test_both_lamps_are_where_the_car_is(scene):
    assert [entry.name for entry in scene.object] == ["car"]
    for key, lamp in zip(scene.object[0].key, scene.lamp[-1].key, strict=True):
        assert key.time_seconds == lamp.time_seconds
        # Just before the nose, or the car would stand in its own light.
        assert 0.01 < lamp.position[2] - key.position[2] < 0.1
