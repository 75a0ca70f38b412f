"""The composite on the GPU: what frame.wgsl needs of the photograph."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.composite.curve_table import curve_table, thinned
from andon.composite.curves import dimmed_light
from andon.composite.lamp_pictures import LampPictures
from andon.composite.model import Ambient, MeasuredSurface
from andon.composite.per_lux import per_lux
from andon.composite.records import AMBIENT_RECORD, STRUCTS, pack_ambient
from andon.gpu.device import Gpu
from andon.gpu.textures import HALF_MOST, make_texture, uniform_buffer, write_buffer
from andon.quantities import MAX_OBJECT_MATERIALS, CameraFrame
from andon.spaces import View

__all__ = ["STRUCTS", "CompositeStage"]


class CompositeStage:
    """Holds the captured light and the settings of the ambient.

    Attributes
    ----------
    resources : bindings 2 to 5 of group 0 of frame.wgsl, and 7 with curves.
    lamps : draws visible lamps and luminous bodies.
    has_maps : E0 or ρ is a picture, or dimming is the paper's.
    has_curves : surfaces have curves of their own.
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
        self.gpu, self.view, self.ambient = gpu, view, ambient
        self.has_curves = measured is not None and measured.curve_of is not None
        self.has_maps = (
            measured is not None
            or ambient.lux_of(view.name).ndim == 3
            or ambient.dimming_mode == "paper"
        )
        size = (view.width, view.height)
        # Lux exceed half floats in the sun.
        captured = "rgba32float" if self.has_curves else "rgba16float"
        self._captured = make_texture(gpu, captured, *size, label="captured")
        added = size if self.has_maps else (1, 1)
        # 1/E0 of a dark corner and of the sun are five decades apart: too many for half floats.
        self._per_lux = make_texture(gpu, "rgba32float", *added, label="per lux")
        self._ambient = uniform_buffer(gpu, AMBIENT_RECORD.dtype.itemsize, "ambient")
        self.resources: dict[int, tuple[str, Any]] = {
            2: ("uniform", self._ambient),
            3: ("float", self._captured.view),
            4: ("float", self._per_lux.view),
            5: ("uniform", _emitted(gpu, emitted_cd_m2, taking)),
        }
        self._first_cell = 0
        self.measured = measured
        if measured is not None and self.has_curves:
            self.measured = self._with_table(measured)
        self.lamps = LampPictures(gpu, view, gbuffer_view, view_buffer, self._ambient)

    def _with_table(self, measured: MeasuredSurface) -> MeasuredSurface:
        """`measured` with the curves that the shader has."""
        curves = tuple(thinned(curve) for curve in measured.curves)
        table, self._first_cell = curve_table(curves)
        rows, cells = table.shape[:2]
        texture = make_texture(self.gpu, "rgba32float", cells, rows, label="curves")
        texture.write(table)
        self.resources[7] = ("float", texture.view)
        return replace(measured, curves=curves)

    def load(self, frame: CameraFrame) -> None:
        """Takes a captured frame."""
        record = pack_ambient(self.ambient, frame.luminance_per_unit, self._first_cell)
        write_buffer(self.gpu, self._ambient, record)
        light = np.asarray(frame.linear, np.float64)
        if self.has_maps:
            self._per_lux.write(_with_alpha(per_lux(frame, self.ambient, self.measured)))
            light = dimmed_light(frame, self.ambient, self.measured)
        if self.has_curves and self.measured is not None:
            self._captured.write(_with_alpha(light, self.measured.curve_of))
        else:
            # Half floats end here; what is brighter is white on any display.
            self._captured.write(_with_alpha(np.minimum(light, HALF_MOST)))


def _emitted(gpu: Gpu, emitted_cd_m2: NDArray[np.float64], taking: NDArray[np.uint8] | None) -> Any:
    """Binding 5: what materials of objects emit, and what light they take."""
    buffer = uniform_buffer(gpu, 16 * MAX_OBJECT_MATERIALS, "emitted")
    table = np.zeros((MAX_OBJECT_MATERIALS, 4), np.float32)
    table[: len(emitted_cd_m2), :3] = emitted_cd_m2
    if taking is not None:
        table[: len(taking), 3] = taking
    write_buffer(gpu, buffer, table)
    return buffer


def _with_alpha(picture: NDArray[Any], alpha: Any = 1.0) -> NDArray[np.float32]:
    out = np.empty((*picture.shape[:2], 4), np.float32)
    out[..., :3], out[..., 3] = picture, alpha
    return out
