"""Camera responses: exact inverses, so that unchanged light keeps its bytes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from andon.errors import InputError
from andon.responses import LINEAR, SRGB, Response, srgb_decode, srgb_encode
from comparison import assert_agree

KNOTS = np.linspace(0, 1, 9)[:, None] ** [1.8, 2.2, 2.6]
CURVE = Response("curve", linear=KNOTS, encoded=np.linspace(0, 1, 9)[:, None] * np.ones(3))
RESPONSES = [LINEAR, SRGB, Response("gamma", gamma=2.2), Response("gamma", gamma=0.8), CURVE]
IDS = ["linear", "srgb", "gamma 2.2", "gamma 0.8", "curve"]
CODES = np.arange(256)[:, None] * np.ones(3, int)


@pytest.mark.parametrize("response", RESPONSES, ids=IDS)
def test_every_code_comes_back(response):
    linear = response.decode(CODES / 255)
    assert (np.rint(response.encode(linear) * 255) == CODES).all()
    assert_agree(response.encode(linear), CODES / 255, atol=1e-7)


@pytest.mark.parametrize("response", RESPONSES, ids=IDS)
def test_black_and_white_stay_and_more_light_is_a_higher_code(response):
    linear = np.linspace(0, 1, 999)[:, None] * np.ones(3)
    encoded = response.encode(linear)
    assert (np.diff(encoded, axis=0) > 0).all()
    assert_agree(encoded[[0, -1]], [[0, 0, 0], [1, 1, 1]], atol=1e-12)


@given(st.floats(0, 1))
def test_srgb_is_the_standards_formula(x):
    expected = x / 12.92 if x <= 0.04045 else ((x + 0.055) / 1.055) ** 2.4
    assert srgb_decode(np.array(x)) == pytest.approx(expected, rel=1e-12, abs=1e-300)
    assert srgb_encode(np.array(expected)) == pytest.approx(x, abs=1e-7)


def test_published_values_of_srgb():
    """Mid grey 18 % is code 118 (117.6), and code 128 is 21.6 % (IEC 61966-2-1)."""
    assert srgb_encode(np.array(0.18)) * 255 == pytest.approx(117.65, abs=0.01)
    assert srgb_decode(np.array(128 / 255)) == pytest.approx(0.2158605, abs=1e-7)


def test_gamma_is_a_power_and_light_below_black_is_black():
    gamma = Response("gamma", gamma=2.0)
    assert gamma.decode(np.array([0.5])).tolist() == [0.25]
    assert gamma.encode(np.array([0.25, -0.1])).tolist() == [0.5, 0.0]
    assert srgb_encode(np.array(-0.1)) < 0


def test_a_curve_has_channels_of_its_own_and_is_clamped_at_its_ends():
    encoded = CURVE.encode(np.full((1, 1, 3), 0.3))
    assert len(set(encoded.ravel().tolist())) == 3
    assert CURVE.encode(np.full((1, 3), 7.0)).tolist() == [[1, 1, 1]]
    assert CURVE.decode(np.full((1, 3), -1.0)).tolist() == [[0, 0, 0]]


RISING = np.linspace(0, 1, 4)[:, None] * np.ones(3)
FLAT = RISING.copy()
FLAT[1, 2] = FLAT[2, 2]


@pytest.mark.parametrize(
    ("linear", "encoded", "message"),
    [
        (None, RISING, "linear: must be at least 2 rows of 3 channels, got None"),
        (RISING, RISING[:1], "encoded: must be at least 2 rows of 3"),
        (RISING[:, :2], RISING, "linear: must be at least 2 rows of 3"),
        (RISING[:, 0], RISING, "linear: must be at least 2 rows of 3"),
        (RISING, RISING[::-1], "encoded: must be finite and strictly increasing"),
        (FLAT, RISING, "linear: must be finite and strictly increasing"),
        (RISING * np.nan, RISING, "linear: must be finite and strictly increasing"),
        (RISING[:3], RISING, "must have as many rows"),
    ],
)
def test_curves_that_have_no_inverse_are_refused(linear, encoded, message):
    with pytest.raises(InputError, match=message):
        Response("curve", linear=linear, encoded=encoded)


@pytest.mark.parametrize("gamma", [0.0, -1.0, float("nan"), float("inf")])
def test_gammas_that_are_none_are_refused(gamma):
    with pytest.raises(InputError, match="gamma: must be > 0"):
        Response("gamma", gamma=gamma)
