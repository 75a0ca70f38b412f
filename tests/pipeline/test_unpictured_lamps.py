"""Light of lamps that no picture holds."""

from dataclasses import replace

import numpy as np
import pytest

from andon.engines.glare_lamps import UnpicturedLamps
from andon.glare.lamp_sources import source_of_lamp
from andon.glare.sources.live import LiveSources
from andon.lamps import PointLamp
from andon.pipeline import Renderer
from andon.quantities import Geometry
from andon.spaces import pinhole_view
from worlds import scene

NARROW = pinhole_view(64, 48, 200.0)


def ball(x=0.0):
    return PointLamp("ball", np.array([x, 0.0, -2.0]), np.full(3, 100.0), visible_radius_m=0.02)


def wall(edge):
    """A wall 1 m before the eye, to the right of x = `edge`."""
    corners = [(edge, -1, -1), (edge + 2, -1, -1), (edge + 2, 1, -1), (edge, 1, -1)]
    return Geometry(np.array(corners, float), np.array([[0, 1, 2], [0, 2, 3]], np.int32))


def beside(hiding, lamp):
    """Share of a lamp's light that `split` leaves to be drawn."""
    _, left = hiding.split([lamp], LiveSources(0.0), NARROW, blooms=False)
    whole = source_of_lamp(lamp, NARROW).illuminance_lux
    return sum((source.illuminance_lux for source in left), np.zeros(3))[1] / whole[1]


def test_a_lamp_beside_the_picture_goes_behind_a_wall_without_a_jump():
    lamp = ball(2.0)
    middle = 1.0
    shares = [
        beside(UnpicturedLamps(wall(middle + off)), lamp) for off in np.linspace(-0.03, 0.03, 31)
    ]
    assert shares[0] == 0
    assert shares[-1] == 1
    assert 0.4 < shares[15] < 0.6
    assert np.abs(np.diff(shares)).max() < 0.15


def test_two_lamps_that_touch_get_the_light_that_was_cut_from_each():
    lamps = [ball(), ball(0.045)]
    whole = [source_of_lamp(lamp, NARROW) for lamp in lamps]
    most = 0.1 * float(whole[0].luminance_cd_m2[1])
    held = sum(0.1 * source.illuminance_lux for source in whole)
    between = sum(source.direction for source in whole)
    found = LiveSources(
        1.0,
        (replace(whole[0], direction=between / np.linalg.norm(between), illuminance_lux=held),),
    )
    completed, _ = UnpicturedLamps(wall(5.0), most).split(lamps, found, NARROW, blooms=False)
    np.testing.assert_allclose(
        completed.sources[0].illuminance_lux,
        sum(source.illuminance_lux for source in whole),
        rtol=0.02,
    )


@pytest.mark.parametrize("renderer", ["per-source", "whole-picture"])
def test_what_half_floats_cut_blooms_once(gpu, tmp_path, renderer):
    bulb = {"kind": "point", "position": [0.1, 0.0, -1.5], "visible_radius_m": 0.04,
            "flux_lm": 1e5}  # fmt: skip
    settings = {"model": "cie135", "needles": False, "halo": False, "renderer": renderer}
    lit = scene(tmp_path, lamp=[bulb], ambient={"illuminance_lux": 2.0}, glare=settings)
    frames = [Renderer(lit, name).render() for name in ("reference", "gpu")]
    expected, actual = (np.asarray(frame.glare.cd_m2, float)[..., 1] for frame in frames)
    # Beside the bulb, whose rim both draw in their own way: 4 % of its light at this size.
    far = frames[0].captured.view.directions() @ [0.07, 0, 1] < np.cos(np.radians(10))
    np.testing.assert_allclose(actual[far].sum(), expected[far].sum(), rtol=0.05)
