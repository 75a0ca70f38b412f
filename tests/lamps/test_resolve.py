"""Lamps of a scene, as physics: units, colour, motion, and what is not rendered yet."""

import subprocess
import sys

import numpy as np
import pytest

from andon.engines.digest import digest
from andon.errors import InputError
from andon.lamps import (
    DirectionalLamp,
    HemisphereLamp,
    PointLamp,
    Shadow,
    SkyLamp,
    SpotLamp,
    resolve_lamps,
)
from andon.lamps.distributions import spot_solid_angle_sr
from andon.lamps.sources import resolve_sources
from andon.quantities import photometric
from andon.scene import scene_from_dict

POINT = {"kind": "point", "position": [1, 2, 3], "intensity_cd": 50}


def resolve(*tables, time_seconds=0.0, **scene):
    return resolve_lamps(scene_from_dict({"lamp": tables, **scene}), time_seconds)


def test_point():
    (lamp,) = resolve(POINT)
    assert type(lamp) is PointLamp
    assert lamp.name == "point-1"
    assert lamp.position_m.tolist() == [1, 2, 3]
    assert lamp.intensity_cd.tolist() == [50, 50, 50]
    assert lamp.shadow == Shadow(1024, "linear")
    assert lamp.visible_radius_m == 0


def test_flux_of_a_point_spreads_over_the_sphere():
    (lamp,) = resolve({"kind": "point", "position": [0, 0, 0], "flux_lm": 800})
    assert np.allclose(lamp.intensity_cd, 800 / (4 * np.pi))


def test_colour_keeps_the_photometric_value():
    colours = [{"temperature_k": 2700}, {"rgb": [1, 0, 0]}, {"chromaticity_xy": [0.2, 0.4]}]
    for lamp in resolve(*[POINT | colour for colour in colours]):
        assert photometric(lamp.intensity_cd) == pytest.approx(50)
        assert len(set(lamp.intensity_cd.tolist())) > 1


def test_spot_has_its_intensity_on_the_axis_and_its_flux_in_the_cone():
    spot = {"kind": "spot", "position": [0, 0, 0], "direction": [0, 0, -9], "outer_degrees": 30}
    by_intensity, by_flux = resolve(spot | {"intensity_cd": 10}, spot | {"flux_lm": 10})
    assert isinstance(by_intensity, SpotLamp)
    assert by_intensity.direction.tolist() == [0, 0, -1]
    assert by_intensity.intensity_cd.tolist() == [10, 10, 10]
    assert by_intensity.outer_radians == pytest.approx(np.pi / 6)
    solid_angle = spot_solid_angle_sr(0, np.pi / 6)
    assert np.allclose(by_flux.intensity_cd * solid_angle, 10)


def test_light_from_afar():
    sun, sky, hemisphere = resolve(
        {"kind": "directional", "direction": [0, -2, 0], "illuminance_lux": 1e5, "shadow": False},
        {"kind": "sky", "illuminance_lux": 1e4},
        {
            "kind": "hemisphere",
            "illuminance_lux": 200,
            "ground_illuminance_lux": 50,
            "ground_rgb": [1, 1, 0],
            "up": [0, 0, 2],
        },
    )
    assert isinstance(sun, DirectionalLamp)
    assert sun.direction.tolist() == [0, -1, 0]
    assert sun.shadow is None
    assert isinstance(sky, SkyLamp)
    assert sky.illuminance_lux.tolist() == [1e4] * 3
    assert isinstance(hemisphere, HemisphereLamp)
    assert hemisphere.up.tolist() == [0, 0, 1]
    assert hemisphere.sky_illuminance_lux.tolist() == [200] * 3
    assert hemisphere.ground_illuminance_lux[2] == 0
    assert photometric(hemisphere.ground_illuminance_lux) == pytest.approx(50)


@pytest.mark.parametrize("size", [1e-300, 1e-160, 1e160, 1e300])
def test_directions_of_any_length(size):
    (lamp,) = resolve({"kind": "directional", "direction": [size, -size, 0], "illuminance_lux": 1})
    assert np.allclose(lamp.direction, [np.sqrt(0.5), -np.sqrt(0.5), 0])


def test_motion_and_order():
    moving = POINT | {
        "key": [
            {"time_seconds": 0, "position": [0, 0, 0], "intensity_cd": 0},
            {"time_seconds": 4, "position": [4, 0, 0], "intensity_cd": 8},
        ]
    }
    first, second = resolve(POINT | {"name": "a"}, moving | {"name": "b"}, time_seconds=1)
    assert (first.name, second.name) == ("a", "b")
    assert second.position_m.tolist() == [1, 0, 0]
    assert second.intensity_cd.tolist() == [2, 2, 2]


NOT_YET = [
    (POINT | {"path": "way.csv"}, "path"),
    (
        {
            "kind": "directional",
            "direction": [0, -1, 0],
            "illuminance_lux": 1,
            "angular_diameter_degrees": 0.53,
        },
        "angular_diameter_degrees",
    ),
]


@pytest.mark.parametrize(("table", "what"), NOT_YET)
def test_what_is_not_rendered_yet_is_refused_with_a_way_out(table, what):
    scene = scene_from_dict({"lamp": [POINT, table]})
    with pytest.raises(InputError, match=what.split()[0]) as caught:
        resolve_lamps(scene, 0)
    message = str(caught.value)
    assert "lamp[1]." in message
    assert "in the schema but not" in message
    assert "; use " in message


@pytest.mark.parametrize("transport", ["baked", "direct+bounce"])
def test_how_light_travels_changes_no_lamp(transport):
    lantern = POINT | {"name": "lantern", "transport": transport}
    tables = {"baked": {"folder": "maps", "lamps": ["lantern"]}}
    (ours,) = resolve(lantern, **tables)
    (plain,) = resolve(lantern | {"transport": "direct"})
    assert digest(ours) == digest(plain)


def test_light_of_the_photograph_is_not_baked():
    source = POINT | {"name": "window", "transport": "baked"}
    scene = scene_from_dict({"ambient": {"illuminance_lux": 100.0, "source": [source]}})
    with pytest.raises(InputError, match="transport 'baked'") as caught:
        resolve_sources(scene, 0.0, ["objects"])
    assert "the photograph has its light already" in str(caught.value)


def test_overflow_is_refused():
    narrow = {"kind": "spot", "position": [0, 0, 0], "direction": [0, 0, 1], "outer_degrees": 0.1}
    with pytest.raises(InputError, match=r"lamp\[0\]: is too large"):
        resolve(narrow | {"flux_lm": 1e306})


def test_no_lamps():
    assert resolve_lamps(scene_from_dict({}), 0) == ()


def test_lamps_do_not_need_pydantic():
    code = "import sys, andon.lamps; sys.exit('pydantic' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
