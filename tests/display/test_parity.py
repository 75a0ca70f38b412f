"""The display's shader against the reference, code by code."""

import numpy as np
import pytest

from andon.display import reference
from andon.display.model import Exposure
from andon.display.stage import DisplayStage
from andon.gpu.textures import make_texture
from andon.responses import LINEAR, SRGB, Response

KNOTS = np.linspace(0, 1, 33)[:, None]
RESPONSES = {
    "linear": LINEAR,
    "srgb": SRGB,
    "gamma 2.2": Response("gamma", gamma=2.2),
    "gamma 3": Response("gamma", gamma=3.0),
    "curve": Response("curve", linear=KNOTS ** [1.5, 2.2, 3.0], encoded=KNOTS * np.ones(3)),
}
# Every half float from 0 to 16 in steps, in other orders for green and blue.
HALVES = np.arange(0, 0x4C00, 7).astype(np.uint16).view(np.float16).astype(np.float64)
LIGHT = np.stack([HALVES, HALVES[::-1], np.roll(HALVES, 700)], axis=-1).reshape(1, -1, 3)


def shown_by_gpu(gpu, linear, response, exposure, per_unit):
    texture = make_texture(gpu, "rgba16float", linear.shape[1], linear.shape[0])
    texture.write(np.dstack([linear, np.ones(linear.shape[:2])]))
    stage = DisplayStage(gpu, texture, response, exposure, per_unit)
    encoder = gpu.device.create_command_encoder()
    stage.encode(encoder)
    gpu.device.queue.submit([encoder.finish()])
    return stage.read().rgb


@pytest.mark.parametrize("tone", ["none", "hue", "reinhard"])
@pytest.mark.parametrize("name", RESPONSES)
def test_codes_agree(gpu, name, tone):
    exposure, response = Exposure(tone=tone), RESPONSES[name]
    expected = reference.encode(LIGHT * 50.0, exposure, response, 50.0)
    actual = shown_by_gpu(gpu, LIGHT, response, exposure, 50.0)
    difference = np.abs(actual.astype(int) - expected.astype(int))
    assert difference.max() <= 1
    assert (difference > 0).mean() < 0.01
    assert len(np.unique(expected)) > 200


@pytest.mark.parametrize("tone", ["none", "hue", "reinhard"])
@pytest.mark.parametrize("name", RESPONSES)
def test_infinite_light_is_white(gpu, name, tone):
    light = np.array([[[np.inf, 0.25, np.inf], [0.0, np.inf, 60000.0]]])
    exposure = Exposure(tone=tone)
    expected = reference.encode(light, exposure, RESPONSES[name], 1.0)
    actual = shown_by_gpu(gpu, light, RESPONSES[name], exposure, 1.0)
    assert np.abs(actual.astype(int) - expected.astype(int)).max() <= 1
    assert (actual[np.isinf(light)] == 255).all()


def test_a_stated_exposure_agrees(gpu):
    exposure = Exposure(units_per_cd_m2=0.004)
    expected = reference.encode(LIGHT * 50.0, exposure, SRGB, 50.0)
    actual = shown_by_gpu(gpu, LIGHT, SRGB, exposure, 50.0)
    assert np.abs(actual.astype(int) - expected.astype(int)).max() <= 1


@pytest.mark.parametrize("name", RESPONSES)
def test_all_codes_come_back(gpu, name):
    """Half floats and float32 powers between them cost no code."""
    codes = np.arange(256).reshape(1, 256, 1) * np.ones(3)
    linear = RESPONSES[name].decode(codes / 255)
    assert (shown_by_gpu(gpu, linear, RESPONSES[name], Exposure(), 1.0) == codes).all()
