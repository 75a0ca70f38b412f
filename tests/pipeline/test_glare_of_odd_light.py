"""Pixels that are no light, or more than half floats hold, in a frame with glare on the GPU."""

import numpy as np
import pytest

from andon.engines.glare_gpu import GlareView
from andon.engines.prepared import prepare
from andon.gpu.textures import make_texture
from worlds import scene


@pytest.mark.parametrize("renderer", ["whole-picture", "per-source"])
@pytest.mark.parametrize("is_behind_glass", [False, True])
def test_infinite_light_and_none_leave_a_picture(gpu, tmp_path, renderer, is_behind_glass):
    settings = {"model": "cie135", "renderer": renderer, "highlights": False}
    prepared = prepare(scene(tmp_path, lamp=[], ambient={"illuminance_lux": 2}, glare=settings))
    frame = prepared.frames["mono"]
    shape = frame.view.shape
    light = make_texture(gpu, "rgba16float", shape[1], shape[0])
    values = np.full((*shape, 4), 0.1)
    values[20:23, 30:33, :3] = np.inf
    values[5, 5, :3] = np.nan
    light.write(values)
    mirrored = make_texture(gpu, "rgba32float", shape[1], shape[0])
    mirrored.write(np.where(np.isinf(values), np.inf, 0))
    real = np.zeros((*shape, 3)) if is_behind_glass else None
    hiding = prepared.surface.shadow_casters
    view = GlareView(gpu, prepared.glare, frame, light, hiding, real, mirrored)
    for record in (view.encode_sources, view.encode):
        encoder = gpu.device.create_command_encoder()
        record(encoder)
        gpu.device.queue.submit([encoder.finish()])
        view.update([])
    seen = view.seen.read()[..., :3].astype(np.float64)
    assert np.isfinite(seen[np.isfinite(values[..., :3])]).all()
    assert not np.isnan(seen).any()
    assert seen[21, 31].min() > 1e4
    assert seen[5, 5].max() < 1e4
