"""Golden pictures as the paper shows them: bodies alone, filtered, composed."""

import numpy as np
import pytest

from andon.display.model import Exposure
from andon.display.reference import encode
from andon.glow.model import Glow
from andon.glow.reference import add_glow, filtered
from andon.glow.stage import GlowStage
from andon.gpu.textures import make_texture
from andon.responses import SRGB
from andon.spaces import View
from comparison import assert_golden

VIEW = View("pinhole", 120, 90, 300.0, 300.0, 59.5, 44.5)
# The paper's filter, and a body that stays sharp in a veil of a third of its light.
GLOWS = {"paper": Glow(5.0 / 300.0), "third": Glow(12.0 / 300.0, 0.32)}


def room():
    """A paper lantern, a bulb and a tube before a dim wall, in units of the picture's white."""
    rows, columns = np.mgrid[:90, :120] + 0.0
    lantern = (np.abs(columns - 34) < 11) & (np.abs(rows - 52) < 17)
    bulb = np.hypot(rows - 22, columns - 88) < 5
    tube = (np.abs(rows - 66) < 2) & (np.abs(columns - 88) < 20)
    bodies = (
        lantern[..., None] * [1.3, 0.8, 0.35]
        + bulb[..., None] * [5.0, 4.6, 4.0]
        + tube[..., None] * [1.0, 1.4, 2.4]
    )
    wall = 0.02 + 0.02 * ((rows // 15 + columns // 15) % 2)
    picture = np.where(bodies > 0, bodies, wall[..., None])
    return tuple(np.float16(part).astype(np.float64) for part in (picture, bodies))


def codes(picture):
    return encode(picture, Exposure(tone="reinhard"), SRGB, 1.0)


def of_reference(light):
    picture, bodies = room()
    parts = bodies, filtered(bodies, light, VIEW), add_glow(picture, bodies, light, VIEW)
    return np.concatenate([codes(part) for part in parts], axis=1)


def of_gpu(gpu, light):
    picture, bodies = room()

    def texture(values):
        made = make_texture(gpu, "rgba16float", VIEW.width, VIEW.height)
        made.write(np.dstack([values, np.ones(VIEW.shape)]))
        return made

    source, target, alone = texture(bodies), texture(picture), texture(bodies)
    stage = GlowStage(gpu, source, target, light, VIEW)
    encoder = gpu.device.create_command_encoder()
    stage.encode_filtered(encoder, alone)
    stage.encode(encoder)
    gpu.device.queue.submit([encoder.finish()])
    parts = (made.read()[..., :3].astype(np.float64) for made in (source, alone, target))
    return np.concatenate([codes(part) for part in parts], axis=1)


@pytest.mark.parametrize("name", GLOWS)
def test_bodies_alone_filtered_and_composed(name, tmp_path):
    assert_golden(of_reference(GLOWS[name]), f"glow-{name}", tmp_path)


@pytest.mark.parametrize("name", GLOWS)
def test_the_gpus_pictures(gpu, name, tmp_path):
    assert_golden(of_gpu(gpu, GLOWS[name]), f"glow-{name}", tmp_path, written=False)
