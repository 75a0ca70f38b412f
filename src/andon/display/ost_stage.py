"""Optical see-through on the GPU: codes for the display, and what is seen through it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.display.model import Exposure, Seen, SeeThrough
from andon.display.ost import reach, real_light
from andon.display.stage import DisplayStage
from andon.gpu.bindings import bind_group
from andon.gpu.device import Gpu
from andon.gpu.layout import HostStruct
from andon.gpu.passes import FullscreenPass
from andon.gpu.textures import HALF_MOST, Texture, make_texture, uniform_buffer, write_buffer
from andon.quantities import CameraFrame, DisplayImage, Luminance, Photometry

__all__ = ["OST_RECORD", "OstStage"]

OST_RECORD = HostStruct(
    "OstRecord", (("peak", "f32"), ("transmittance", "f32"), ("compensation", "u32"))
)
STRUCTS = {OST_RECORD.name: OST_RECORD}


class OstStage:
    """Reads luminance and the captured light, writes the display's codes or what is seen.

    Attributes
    ----------
    image : (H, W) rgba8unorm, codes for the display (sRGB, value 1 is the peak).
    seen : (H, W) rgba32float, display + τ·real, in the picture's linear units.
    """

    def __init__(
        self,
        gpu: Gpu,
        luminance: Texture,
        frame: CameraFrame,
        exposure: Exposure,
        unlit: NDArray[Any],
    ) -> None:
        """`exposure` has a `see_through`; `unlit` (H, W, 3): as in `ost.shown_share`, linear."""
        settings, luminance_per_unit = exposure.see_through, frame.luminance_per_unit
        assert settings is not None
        self.gpu, self._settings = gpu, settings
        self._wanted, self._frame = luminance, frame
        size = (luminance.width, luminance.height)
        self.image = make_texture(gpu, "rgba8unorm", *size, label="see-through")
        self.seen = make_texture(gpu, "rgba32float", *size, label="seen")
        record = uniform_buffer(gpu, OST_RECORD.dtype.itemsize, "see-through")
        write_buffer(
            gpu,
            record,
            OST_RECORD.pack(
                peak=settings.peak_luminance_cd_m2 / luminance_per_unit,
                transmittance=settings.transmittance,
                compensation=int(settings.compensation),
            ),
        )
        real, plain = (_texture(gpu, light, settings) for light in (frame.linear, unlit))
        resources: dict[int, tuple[str, Any]] = {
            0: ("float", luminance.view),
            1: ("float", real.view),
            2: ("float", plain.view),
            3: ("uniform", record),
        }
        group = [bind_group(gpu, resources, "see-through")]
        shader = "andon/display/ost.wgsl"
        self._show = FullscreenPass(
            gpu, shader, "display_codes", [self.image.format], group, structs=STRUCTS
        )
        self._see = FullscreenPass(
            gpu, shader, "seen_light", [self.seen.format], group, structs=STRUCTS
        )
        self._shown = DisplayStage(gpu, self.seen, frame.response, exposure, luminance_per_unit)

    def encode(self, encoder: Any) -> None:
        """Records the pass that makes the display's codes."""
        self._show.encode(encoder, [self.image.view])

    def read(self) -> DisplayImage:
        """The display's codes, waiting for the device."""
        return DisplayImage(np.ascontiguousarray(self.image.read()[..., :3]))

    def read_seen(self, photometry: Photometry) -> Seen:
        """The simulated view of the picture that is there; draws what no frame needs, and waits."""
        encoder = self.gpu.device.create_command_encoder(label="seen")
        self._see.encode(encoder, [self.seen.view])
        self._shown.encode(encoder)
        self.gpu.device.queue.submit([encoder.finish()])
        per_unit = self._frame.luminance_per_unit
        real = per_unit * real_light(self._frame.linear, self._settings)
        wanted, seen = (
            per_unit * texture.read()[..., :3].astype(np.float64)
            for texture in (self._wanted, self.seen)
        )
        return Seen(
            Luminance(seen.astype(np.float32), photometry),
            self._shown.read(),
            **reach(wanted, real, seen, self._settings, per_unit),
        )


def _texture(gpu: Gpu, linear: NDArray[Any], settings: SeeThrough) -> Texture:
    # Half floats, as the wanted picture is: light that nobody changed then differs by nothing.
    light = np.minimum(real_light(linear, settings), HALF_MOST)
    made = make_texture(gpu, "rgba16float", light.shape[1], light.shape[0], label="real light")
    made.write(np.dstack([light, np.ones(light.shape[:2])]))
    return made
