"""The display on the GPU."""

from __future__ import annotations

from typing import Any

import numpy as np

from andon.display.fusion import fused_codes
from andon.display.model import Exposure
from andon.gpu.bindings import bind_group
from andon.gpu.device import Gpu
from andon.gpu.layout import HostStruct
from andon.gpu.passes import FullscreenPass
from andon.gpu.textures import Texture, make_texture, uniform_buffer, write_buffer
from andon.quantities import DisplayImage
from andon.responses import Response

__all__ = ["DISPLAY_RECORD", "STRUCTS", "DisplayStage"]

DISPLAY_RECORD = HostStruct(
    "DisplayRecord", (("exposure", "f32"), ("gamma", "f32"), ("tone", "u32"))
)
STRUCTS = {DISPLAY_RECORD.name: DISPLAY_RECORD}
# Fusion looks at the whole picture in pyramids: the host does it when the picture is read.
TONES = {"none": 0, "reinhard": 1, "hue": 2, "fusion": 0}
# Samples of a measured response at equal steps of √linear: the error of linear interpolation is
# below 0.1 code for curves as bent as a gamma of 3.
CURVE_SAMPLES = 4096


class DisplayStage:
    """Reads luminance in the picture's linear units, writes 8-bit codes."""

    def __init__(
        self,
        gpu: Gpu,
        luminance: Texture,
        response: Response,
        exposure: Exposure,
        luminance_per_unit: float,
    ) -> None:
        self.gpu = gpu
        self._luminance, self._settings = luminance, (exposure, response, luminance_per_unit)
        size = (luminance.width, luminance.height)
        self.image = make_texture(gpu, "rgba8unorm", *size, label="display")
        settings = uniform_buffer(gpu, DISPLAY_RECORD.dtype.itemsize, "display")
        scale = exposure.units_per_cd_m2 or 1 / luminance_per_unit
        record = DISPLAY_RECORD.pack(
            exposure=scale * luminance_per_unit, gamma=response.gamma, tone=TONES[exposure.tone]
        )
        write_buffer(gpu, settings, record)
        resources: dict[int, tuple[str, Any]] = {
            0: ("float", luminance.view),
            1: ("uniform", settings),
        }
        if response.kind == "curve":
            curve = make_texture(gpu, "rgba32float", CURVE_SAMPLES, 1, label="response")
            linear = np.linspace(0, 1, CURVE_SAMPLES)[:, None] ** 2 * np.ones(3)
            curve.write(np.column_stack([response.encode(linear), np.ones(CURVE_SAMPLES)])[None])
            resources[2] = ("float", curve.view)
        self._pass = FullscreenPass(
            gpu,
            "andon/display/display.wgsl",
            f"encode_{response.kind}",
            ["rgba8unorm"],
            [bind_group(gpu, resources, "display")],
            structs=STRUCTS,
        )

    def encode(self, encoder: Any) -> None:
        """Records the pass."""
        self._pass.encode(encoder, [self.image.view])

    def read(self) -> DisplayImage:
        """The picture, waiting for the device; the tone ``fusion`` is done here, on the host."""
        exposure, response, per_unit = self._settings
        if exposure.tone == "fusion":
            cd_m2 = self._luminance.read()[..., :3].astype(np.float64) * per_unit
            return DisplayImage(fused_codes(cd_m2, exposure, response, per_unit))
        return DisplayImage(np.ascontiguousarray(self.image.read()[..., :3]))
