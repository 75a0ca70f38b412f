"""Flicker of a scene file: which lamps, by how much, and what does not flicker."""

import numpy as np
import pytest
from PIL import Image

from andon.engines.prepared import prepare
from andon.errors import InputError
from andon.lamps import resolve_bodies, resolve_lamps
from andon.lamps.flicker import Flicker
from andon.scene import scene_from_dict

CANDLE = {"kind": "point", "name": "candle", "position": [0, 1, 0], "intensity_cd": 1.0}
FLICKER = {"exponent": 1.8, "steps_per_second": 12, "seed": 5}
ROOM = {"rig": {"camera": {"width": 8, "height": 8, "hfov_degrees": 60}}}


def lamp_at(time_seconds, lamp, **scene):
    return resolve_lamps(scene_from_dict({"lamp": [lamp], **scene}), time_seconds)[0]


def test_the_light_is_the_mean_times_the_flicker_over_a_frame():
    own = Flicker(5, 1.8, 12.0)
    for time in (0.0, 0.7, 61.0):
        swing = own.at(time, exposure_seconds=1 / 30)[0]
        for amount in (1.0, 0.3):
            lamp = lamp_at(time, CANDLE | {"flicker": FLICKER | {"amount": amount}})
            assert np.allclose(lamp.intensity_cd, 1 + amount * (swing - 1))


def test_no_amount_is_steady():
    lamp = lamp_at(3.0, CANDLE | {"flicker": FLICKER | {"amount": 0}})
    assert lamp.intensity_cd.tolist() == [1, 1, 1]


def test_each_lamp_flickers_by_itself_unless_a_seed_is_shared():
    def light(seed_of_scene=0, **changes):
        flicker = {"exponent": 1.8, "steps_per_second": 12, **changes.pop("flicker", {})}
        scene = {"scene": {"seed": seed_of_scene}}
        return lamp_at(4.2, CANDLE | {"flicker": flicker} | changes, **scene).intensity_cd[0]

    assert light() == light()
    assert light() != light(name="other")
    assert light() != light(seed_of_scene=1)
    seeded = {"flicker": {"seed": 3}}
    assert light(**seeded) == light(name="other", seed_of_scene=1, **seeded)


def test_many_gaps_are_their_mean():
    one = Flicker(5, 1.8, 12.0, 40).at(2.0, exposure_seconds=1 / 30)
    lamp = lamp_at(2.0, CANDLE | {"flicker": FLICKER | {"gaps": 40}})
    assert np.isclose(lamp.intensity_cd[0], one.mean())


def test_a_mask_gives_gaps_weights_of_their_areas(tmp_path):
    picture = np.zeros((20, 30, 3), np.uint8)
    picture[2:6, 3:8] = 255  # 20 pixels
    picture[10:16, 20:30] = 255  # 60
    Image.fromarray(picture).save(tmp_path / "leaves.png")
    lamp = CANDLE | {"flicker": FLICKER | {"mask": "leaves.png"}}
    scene = scene_from_dict({"lamp": [lamp]}, folder=tmp_path)
    both = Flicker(5, 1.8, 12.0, 2).at(1.0, exposure_seconds=1 / 30)
    found = resolve_lamps(scene, 1.0)[0].intensity_cd[0]
    assert np.isclose(found, 0.25 * both[0] + 0.75 * both[1])


def test_a_mask_without_gaps_is_refused(tmp_path):
    Image.fromarray(np.zeros((4, 4, 3), np.uint8)).save(tmp_path / "dark.png")
    lamp = CANDLE | {"flicker": {"mask": "dark.png"}}
    with pytest.raises(InputError, match=r"dark\.png: has no gap"):
        resolve_lamps(scene_from_dict({"lamp": [lamp]}, folder=tmp_path), 0.0)


def test_bodies_flicker_with_their_light():
    ball = {"kind": "sphere", "name": "ball", "position": [0, 1, 0], "radius_m": 0.1}
    ball |= {"luminance_cd_m2": 100.0}
    lantern = CANDLE | {"shell": {"radius_m": 0.2}, "name": "lantern"}
    for lamp in (ball, lantern):
        still = scene_from_dict({"lamp": [lamp]})
        moving = scene_from_dict({"lamp": [lamp | {"flicker": FLICKER}]})
        swing = Flicker(5, 1.8, 12.0).at(0.7, exposure_seconds=1 / 30)[0]
        seen, lit = resolve_bodies(moving, 0.7)[0], resolve_lamps(moving, 0.7)
        assert np.allclose(seen.outside_cd_m2, swing * resolve_bodies(still, 0.7)[0].outside_cd_m2)
        for after, before in zip(lit, resolve_lamps(still, 0.7), strict=True):
            key = "luminance_cd_m2" if hasattr(after, "luminance_cd_m2") else "intensity_cd"
            assert np.allclose(getattr(after, key), swing * getattr(before, key))


def test_what_is_baked_is_the_mean(tmp_path):
    (tmp_path / "floor.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 3 2\n")
    floor = {"name": "floor", "mesh": "floor.obj"}
    lamp = CANDLE | {"flicker": FLICKER}
    scene = scene_from_dict({"lamp": [lamp], **ROOM, "object": [floor]}, folder=tmp_path)
    assert prepare(scene, drawn=False).at(3.0).lamps[0].intensity_cd.tolist() == [1, 1, 1]


def test_light_of_a_photograph_does_not_flicker():
    known = {"illuminance_lux": [1, 1, 1], "source": [CANDLE | {"flicker": FLICKER}]}
    from andon.lamps.sources import resolve_sources

    with pytest.raises(InputError, match=r"ambient.source\[0\].flicker: is of light that"):
        resolve_sources(scene_from_dict({"ambient": known}), 0.0, ["objects"])


def test_gaps_and_mask_exclude_each_other():
    flicker = {"mask": "leaves.png", "gaps": 3}
    with pytest.raises(InputError, match=r"flicker.gaps: gaps and mask exclude each other"):
        scene_from_dict({"lamp": [CANDLE | {"flicker": flicker}]})
