"""The gate of 40, and what the eye is adapted to."""

import numpy as np
import pytest

from andon.glare.highlights.contrast import AmbientLevel, ambient_luminance, contrast, glares


def test_the_gate():
    assert contrast(400.0, 10.0) == pytest.approx(40)
    np.testing.assert_array_equal(glares([399.9, 400.0, 1e6], 10.0), [False, True, True])
    assert glares(30.0, 1.0, 25.0)
    assert not glares(0.0, 0.0)


def test_ambient_is_that_of_probes_where_there_are_some():
    level = ambient_luminance(np.full(4, 5.0), np.ones(4), probe_lux=np.full((2, 3), 100.0))
    assert level == AmbientLevel(pytest.approx(100 / np.pi), "probes")


def test_else_the_pictures_mean_over_solid_angle():
    level = ambient_luminance(np.array([2.0, 8.0]), np.array([3.0, 1.0]))
    assert level == AmbientLevel(pytest.approx(3.5), "picture")
    assert ambient_luminance(np.ones(1), np.ones(1), probe_lux=np.zeros((0, 3))).origin == "picture"


def test_lamps_in_the_picture_are_no_surround():
    luminance, solid = np.full(1000, 2.0), np.full(1000, 0.001)
    luminance[:3] = 1e6
    assert ambient_luminance(luminance, solid).cd_m2 == pytest.approx(2.0)


def test_darkness_is_not_nothing():
    level = ambient_luminance(np.zeros(5), np.ones(5))
    assert 0 < level.cd_m2 < 1e-5
    assert glares(1e-3, level.cd_m2)
