"""Exposure, tone and codes, against closed forms."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from andon.display.model import Exposure
from andon.display.reference import SHOULDER_START, encode, tone_curve
from andon.responses import LINEAR, SRGB
from comparison import assert_agree

LIGHT = np.concatenate([np.linspace(0, 3, 4001), np.geomspace(3.1, 1e6, 500)])


@pytest.mark.parametrize("tone", ["none", "reinhard"])
def test_more_light_is_never_darker_and_stays_within_the_screen(tone):
    shown = tone_curve(LIGHT, tone)
    assert (np.diff(shown) >= 0).all()
    assert shown[0] == 0
    assert shown.max() <= 1
    if tone == "reinhard":
        assert (np.diff(shown) > 0).all()
        assert shown.max() < 1


def test_what_is_brighter_than_the_screen_keeps_its_hue():
    """The order of the channels and the ratio of their distances from white stay."""
    warm = np.array([1.0, 0.6, 0.2])
    steps = [tone_curve(k * warm, "hue") for k in (0.5, 1.0, 1.001, 2.0, 8.0, 1e6)]
    np.testing.assert_array_equal(steps[0], 0.5 * warm)
    np.testing.assert_allclose(steps[1], warm)
    np.testing.assert_allclose(steps[2], warm, atol=1e-3)
    np.testing.assert_allclose(steps[3], warm + (1 - warm) * (1 - np.sqrt(0.5)))
    assert (np.diff(np.array(steps), axis=0) >= 0).all()
    for step in steps[1:]:
        np.testing.assert_allclose((1 - step[1]) / (1 - step[2] + 1e-300), 0.5, rtol=1e-6)
    np.testing.assert_allclose(steps[-1], 1, atol=2e-3)
    clipped = tone_curve(8 * warm, "none")
    assert clipped.tolist() == [1, 1, 1]


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("tone", ["none", "hue", "reinhard"])
def test_infinite_light_is_white(tone):
    """Captured light above 65504 comes as infinity from half floats."""
    light = np.array([[[np.inf, 0.5, 1e300], [-np.inf, np.inf, 65504.0]]])
    shown = tone_curve(light, tone)
    assert np.isfinite(shown).all()
    assert shown[0, 0, 0] == shown[0, 1, 1] == 1
    codes = encode(light, Exposure(tone=tone), SRGB, 1.0)
    if tone == "hue":  # infinitely brighter than the screen in one channel: white in all
        assert (codes == 255).all()
        return
    assert shown[0, 1, 0] == 0
    assert codes[0].tolist() == [[255, 188, 255], [0, 255, 255]]


def test_the_shoulder_begins_with_slope_one():
    step = 1e-6
    below, at, above = tone_curve(SHOULDER_START + np.array([-step, 0, step]), "reinhard")
    assert at == pytest.approx(SHOULDER_START, abs=1e-15)
    assert (at - below) / step == pytest.approx(1, abs=1e-4)
    assert (above - at) / step == pytest.approx(1, abs=1e-4)
    # It bends: twice the shoulder's width above its start, two thirds are left, not two.
    assert tone_curve(np.array(1.4), "reinhard") == pytest.approx(0.6 + 0.4 * 2 / 3)


@given(st.floats(0, SHOULDER_START))
def test_below_the_shoulder_light_is_itself(x):
    assert tone_curve(np.array(x), "reinhard") == x
    assert tone_curve(np.array(x), "none") == x


def test_light_below_black_is_black():
    for tone in ("none", "reinhard"):
        assert tone_curve(np.array(-0.5), tone) == 0


def test_codes_are_rounded_to_the_nearest():
    """Linear response: 127.49 is 127 and 127.51 is 128; 300 is 255 and −4 is 0."""
    codes = np.array([127.49, 127.51, 0.49, 0.51, 254.6, 300, -4])
    picture = np.repeat((codes / 255)[None, :, None], 3, axis=2)
    shown = encode(picture, Exposure(), LINEAR, 1.0)
    assert shown.dtype == np.uint8
    assert shown[0, :, 0].tolist() == [127, 128, 0, 1, 255, 255, 0]


@given(st.floats(1e-3, 1e5))
def test_the_cameras_exposure_keeps_its_codes_whatever_its_unit(per_unit):
    codes = np.arange(256)[None, :, None] * np.ones(3)
    luminance = per_unit * SRGB.decode(codes / 255)
    assert (encode(luminance, Exposure(), SRGB, per_unit) == codes).all()


def test_a_stated_exposure_is_the_screens():
    """0.002 units per cd/m²: 250 cd/m² is linear 0.5, whatever the camera's unit."""
    grey = np.full((1, 1, 3), 250.0)
    for per_unit in (1.0, 80.0):
        shown = encode(grey, Exposure(units_per_cd_m2=0.002), LINEAR, per_unit)
        assert shown.ravel().tolist() == [128, 128, 128]


def test_channels_do_not_mix():
    picture = np.array([[[0.2, 0.5, 0.9]]])
    alone = [
        encode(picture[..., [c, c, c]], Exposure(tone="reinhard"), SRGB, 1.0) for c in range(3)
    ]
    together = encode(picture, Exposure(tone="reinhard"), SRGB, 1.0)
    assert_agree(together[0, 0], [alone[c][0, 0, 0] for c in range(3)])
