"""The polar diagram: rings, which side is right, what is drawn."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from andon.display.polar import FIRST, SECOND, polar_picture, ring_values
from andon.lamps.goniometry import MainPlane

ANGLES = np.linspace(-180, 180, 3601)


@given(st.floats(1e-3, 1e7))
def test_rings(maximum):
    rings = ring_values(maximum)
    assert 2 <= len(rings) <= 5
    assert rings[-1] >= maximum * (1 - 1e-6)
    assert np.allclose(np.diff([0, *rings]), rings[0])
    assert rings[-1] - rings[0] < maximum
    digits = f"{rings[0]:.6e}".split("e")[0]
    assert float(digits) in (1, 2, 2.5, 5)


def picture(first, second, title="A lamp", facts="1 lm"):
    planes = (MainPlane("C0-C180", ANGLES, first), MainPlane("C90-C270", ANGLES, second))
    return polar_picture(planes, title, facts)


def centre_of(image, colour):
    """Mean (x, y) of the pixels of a colour, from the middle, in the diagram (not the legend)."""
    near = np.abs(image.astype(int) - colour).sum(axis=-1) < 60
    rows, columns = np.nonzero(near[60:770])
    assert len(rows) > 100
    return columns.mean() - 359.5, rows.mean() + 60 - 416


def test_the_named_side_is_right_and_the_axis_points_down():
    lobe_right = np.maximum(np.cos(np.radians(ANGLES - 60)), 0) ** 4
    lobe_up = np.maximum(-np.cos(np.radians(ANGLES)), 0) ** 4
    image = picture(lobe_right, lobe_up)
    assert image.shape == (828, 720, 3)
    assert image.dtype == np.uint8
    x, y = centre_of(image, FIRST)
    assert x > 50
    assert y > 20
    x, y = centre_of(image, SECOND)
    assert abs(x) < 15
    assert y < -50


def test_the_curve_reaches_the_ring_of_its_candela():
    """An even 100 cd on rings to 100: the curve is the outer ring."""
    image = picture(np.full(3601, 100.0), np.zeros(3601))
    red = np.abs(image.astype(int) - FIRST).sum(axis=-1) < 60
    columns = np.nonzero(red[416])[0]
    assert columns.min() == pytest.approx(40, abs=3)
    assert columns.max() == pytest.approx(680, abs=3)


def test_any_title_fits():
    image = picture(np.ones(3601), np.ones(3601), "Büro 照明 " * 50, "x" * 1000)
    assert (image[:, -8:] > 200).all(), "nothing runs over the edge"
