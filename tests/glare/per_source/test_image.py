"""A golden picture of all shapes: bloom and halo on black, from both engines."""

import numpy as np

from andon.display.model import Exposure
from andon.display.reference import encode
from andon.glare import shapes
from andon.glare.model import Source
from andon.glare.per_source.reference import veil_of_sources
from andon.observer.spread.family import spread_function
from andon.responses import SRGB
from comparison import assert_golden, assert_same_picture

from .drawing import drawn
from .views import KERNEL, pinhole

DEGREE = np.pi / 180
VIEW = pinhole(50, 150, 100)
SHAPES = [
    (shapes.circle(0.01 * DEGREE), 25, 25),
    (shapes.ellipse(4 * DEGREE, 1 * DEGREE), 75, 25),
    (shapes.cylinder(4 * DEGREE, 0.3 * DEGREE), 125, 25),
    (shapes.hemisphere(2 * DEGREE), 44, 72),
    (shapes.pear(2 * DEGREE, 0.6 * DEGREE, 3 * DEGREE), 106, 72),
]
OPTIONS = {"halo": spread_function("spencer")}


def lamps():
    lux = np.array([6.0, 4.0, 2.0])
    return [Source(VIEW.directions_at([x, y]), lux, outline) for outline, x, y in SHAPES]


def codes(luminance):
    return encode(luminance / 4, Exposure(tone="reinhard"), SRGB, 1.0)


def test_shapes(gpu, tmp_path, regenerate):
    expected = codes(veil_of_sources(lamps(), VIEW, KERNEL, **OPTIONS))
    assert_golden(expected, "glare-shapes", tmp_path)
    actual = codes(drawn(gpu, VIEW, lamps(), **OPTIONS))
    assert_same_picture(actual, expected, tmp_path)
