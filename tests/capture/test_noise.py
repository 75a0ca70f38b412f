"""The noise of a photograph, told from the photograph alone."""

import numpy as np
import pytest

from andon.capture.noise import noise_codes
from andon.capture.still import frame_from_picture
from andon.files.pictures import Picture
from andon.responses import SRGB
from andon.spaces import View

STEP = 1 / 255


def frame_of(linear, response=SRGB):
    height, width = linear.shape[:2]
    codes = np.asarray(np.clip(response.encode(np.clip(linear, 0, 1)), 0, 1) * 255 + 0.5, np.uint8)
    view = View("pinhole", width, height, width, width, width / 2, height / 2)
    return frame_from_picture(Picture(codes, "srgb"), view, response, luminance_per_unit=1.0)


def slope(linear):
    """Of sRGB: encoded by linear."""
    return (SRGB.encode(linear * 1.0001) - SRGB.encode(linear)) / (linear * 0.0001)


def lit(rows=300, columns=400):
    """A smooth picture over most of the range, (H, W, 3)."""
    down, right = np.mgrid[:rows, :columns] / columns
    return np.stack([0.04 + 0.4 * right, 0.5 - 0.4 * right, 0.1 + 0.3 * down], axis=-1)


@pytest.mark.parametrize("sigma", [0.004, 0.01, 0.02])
def test_noise_of_light_is_found_where_the_response_puts_it(sigma):
    """σ of light times the slope of the response, and the rounding to codes."""
    light = lit()
    noisy = light + np.random.default_rng(1).normal(0, sigma, light.shape)
    expected = np.hypot(sigma * slope(light), STEP / np.sqrt(12))
    found = noise_codes(frame_of(noisy))
    ratio = found / expected
    assert np.median(ratio) == pytest.approx(1, abs=0.05)
    assert np.percentile(ratio, [5, 95]) == pytest.approx([1, 1], abs=0.25)


def test_without_noise_there_is_the_rounding():
    assert noise_codes(frame_of(lit())) == pytest.approx(STEP / np.sqrt(12))


def test_edges_are_no_noise():
    light = lit()
    light[:, ::40] *= 0.5
    light[::60] *= 1.4
    assert np.median(noise_codes(frame_of(light))) == pytest.approx(STEP / np.sqrt(12), rel=0.1)


def test_a_picture_without_a_flat_part_has_its_rounding():
    light = np.random.default_rng(2).random((10, 12, 3))
    assert noise_codes(frame_of(light)) == pytest.approx(STEP / np.sqrt(12))


def test_floats_have_none():
    light = lit().astype(np.float32)
    view = View("pinhole", 400, 300, 400, 400, 200, 150)
    frame = frame_from_picture(Picture(light, "linear"), view, SRGB, luminance_per_unit=1.0)
    assert (noise_codes(frame) == 0).all()
