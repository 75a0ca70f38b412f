"""Sources in a frame on the GPU: a mask of its bright pixels, and light of these alone."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.glare.model import Source
from andon.glare.sources.live import sources_of_bright
from andon.gpu.bindings import bind_group
from andon.gpu.device import Gpu
from andon.gpu.passes import FullscreenPass
from andon.gpu.textures import Texture, make_texture
from andon.spaces import View

__all__ = ["SourceStage"]

MODULE, CONSTANTS = "andon/glare/sources/bright.wgsl", "andon/glare/sources/threshold.wgsl"


class SourceStage:
    """Finds what is brighter than a threshold in `light`, rgba16float of the view's size.

    The mask is a byte a pixel; the picture itself is read back only where something is bright.
    """

    def __init__(
        self,
        gpu: Gpu,
        light: Texture,
        view: View,
        threshold_cd_m2: float,
        luminance_per_unit: float,
    ) -> None:
        self.view, self._light, self._per_unit = view, light, luminance_per_unit
        self._solid = view.solid_angles()
        self._mask = make_texture(gpu, "r8unorm", view.width, view.height, label="bright")
        threshold = threshold_cd_m2 / luminance_per_unit
        self._pass = FullscreenPass(
            gpu,
            MODULE,
            "bright",
            [self._mask.format],
            [bind_group(gpu, {0: ("float", light.view)}, "light")],
            variants={CONSTANTS: f"const THRESHOLD: f32 = {threshold:.9g}f;"},
        )

    def encode(self, encoder: Any) -> None:
        """Records the mask."""
        self._pass.encode(encoder, [self._mask.view])

    def read(self, most: int, /) -> list[Source]:
        """The `most` strongest sources of what was drawn; waits for the device."""
        bright = self._mask.read()[..., 0] > 0
        if not bright.any():
            return []
        picture = self._light.read()

        def light_of(rows: NDArray[np.intp], columns: NDArray[np.intp]) -> NDArray[np.float64]:
            units = picture[rows, columns, :3].astype(np.float64)
            return np.minimum(units, np.finfo(np.float16).max) * self._per_unit

        return sources_of_bright(bright, light_of, self._solid, self.view, most=most)
