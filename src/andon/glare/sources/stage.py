"""Sources in a frame on the GPU: it surveys, the host looks at what is bright."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.glare.sources.live import LiveSources, SourceFinder
from andon.glare.sources.survey import SIDE_PX, Survey
from andon.gpu.bindings import bind_group
from andon.gpu.device import Gpu
from andon.gpu.passes import FullscreenPass
from andon.gpu.textures import HALF_MOST, Texture, make_texture

__all__ = ["SourceStage"]


class SourceStage:
    """Finds sources in `light`, rgba16float of the finder's view, in units of `per_unit` cd/m².

    The picture itself is read back only where the survey says that something is bright.
    """

    def __init__(self, gpu: Gpu, light: Texture, finder: SourceFinder, per_unit: float) -> None:
        self._light, self._finder, self._per_unit = light, finder, per_unit
        columns, rows = (-(-size // SIDE_PX) for size in (light.width, light.height))
        self._tiles = make_texture(gpu, "rg32float", columns, rows, label="survey")
        group = bind_group(gpu, {0: ("float", light.view)}, "light")
        self._pass = FullscreenPass(
            gpu, "andon/glare/sources/survey.wgsl", "survey", [self._tiles.format], [group]
        )

    def encode(self, encoder: Any) -> None:
        """Records the survey."""
        self._pass.encode(encoder, [self._tiles.view])

    def read(self) -> LiveSources:
        """The sources of what was drawn; waits for the device."""
        mean, peak = np.moveaxis(self._tiles.read().astype(np.float64) * self._per_unit, -1, 0)
        return self._finder.find(Survey(mean, peak), self._light_of)

    def _light_of(self, rows: NDArray[np.intp], columns: NDArray[np.intp]) -> NDArray[np.float64]:
        units = self._light.read()[rows, columns, :3].astype(np.float64)
        return np.clip(units, 0, HALF_MOST) * self._per_unit
