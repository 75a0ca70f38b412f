"""Speed of known sources drawn in a whole picture of 1280×720, beside NumPy.

A pixel and source costs one read of 16 bytes (a circle; two of an outline), and 8 bytes are blended
once for all sources of a form.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from andon.bench.registry import BenchRow, Duel
from andon.glare import shapes
from andon.glare.kernel import Kernel
from andon.glare.model import Outline, Source
from andon.glare.per_source.reference import veil_of_sources
from andon.glare.per_source.stage import PerSourceStage
from andon.gpu.device import open_gpu
from andon.gpu.textures import make_texture
from andon.observer.spread.family import spread_function
from andon.spaces import pinhole_view

__all__ = ["ROWS"]

WIDTH, HEIGHT = 1280, 720
# A pixel is the same where it differs by no more than this share.
AGREED = 0.01
OUTLINES = {
    "circles": shapes.circle(np.radians(0.1)),
    "ellipses": shapes.ellipse(np.radians(0.3), np.radians(0.1)),
}


def _against_numpy(outline: Outline, count: int) -> Duel:
    gpu, kernel = open_gpu(), Kernel(spread_function("cie146-general"))
    view = pinhole_view(WIDTH, HEIGHT, WIDTH / 2 / np.tan(np.radians(30)))
    generator = np.random.default_rng(1)
    places = view.directions_at(generator.uniform(0, (WIDTH, HEIGHT), (count, 2)))
    sources = [Source(place, np.full(3, 5.0), outline) for place in places]
    stage = PerSourceStage(gpu, view, count)
    stage.update(sources, kernel)
    target = make_texture(gpu, "rgba16float", WIDTH, HEIGHT)

    def ours() -> None:
        encoder = gpu.device.create_command_encoder()
        stage.encode(encoder, target)
        gpu.device.queue.submit([encoder.finish()])
        gpu.wait()

    def peer() -> Any:
        return veil_of_sources(sources, view, kernel)

    target.write(np.zeros((HEIGHT, WIDTH, 4)))
    ours()
    expected = np.minimum(peer(), 65504.0)
    off = np.abs(np.asarray(target.read()[..., :3], np.float64) - expected)
    agreement = float(np.count_nonzero(off <= AGREED * expected) / off.size)
    return Duel(ours, peer, agreement, 0.999, gpu.adapter_name, peer_repeats=1)


ROWS: tuple[BenchRow, ...] = tuple(
    BenchRow(
        f"glare.quads.{count}_{name}",
        "glare",
        "NumPy, float64, the same sources",
        WIDTH * HEIGHT * count,
        partial(_against_numpy, OUTLINES[name], count),
    )
    for name, count in (("circles", 1), ("circles", 16), ("ellipses", 4))
)
