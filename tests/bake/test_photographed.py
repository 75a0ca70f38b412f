"""Bakes of photographed scenes: what light they hold, and how frames use it."""

import numpy as np
import pytest

from andon.bake import bake_file, bake_probes
from andon.bake.to_file import placed_in, scene_geometry
from andon.engines.cubes import cube_setting
from andon.engines.prepared import prepare
from andon.files.volumes import read_volume
from worlds import ball, scene, write_glb


def with_ball(folder, *, probes=None, **tables):
    """A photograph with its depth, two probes, and a ball between them."""
    write_glb(folder / "ball.glb", ball(0.25, (-0.3, 0, -1.4)), colour=(0.5, 0.5, 0.5))
    places = [{"position": [x, 0.0, -1.2]} for x in (-0.5, 0.1)]
    own = {"volume": "p.glb", "place": places, "cube_size_px": 16}
    base = {"probes": own | (probes or {}), "object": [{"mesh": "ball.glb"}]}
    return scene(folder, **(base | tables))


def baked(loaded, engine="reference"):
    """Coefficients (n, k, 3) and report."""
    result = bake_probes(loaded, placed_in(loaded), engine=engine)
    return next(iter(result.volume.states.values())), result.report


def test_a_photograph_with_an_object_is_placed_and_baked_without_a_volume(tmp_path):
    loaded = with_ball(tmp_path)
    assert not (tmp_path / "p.glb").exists()
    geometry = scene_geometry(loaded)
    alone = scene_geometry(with_ball(tmp_path, object=[]))
    assert len(geometry.triangles) > len(alone.triangles) > 1000
    assert placed_in(loaded).count == 2
    assert bake_file(loaded, engine="reference").states == ("default",)


def test_the_places_of_e0_by_probes_need_no_volume(tmp_path):
    assert placed_in(with_ball(tmp_path, ambient={"probes": True})).count == 2


BULB = {"name": "bulb", "kind": "point", "position": [0.0, 0.5, -1.0], "shadow": False}


def without_bulb(folder, bulb, bounces, **tables):
    ambient = {"illuminance_lux": 200.0, "source": [bulb], "removed": ["bulb"]}
    probes = {"bounces": bounces, "cube_size_px": 8}
    return with_ball(folder, ambient=ambient, probes=probes, **tables)


def test_light_that_is_taken_away_bounces_as_what_is_added(tmp_path):
    """What the second reflection of a lamp adds, that of a removed one takes away."""
    bulb = BULB | {"intensity_cd": 5.0}
    once, twice = (
        baked(with_ball(tmp_path, lamp=[bulb], probes={"bounces": n, "cube_size_px": 8}))[0][:, 0]
        for n in (1, 2)
    )
    less, least = (baked(without_bulb(tmp_path, bulb, n))[0][:, 0] for n in (1, 2))
    assert (twice > once).all()
    np.testing.assert_allclose(less - least, twice - once, rtol=1e-6)


def test_no_probe_is_darker_than_black(tmp_path):
    """A lamp at the camera lights all that is seen, and is said to have given more than all."""
    sky = {"kind": "sky", "illuminance_lux": 1e-9}
    bulb = BULB | {"intensity_cd": 5e4, "position": [0.0, 0.0, 0.0]}
    loaded = without_bulb(tmp_path, bulb, 2, object=[], lamp=[sky])
    written = bake_file(loaded, engine="reference")
    assert written.report.black == 6
    np.testing.assert_array_equal(next(iter(read_volume(written.path).states.values())), 0)


UNIFORM = 2 * np.sqrt(np.pi)  # L00 of light that has the luminance 1 everywhere


def test_what_is_beside_the_photograph_is_as_bright_as_e0_says(tmp_path, engine):
    """Of a picture that shows almost nothing, probes hold light that gives dimming·E0."""
    ambient = {"illuminance_lux": [300.0, 200.0, 100.0], "dimming": 0.5}
    away = {"place": [{"position": [0, 0, 500.0]}]}
    coefficients, report = baked(with_ball(tmp_path, ambient=ambient, probes=away), engine)
    expected = UNIFORM * 0.5 * np.array([300, 200, 100]) / np.pi
    np.testing.assert_allclose(coefficients[0, 0], expected, rtol=1e-3)
    np.testing.assert_allclose(coefficients[0, 1:], 0, atol=0.01 * expected[0])
    assert report.surroundings_share > 0.999


def test_the_share_beside_the_photograph_is_counted(tmp_path):
    """From the camera its picture is seen and nothing else, less half a pixel at all edges."""
    loaded = with_ball(tmp_path, object=[], probes={"place": [{"position": [0, 0, 0]}],
                                                    "cube_size_px": 64})  # fmt: skip
    _, report = baked(loaded)
    view = next(iter(prepare(loaded).frames.values())).view
    assert 1 - report.surroundings_share == pytest.approx(
        view.solid_angles().sum() / (4 * np.pi), rel=0.1
    )


@pytest.mark.parametrize("in_probes", [True, False])
def test_a_sky_is_stated_instead(tmp_path, in_probes):
    sky = {"kind": "sky", "illuminance_lux": 10.0, "in_probes": in_probes}
    loaded = with_ball(tmp_path, lamp=[sky])
    assert baked(loaded)[1].surroundings_share == 0
    assert cube_setting(loaded, prepare(loaded, drawn=False)).lighting.surroundings_cd_m2 is None


def test_surroundings_are_not_reflected_again(tmp_path):
    """E0 was measured: all reflections are in it."""
    once, often = (baked(with_ball(tmp_path, probes={"bounces": n}))[0] for n in (0, 3))
    np.testing.assert_array_equal(once, often)
