"""Lamps with a name: what they stand for, what overrides them, where they may stand."""

import numpy as np
import pytest

from andon.errors import InputError
from andon.lamps import parse_lamp_option
from andon.lamps.distributions import spot_attenuation
from andon.scene import LAMP_KINDS, PRESETS, expand_preset, parse_scene, scene_from_dict

PLACES = {"position": [0, 1, -2], "direction": [0, -1, 0]}


def table(name, **keys):
    kind = LAMP_KINDS[keys.get("kind", PRESETS[name].keys["kind"])]
    places = {key: value for key, value in PLACES.items() if key in kind.model_fields}
    return {"preset": name, **places, **keys}


def lamp(name, **keys):
    return scene_from_dict({"lamp": [table(name, **keys)]}).lamp[0]


@pytest.mark.parametrize("name", PRESETS)
def test_every_preset_is_a_lamp(name):
    found = lamp(name)
    for key, value in PRESETS[name].keys.items():
        assert getattr(found, key) == value
    assert found.light is not None
    assert PRESETS[name].what
    assert PRESETS[name].source


def test_a_candle_has_one_candela():
    assert lamp("candle").flux_lm == pytest.approx(4 * np.pi, rel=1e-3)


def test_the_spotlight_has_half_its_light_at_18_degrees():
    spot = lamp("spotlight")
    half = spot_attenuation(
        np.cos(np.radians(18)),
        inner_radians=np.radians(spot.inner_degrees),
        outer_radians=np.radians(spot.outer_degrees),
    )
    assert half == pytest.approx(0.5, abs=0.02)


def test_the_lantern_is_not_dazzling():
    lantern = lamp("paper-lantern")
    luminance = lantern.flux_lm / (np.pi * 4 * np.pi * lantern.radius_m**2)
    assert luminance == pytest.approx(200, rel=0.02)


def test_given_light_and_colour_replace_the_presets():
    by_intensity = lamp("candle", intensity_cd=2)
    assert (by_intensity.intensity_cd, by_intensity.flux_lm) == (2, None)
    blue = lamp("sun", rgb=[0, 0, 1])
    assert (blue.temperature_k, blue.daylight) == (None, False)
    warm = lamp("sun", temperature_k=2000)  # Planck: the preset's daylight would refuse it
    assert (warm.temperature_k, warm.daylight) == (2000, False)
    assert lamp("bulb", visible_radius_m=0).visible_radius_m == 0


def test_another_kind_keeps_what_it_has():
    ball = lamp("candle", kind="sphere", radius_m=0.01)
    assert (ball.flux_lm, ball.temperature_k, ball.radius_m) == (12.57, 1850, 0.01)


def test_in_a_file_and_among_the_ambient_sources():
    scene = parse_scene(
        '[[lamp]]\npreset = "candle"\nposition = [0.0, 1.0, -2.0]\n'
        "[ambient]\nilluminance_lux = 50.0\n"
        '[[ambient.source]]\npreset = "bulb"\nname = "ceiling"\nposition = [0.0, 2.0, 0.0]\n'
    )
    assert scene.lamp[0].kind == "point"
    assert scene.ambient.source[0].flux_lm == 710
    # Written out, the numbers stand there: the file means the same when presets change.
    assert "preset" not in scene.to_toml()
    assert parse_scene(scene.to_toml()) == scene


def test_on_the_command_line():
    found = parse_lamp_option("preset=candle,position=0,1,-2,temperature_k=2000")
    assert found["kind"] == "point"
    assert found["temperature_k"] == 2000
    assert found["position"] == [0, 1, -2]
    assert "preset" not in found
    with pytest.raises(InputError, match="did you mean 'candle'"):
        parse_lamp_option("preset=candel,position=0,1,-2")
    with pytest.raises(InputError, match="radius_m"):
        parse_lamp_option("preset=candle,radius_m=1")


@pytest.mark.parametrize("name", ["candel", "", 3, ["candle"], None])
def test_an_unknown_preset_is_named(name):
    with pytest.raises(InputError) as caught:
        scene_from_dict({"lamp": [{"preset": "bulb", "position": [0, 0, 0]}, {"preset": name}]})
    message = str(caught.value)
    assert "lamp[1].preset: must be one of candle, " in message
    assert "\n" not in message


def test_without_a_place_it_is_refused():
    with pytest.raises(InputError, match=r"lamp\[0\].position: is required"):
        scene_from_dict({"lamp": [{"preset": "candle"}]})


def test_a_table_without_preset_is_left_alone():
    given = {"kind": "point"}
    assert expand_preset(given, "x") is given


@pytest.mark.parametrize("lamps", [3, "x", [3], [{"preset": "candle", "kind": "no"}]])
def test_nonsense_is_refused_by_the_scene(lamps):
    with pytest.raises(InputError, match="lamp"):
        scene_from_dict({"lamp": lamps})


def test_a_window_is_an_even_overcast_sky_behind_double_glazing():
    table = {"preset": "window", "position": (0, 1, -2), "direction": (1, 0, 0)}
    (lamp,) = scene_from_dict({"lamp": [table]}).lamp
    assert (lamp.kind, lamp.drawn, lamp.two_sided) == ("rectangle", False, False)
    sky = PRESETS["overcast-sky"].keys["illuminance_lux"]
    assert lamp.luminance_cd_m2 == pytest.approx(0.8 * sky / np.pi, rel=0.02)
