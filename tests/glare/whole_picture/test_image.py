"""Golden picture: lamps at night with their veil, by both engines."""

import numpy as np
import pytest

from andon.display.model import Exposure
from andon.display.reference import encode
from andon.glare.kernel import Kernel
from andon.glare.whole_picture import reference
from andon.glare.whole_picture.plan import plan_whole
from andon.glare.whole_picture.stage import WholePictureStage
from andon.gpu.textures import make_texture
from andon.observer.spread.family import spread_function
from andon.responses import SRGB
from andon.spaces import pinhole_view
from comparison import assert_golden

VIEW = pinhole_view(192, 108, 166.0)
PLAN = plan_whole(VIEW, Kernel(spread_function("cie135")))


def lamps():
    """A dim wall, three round lamps of 1.5 to 5 px, a tube and a dark post before the wall."""
    rows, columns = np.mgrid[: VIEW.height, : VIEW.width]
    picture = np.full((*VIEW.shape, 3), 0.02) * (1 + rows / 54)[..., None]
    for row, column, radius, light in (
        (30, 40, 5, [40, 30, 15]),
        (60, 120, 1.5, [900, 900, 900]),
        (25, 165, 3, [15, 40, 60]),
    ):
        picture[np.hypot(rows - row, columns - column) < radius] = light
    picture[88:91, 20:90] = [12, 14, 12]
    picture[40:, 96:104] = 0.002
    return picture.astype(np.float16).astype(np.float64)


def by_gpu(gpu, light):
    source, target = (make_texture(gpu, "rgba16float", VIEW.width, VIEW.height) for _ in range(2))
    source.write(np.dstack([light, np.ones(VIEW.shape)]))
    encoder = gpu.device.create_command_encoder()
    WholePictureStage(gpu, source, target, PLAN, finite=True).encode(encoder)
    gpu.device.queue.submit([encoder.finish()])
    return target.read()[..., :3].astype(np.float64)


@pytest.mark.parametrize("engine", ["reference", "gpu"])
def test_lamps(engine, tmp_path, request):
    light = lamps()
    if engine == "gpu":
        seen = by_gpu(request.getfixturevalue("gpu"), light)
    else:
        seen = reference.scattered(light, PLAN).picture
    picture = encode(seen, Exposure(tone="reinhard"), SRGB, 1.0)
    assert_golden(picture, "glare-whole", tmp_path, written=engine == "reference")
