"""The stage's picture of sources."""

import numpy as np

from andon.glare.per_source.stage import PerSourceStage
from andon.gpu.textures import make_texture

from .views import KERNEL


def drawn(gpu, view, sources, **options):
    """(H, W, 3) that the stage adds to a black picture."""
    stage = PerSourceStage(gpu, view, len(sources))
    stage.update(sources, KERNEL, **options)
    return encoded(gpu, view, stage)


def encoded(gpu, view, stage, start=0.0):
    target = make_texture(gpu, "rgba16float", view.width, view.height)
    target.write(np.full((*view.shape, 4), start))
    encoder = gpu.device.create_command_encoder()
    stage.encode(encoder, target)
    gpu.device.queue.submit([encoder.finish()])
    picture = target.read().astype(np.float64)
    assert (picture[..., 3] == start).all()
    return picture[..., :3]
