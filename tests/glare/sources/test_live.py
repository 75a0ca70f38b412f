"""Sources of frames: what a growing lamp and many lamps do."""

import numpy as np
import pytest

from andon.engines.glare import taken_share
from andon.glare.around import Around
from andon.glare.sources.live import SourceFinder
from andon.glare.sources.survey import ambient_level, survey
from andon.spaces import pinhole_view

VIEW = pinhole_view(320, 240, 277.0)
FINDER = SourceFinder(VIEW, contrast=40.0, most=16)


def found_in(light):
    return FINDER.find(survey(light), lambda rows, columns: light[rows, columns])


def disc(radius_degrees):
    """A disc of 1000 cd/m² before a wall of 1."""
    away = np.degrees(np.arccos(np.clip(VIEW.directions()[..., 2], -1, 1)))
    covered = np.clip((radius_degrees - away) / 0.2 + 0.5, 0, 1)
    return np.broadcast_to((1 + 999 * covered)[..., None], (*VIEW.shape, 3))


def test_a_lamp_that_comes_near_does_not_go_out_at_once():
    radii = np.arange(4.0, 4.6, 0.01)
    lux = np.array([sum(s.illuminance_lux[1] for s in found_in(disc(r)).sources) for r in radii])
    assert lux[0] > 0.5 * 999 * np.pi * np.radians(radii[0]) ** 2
    assert lux[-1] == 0  # a bright wall
    assert np.abs(np.diff(lux)).max() < 0.2 * lux.max()


def test_the_ambient_level_is_the_mean_of_what_is_cut_at_a_multiple_of_it():
    light = np.random.default_rng(3).lognormal(0, 2.5, (30, 40))
    solid = np.random.default_rng(4).uniform(0.5, 1.5, light.shape)
    level = ambient_level(light, solid, 40.0)
    assert (light > 40 * level).any()
    mean = np.average(np.minimum(light, 40 * level), weights=solid)
    assert mean == pytest.approx(level, rel=1e-9)
    assert ambient_level(np.zeros((3, 4)), np.ones((3, 4)), 40.0) == 0
    assert ambient_level(np.ones((3, 4)), np.ones((3, 4)), 40.0) == pytest.approx(1)


def test_lamps_beyond_the_most_that_are_kept_give_as_much_as_the_kept_receive():
    light = np.full((*VIEW.shape, 3), 0.01)
    light[10:230:50, 10:310:50] = 100.0
    found = found_in(light)
    assert len(found.sources) == 16
    seen = Around((), np.ones(16), np.full((16, 3), 0.05))
    bright = (light[10:230:50, 10:310:50] * VIEW.solid_angles()[10:230:50, 10:310:50, None]).sum(
        axis=(0, 1)
    )
    drawn = sum(source.illuminance_lux for source in found.sources) * (0.05 + 0.3)
    np.testing.assert_allclose(taken_share(found, seen, 0.3) * bright, drawn, rtol=1e-6)
