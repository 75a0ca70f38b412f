"""Tiles of highlights on the GPU: two small passes, each read back."""

from __future__ import annotations

from typing import Any

import numpy as np

from andon import gbuffer
from andon.glare.highlights.contrast import AmbientLevel
from andon.glare.highlights.tiles import (
    SIDE_PX,
    Float,
    Highlight,
    LightTiles,
    SurveyTiles,
    highlights_of_tiles,
    threshold_cd_m2,
)
from andon.gpu.bindings import bind_group
from andon.gpu.device import Gpu
from andon.gpu.layout import HostStruct
from andon.gpu.passes import FullscreenPass
from andon.gpu.textures import Texture, make_texture, uniform_buffer, write_buffer
from andon.spaces import View

__all__ = ["TILE_RECORD", "TileStage"]

SHADER = "andon/glare/highlights/tiles.wgsl"

TILE_RECORD = HostStruct("TileRecord", (("threshold_cd_m2", "f32"), ("cd_m2_per_unit", "f32")))


class TileStage:
    """Finds the highlights of one view.

    Parameters
    ----------
    highlights : lamps mirrored, cd/m².
    luminance : the picture, in units of `cd_m2_per_unit`.
    view_buffer : its `VIEW_RECORD`.
    """

    def __init__(
        self,
        gpu: Gpu,
        view: View,
        highlights: Texture,
        luminance: Texture,
        view_buffer: Any,
        cd_m2_per_unit: float,
    ) -> None:
        self.gpu, self.view, self._unit = gpu, view, cd_m2_per_unit
        columns, rows = (-(-size // SIDE_PX) for size in (view.width, view.height))
        self._settings = uniform_buffer(gpu, TILE_RECORD.dtype.itemsize, "tiles")
        self._found = [make_texture(gpu, "rgba32float", columns, rows) for _ in range(3)]
        group = bind_group(
            gpu,
            {
                0: ("float", highlights.view),
                1: ("uniform", view_buffer),
                2: ("uniform", self._settings),
                3: ("float", luminance.view),
            },
        )
        options: dict[str, Any] = {
            "structs": gbuffer.STRUCTS | {TILE_RECORD.name: TILE_RECORD},
            "variants": gbuffer.projection_variant(view),
        }
        formats = [texture.format for texture in self._found]
        self._survey = FullscreenPass(gpu, SHADER, "survey", formats[:1], [group], **options)
        self._light = FullscreenPass(gpu, SHADER, "light", formats[1:], [group], **options)

    def survey(self) -> SurveyTiles:
        """What there is; waits for the device."""
        self._write(1.0)
        peak, surround, omega, _ = self._drawn(self._survey, self._found[:1])[0]
        return SurveyTiles(peak, surround, omega)

    def light(self, threshold: float) -> LightTiles:
        """Highlights above `threshold` in cd/m²; waits for the device."""
        self._write(threshold)
        first, second = self._drawn(self._light, self._found[1:])
        sums = np.stack([first[3], *second], axis=-1)
        return LightTiles(np.moveaxis(first[:3], 0, -1), sums)

    def find(self, probe_lux: Float | None, gate: float) -> tuple[AmbientLevel, list[Highlight]]:
        """The ambient level and the highlights of what was drawn last."""
        survey = self.survey()
        ambient = survey.ambient(probe_lux, gate)
        light = self.light(threshold_cd_m2(ambient, gate))
        return ambient, highlights_of_tiles(light, survey, ambient, self.view, gate)

    def _write(self, threshold: float) -> None:
        record = TILE_RECORD.pack(threshold_cd_m2=threshold, cd_m2_per_unit=self._unit)
        write_buffer(self.gpu, self._settings, record)

    def _drawn(self, drawing: FullscreenPass, targets: list[Texture]) -> list[Float]:
        """(4, r, c) of each target."""
        encoder = self.gpu.device.create_command_encoder(label="tiles")
        drawing.encode(encoder, [target.view for target in targets])
        self.gpu.device.queue.submit([encoder.finish()])
        return [np.moveaxis(target.read().astype(np.float64), -1, 0) for target in targets]
