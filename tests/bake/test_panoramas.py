"""Probes that are panoramas."""

import numpy as np
import pytest
from worlds_of_probes import lamp_room, scene_of

from andon.bake import bake_probes
from andon.bake.to_file import placed_in
from andon.errors import InputError
from andon.files.pictures import write_exr, write_png

HEIGHT = 32


def panorama(folder, picture, name="sky.exr", **keys):
    if name.endswith(".exr"):
        write_exr(
            folder / name, np.asarray(picture, np.float32), unit="cd/m2", photometry="absolute"
        )
    else:
        write_png(folder / name, picture)
    place = {"position": [0, 1, 0], "panorama": name} | keys
    return scene_of(folder, probes={"place": [place], "placement": {"kind": "hand"}})


def light(loaded):
    baked = bake_probes(loaded, placed_in(loaded))
    return next(iter(baked.volume.states.values()))[0], baked.report


def grey(value):
    return np.full((HEIGHT, 2 * HEIGHT, 3), value)


def test_a_uniform_one_is_uniform_light(tmp_path):
    found, report = light(
        panorama(tmp_path, grey(2.0), luminance_per_unit=50.0, white=[1.0, 0.5, 2.0])
    )
    np.testing.assert_allclose(found[0], np.array([100, 200, 50]) * np.sqrt(4 * np.pi), rtol=1e-6)
    np.testing.assert_allclose(found[1:] / found[0], 0, atol=1e-3)  # sampled at 64 × 32
    assert (report.negative, report.clipped) == (0, ())
    assert report.engine == "none"


@pytest.mark.parametrize(
    ("degrees", "towards"), [(0, (0, 0, -1)), (90, (1, 0, 0)), (-90, (-1, 0, 0))]
)
def test_heading_turns_its_middle_towards_x(tmp_path, degrees, towards):
    picture = grey(0.0)
    picture[HEIGHT // 2 - 2 : HEIGHT // 2 + 2, HEIGHT - 2 : HEIGHT + 2] = 1.0  # the middle
    found, _ = light(panorama(tmp_path, picture, heading_degrees=degrees))
    y, z, x = found[1:4, 0]
    vector = np.array([x, y, z])
    np.testing.assert_allclose(vector / np.linalg.norm(vector), towards, atol=1e-6)


def test_eight_bits_are_linearised_and_suns_reported(tmp_path):
    picture = np.full((HEIGHT, 2 * HEIGHT, 3), 188, np.uint8)  # half of white
    found, report = light(panorama(tmp_path, picture, "sky.png"))
    np.testing.assert_allclose(found[0], 0.5029 * np.sqrt(4 * np.pi), rtol=1e-3)
    assert report.clipped == ()
    picture[HEIGHT // 2, :4] = 255
    _, report = light(panorama(tmp_path, picture, "sun.png"))
    assert report.clipped == ("probe",)
    share = 4 / (2 * HEIGHT) * np.pi / HEIGHT / 2  # four pixels at the equator
    assert report.clipped_share == pytest.approx(share, rel=1e-2)


def test_negative_values_are_counted_as_none(tmp_path):
    picture = grey(1.0)
    picture[0, 0] = -0.5
    found, report = light(panorama(tmp_path, picture))
    assert report.negative == 3
    assert found[0, 0] < np.sqrt(4 * np.pi)


@pytest.mark.parametrize(
    ("picture", "rule"),
    [
        (np.ones((HEIGHT, HEIGHT, 3)), "twice as wide as high, got 32×32"),
        (np.where(np.arange(3) == 1, np.nan, grey(1.0)), "2048 pixels that are NaN or infinite"),
    ],
)
def test_what_is_no_panorama_is_refused(tmp_path, picture, rule):
    loaded = panorama(tmp_path, picture)
    with pytest.raises(InputError, match=rule) as caught:
        light(loaded)
    assert caught.value.field == "probes.place[0].panorama"


def test_it_knows_the_walls_of_the_scene(tmp_path, engine):
    write_exr(tmp_path / "a.exr", np.asarray(grey(1.0), np.float32), unit="", photometry="relative")
    places = [{"name": "a", "position": [0, 0, 0], "panorama": "a.exr"},
              {"name": "b", "position": [0.5, 0, 0]}]  # fmt: skip
    loaded = lamp_room(tmp_path, probes={"place": places, "placement": {"kind": "hand"}})
    volume = bake_probes(loaded, placed_in(loaded), engine=engine).volume
    assert volume.distances.mean_m.max() <= volume.distances.far_m
    assert volume.distances.mean_m.min() < volume.distances.far_m
    first, second = next(iter(volume.states.values()))
    np.testing.assert_allclose(first[0], np.sqrt(4 * np.pi), rtol=1e-5)
    assert second[0, 0] > 1


def test_panoramas_of_unknown_scale_are_named_once(tmp_path):
    stated = panorama(tmp_path, grey(1.0), luminance_per_unit=1.0)
    assert light(stated)[1].unscaled == ()
    write_png(tmp_path / "b.png", np.full((HEIGHT, 2 * HEIGHT, 3), 99, np.uint8))
    names = ("sky.exr", "b.png", "sky.exr")
    places = [{"position": [i, 0, 0], "panorama": name} for i, name in enumerate(names)]
    loaded = scene_of(tmp_path, probes={"place": places, "placement": {"kind": "hand"}})
    assert light(loaded)[1].unscaled == ("sky.exr", "b.png")
