"""The composite on the GPU: what frame.wgsl needs of the photograph."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.composite.lamp_pictures import LampPictures
from andon.composite.model import Ambient, MeasuredSurface
from andon.composite.per_lux import per_lux
from andon.composite.records import AMBIENT_RECORD, STRUCTS, pack_ambient
from andon.gpu.device import Gpu
from andon.gpu.textures import make_texture, uniform_buffer, write_buffer
from andon.quantities import MAX_OBJECT_MATERIALS, CameraFrame
from andon.spaces import View

__all__ = ["STRUCTS", "CompositeStage"]


class CompositeStage:
    """Holds the captured light and the settings of the ambient.

    Attributes
    ----------
    resources : bindings 2 to 5 of group 0 of frame.wgsl.
    lamps : draws visible lamps and luminous bodies.
    has_maps : E0 or ρ is a picture, or dimming is the paper's.
    """

    def __init__(
        self,
        gpu: Gpu,
        view: View,
        ambient: Ambient,
        gbuffer_view: Any,
        view_buffer: Any,
        emitted_cd_m2: NDArray[np.float64],
        taking: NDArray[np.uint8] | None = None,
        measured: MeasuredSurface | None = None,
    ) -> None:
        self.gpu, self.view, self.ambient, self.measured = gpu, view, ambient, measured
        has_reflectance = measured is not None and measured.reflectance is not None
        self.has_maps = (
            ambient.lux_of(view.name).ndim == 3 or ambient.dimming_mode == "paper" or has_reflectance
        )
        size = (view.width, view.height)
        self._captured = make_texture(gpu, "rgba16float", *size, label="captured")
        added = size if self.has_maps else (1, 1)
        # 1/E0 of a dark corner and of the sun are five decades apart: too many for half floats.
        self._per_lux = make_texture(gpu, "rgba32float", *added, label="per lux")
        self._ambient = uniform_buffer(gpu, AMBIENT_RECORD.dtype.itemsize, "ambient")
        self._emitted = uniform_buffer(gpu, 16 * MAX_OBJECT_MATERIALS, "emitted")
        table = np.zeros((MAX_OBJECT_MATERIALS, 4), np.float32)
        table[: len(emitted_cd_m2), :3] = emitted_cd_m2
        if taking is not None:
            table[: len(taking), 3] = taking
        write_buffer(gpu, self._emitted, table)
        self.resources: dict[int, tuple[str, Any]] = {
            2: ("uniform", self._ambient),
            3: ("float", self._captured.view),
            4: ("float", self._per_lux.view),
            5: ("uniform", self._emitted),
        }
        self.lamps = LampPictures(gpu, view, gbuffer_view, view_buffer, self._ambient)

    def load(self, frame: CameraFrame) -> None:
        """Takes a captured frame."""
        write_buffer(self.gpu, self._ambient, pack_ambient(self.ambient, frame.luminance_per_unit))
        linear = np.asarray(frame.linear, np.float64)
        if self.has_maps:
            dimming = np.asarray(self.ambient.dimming)
            self._per_lux.write(_with_alpha(per_lux(frame, self.ambient, self.measured)))
            if self.ambient.dimming_mode == "linear":
                linear = linear * dimming
            else:
                linear = frame.response.decode(dimming * frame.response.encode(linear))
        # Half floats end here; what is brighter is white on any display.
        self._captured.write(_with_alpha(np.minimum(linear, 65504.0)))


def _with_alpha(picture: NDArray[Any]) -> NDArray[np.float32]:
    out = np.ones((*picture.shape[:2], 4), np.float32)
    out[..., :3] = picture
    return out
