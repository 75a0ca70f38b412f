"""What flows: photometric weights, frozen records."""

from dataclasses import FrozenInstanceError

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from andon.quantities import LUMINANCE_WEIGHTS, Illuminance, photometric
from andon.spaces import View
from andon.surface.reference import empty_surface


@given(st.floats(0, 1e6))
def test_neutral_light_has_equal_channels(lux):
    assert photometric(np.full((2, 3, 3), lux)) == pytest.approx(np.full((2, 3), lux))


def test_weights_are_those_of_rec_709():
    assert photometric(np.eye(3)).tolist() == [0.2126, 0.7152, 0.0722]
    with pytest.raises(ValueError, match="read-only"):
        LUMINANCE_WEIGHTS[0] = 1


def test_quantities_are_frozen():
    light = Illuminance(np.zeros((1, 1, 3)))
    with pytest.raises(FrozenInstanceError):
        light.lux = np.ones((1, 1, 3))


def test_a_surface_counts_its_holes():
    surface = empty_surface(View("latlong", 6, 3))
    assert surface.holes == 18
    surface.valid[0] = True
    assert surface.holes == 12
