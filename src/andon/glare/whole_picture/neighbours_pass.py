"""What neighbours exchange, on the GPU."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.glare.whole_picture.neighbours import Neighbours
from andon.glare.whole_picture.tables import neighbour_tables
from andon.gpu.bindings import bind_group
from andon.gpu.device import Gpu
from andon.gpu.passes import FullscreenPass, color_attachment
from andon.gpu.textures import Texture, make_texture

__all__ = ["NeighboursPass"]

SHADER = "andon/glare/whole_picture/neighbours.wgsl"
PLUS = {
    part: {"operation": "add", "src_factor": "one", "dst_factor": "one"}
    for part in ("color", "alpha")
}


class NeighboursPass:
    """Adds to a target what the neighbours of each pixel of `source` send it."""

    # Loads of a pixel: eight of light and as many of what is exchanged, itself, its factors.
    TAPS = 18

    def __init__(self, gpu: Gpu, source: Texture, format: str, neighbours: Neighbours) -> None:
        exchanged, factors = neighbour_tables(neighbours)
        inputs = {
            0: ("float", source.view),
            1: ("float", _filled(gpu, "rgba32float", exchanged)),
            2: ("float", _filled(gpu, "rg32float", factors)),
        }
        groups = [bind_group(gpu, inputs, "neighbours")]
        self._added, self._passed = (
            FullscreenPass(gpu, SHADER, entry, [format], groups, blend=PLUS)
            for entry in ("added", "passed")
        )

    def encode(self, encoder: Any, target: Texture, *, alone: bool) -> None:
        """Records it on top of the veil `alone`, or of the picture, less what its pixels send."""
        step = self._added if alone else self._passed
        attachment = color_attachment(target.view, load=True)
        render = encoder.begin_render_pass(label="neighbours", color_attachments=[attachment])
        render.set_pipeline(step.pipeline)
        render.set_bind_group(0, step.groups[0].group)
        render.draw(3)
        render.end()


def _filled(gpu: Gpu, format: str, values: NDArray[np.float64]) -> Any:
    texture = make_texture(gpu, format, values.shape[1], values.shape[0])
    texture.write(values)
    return texture.view
