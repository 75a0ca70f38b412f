"""Numbers of glare against closed forms, Radiance's references and its evalglare."""

import re

import numpy as np
import pytest

from andon.errors import InputError
from andon.files.pictures import read_picture
from andon.glare.calibration import calibrated
from andon.glare.cleaning import cleaned
from andon.glare.kernel import Kernel
from andon.glare.numbers import (
    daylight_glare_probability,
    position_index,
    threshold_increment_percent,
    unified_glare_rating,
    veil_towards,
    vertical_illuminance,
)
from andon.glare.numbers.measure import measured
from andon.observer.spread.family import spread_function
from andon.observer.spread.model import Eye
from andon.quantities import photometric
from andon.spaces import View
from requirements import required

AHEAD, UP = np.array([0.0, 0, 1]), np.array([0.0, -1, 0])
SPHERE = View("latlong", 720, 360)
FISHEYE = View("fisheye", 360, 360, 360 / np.pi, 360 / np.pi, 179.5, 179.5)


def stiles_holladay(age=25.0):
    return Kernel(spread_function("cie146-stiles-holladay", Eye(age)))


def listed(path):
    """Glare sources (n, 5) and indirect illuminances (m, 2) of Radiance's findglare."""
    parts = {"glare source": [], "indirect illuminance": []}
    rows = None
    for line in path.read_text().splitlines():
        if line.startswith("BEGIN "):
            rows = parts[line[6:]]
        elif line.startswith("END"):
            rows = None
        elif rows is not None:
            rows.append([float(word) for word in line.split()])
    return tuple(np.array(part) for part in parts.values())


def test_ugr_of_radiances_published_sources(data_dir):
    folder = data_dir / "radiance_tests" / "util"
    sources, indirect = listed(folder / "glaresrc.txt")
    text = (folder / "ref" / "ugr.txt").read_text()
    known = {
        float(angle): float(value)
        for angle, value in re.findall(r"^(-?\d+\.\d+)\s+(-?\d+\.\d+)$", text, re.MULTILINE)
    }
    view, up = np.array([-0.703298, 0.706112, 0]), np.array([0, 0, 1.0])
    view /= np.linalg.norm(view)
    directions = sources[:, :3] / np.linalg.norm(sources[:, :3], axis=1, keepdims=True)
    assert len(known) == len(indirect) == 19
    for degrees, lux in indirect:
        turn = np.radians(degrees)
        gaze = view * np.cos(turn) + np.cross(up, view) * np.sin(turn)
        index = position_index(directions, gaze, up, below=False)
        ugr = unified_glare_rating(sources[:, 4], sources[:, 3], index, lux / np.pi)
        assert ugr == pytest.approx(known[degrees], abs=2e-6)


def test_position_index():
    def at(right, up):
        sideways, height = np.tan(np.radians([right, up]))
        direction = np.array([[sideways, -height, 1.0]])
        return float(position_index(direction / np.linalg.norm(direction), AHEAD, UP)[0])

    assert at(0, 0) == pytest.approx(1)
    assert at(0, 20) == pytest.approx(np.exp(0.03398 * 20 + 21e-5 * 400))
    assert at(10, 0) == at(-10, 0) > 1
    # Below the line of sight: 1 + 0.8·tan σ, and 1.2 from a slope of 0.6 on.
    assert at(0, -20) == pytest.approx(1 + 0.8 * np.tan(np.radians(20)))
    assert at(0, -45) == pytest.approx(1 + 1.2)
    assert at(0, 85) == 16
    assert position_index(np.array([[0, 0, -1.0]]), AHEAD, UP)[0] == np.inf


def test_indices_by_hand():
    # One lamp of 1e4 cd/m² and 0.01 sr straight ahead, before 100 cd/m².
    assert unified_glare_rating([1e4], [0.01], [1.0], 100.0) == pytest.approx(8 * np.log10(2500))
    assert unified_glare_rating([], [], [], 100.0) is None
    expected = 5.87e-5 * 1000 + 9.18e-2 * np.log10(1 + 1e6 / 1000**1.87) + 0.16
    assert daylight_glare_probability([1e4], [0.01], [1.0], 1000.0) == pytest.approx(expected)
    assert daylight_glare_probability([1e9], [1.0], [1.0], 1e5) == 1
    assert threshold_increment_percent(0.3, 1.0) == pytest.approx(19.5)
    assert threshold_increment_percent(0.3, 2.0) == pytest.approx(19.5 / 2**0.8)
    for bad in (0.0, -1.0, np.inf, np.nan):
        with pytest.raises(InputError):
            threshold_increment_percent(1.0, bad)


@pytest.mark.parametrize("degrees", [1.0, 10.0, 40.0])
def test_the_veil_of_one_lamp_is_its_illuminance_times_the_model(degrees):
    kernel = stiles_holladay(70)
    light = np.zeros((360, 720, 3))
    light[180, 400] = 3000.0
    lux = 3000 * SPHERE.solid_angles()[180, 400]
    lamp = SPHERE.directions()[180, 400]
    across = np.cross(lamp, UP)
    gaze = np.cos(np.radians(degrees)) * lamp + np.sin(np.radians(degrees)) * across
    veil = photometric(veil_towards(gaze[None], light, SPHERE, kernel))[0]
    # CIE: 10·E/θ²·(1 + (A/70)⁴), and its mean over a pixel of h = 0.5°: h²/24 of the Laplacian.
    mean = 1 + 4 / degrees**2 * 0.5**2 / 24
    assert veil == pytest.approx(10 * lux / degrees**2 * 2 * mean, rel=2e-3)


def test_an_even_sphere_veils_itself_by_k():
    kernel = Kernel(spread_function("cie135"))
    gazes = SPHERE.directions()[[5, 180, 300], [7, 360, 719]]
    veil = veil_towards(gazes, np.full((360, 720, 3), 4.0), SPHERE, kernel)
    assert veil == pytest.approx(np.full((3, 3), 4 * kernel.share), rel=0.01)


def test_vertical_illuminance_of_an_even_sky_is_pi():
    for view in (SPHERE, FISHEYE):
        lit = np.where((view.directions() @ AHEAD > 0)[..., None], 100.0, 0) * np.ones(3)
        lux = vertical_illuminance(lit, view, AHEAD)
        assert lux == pytest.approx(np.full(3, 100 * np.pi), rel=2e-3)


@pytest.fixture(scope="module")
def sunset(data_dir):
    seen = calibrated(read_picture(data_dir / "radiance_tests" / "px" / "ref" / "test.hdr"))
    light = cleaned(seen.luminance_cd_m2, seen.view, seen.shows).light
    return seen, light, measured(light, seen.view, stiles_holladay(), AHEAD, seen.photometry)


def test_evalglare_agrees_on_a_photographed_sunset(sunset):
    required("pyradiance")
    from andon.glare.numbers.evalglare import evalglare

    seen, light, numbers = sunset
    other = evalglare(photometric(light), seen.view)
    assert other.sources == len(numbers.discomfort.solid_angle_sr) == 2
    assert numbers.vertical_lux == pytest.approx(other.values["E_v"], rel=1e-3)
    assert numbers.background_cd_m2 == pytest.approx(other.values["lum_backg"], rel=2e-3)
    assert numbers.ugr == pytest.approx(other.values["ugr"], abs=0.05)
    assert numbers.dgp == pytest.approx(other.values["dgp"], abs=0.002)


def test_validity_says_what_is_wrong(sunset):
    seen, light, numbers = sunset
    assert seen.photometry == "absolute"
    assert numbers.validity["veil_cd_m2"].holds
    assert numbers.validity["dgp"].holds
    assert not numbers.validity["ti_percent"].holds
    assert "adaptation" in numbers.validity["ti_percent"].why
    relative = measured(light, seen.view, stiles_holladay(), AHEAD, "relative")
    assert not any(one.holds for one in relative.validity.values())


def test_black_has_no_indices():
    numbers = measured(np.zeros((360, 360, 3)), FISHEYE, stiles_holladay(), AHEAD, "absolute")
    assert numbers.veil_cd_m2 == 0
    assert (numbers.ti_percent, numbers.ugr, numbers.dgp) == (None, None, None)


def test_evalglare_takes_no_panorama():
    from andon.glare.numbers.evalglare import evalglare

    with pytest.raises(InputError, match="fish-eye"):
        evalglare(np.ones((360, 720)), SPHERE)
