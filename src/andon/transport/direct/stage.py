"""Direct light on the GPU: keeps shadow maps and lamp records current."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from andon.gpu.device import Gpu
from andon.gpu.textures import uniform_buffer, write_buffer
from andon.lamps import Lamp
from andon.quantities import Geometry
from andon.transport.direct.records import (
    DIRECT_RECORD,
    LAMP_RECORD,
    MAX_LAMPS,
    STRUCTS,
    pack_lamps,
    sorted_lamps,
)
from andon.transport.direct.shadows.maps import NEAR_M, ShadowMaps

__all__ = ["STRUCTS", "DirectStage"]


class DirectStage:
    """Reads the lamps of a moment, writes what `illuminance` in direct.wgsl needs.

    On the GPU, illuminance is a *function* until somebody asks for a picture of it: writing it
    and reading it back would cost a quarter of a frame.

    Attributes
    ----------
    resources : bindings of group 1 of any shader that imports direct.wgsl.
    """

    def __init__(
        self,
        gpu: Gpu,
        casters: Geometry,
        lamps: Sequence[Lamp],
        *,
        bias_real_m: float,
        bias_object_m: float,
    ) -> None:
        self.gpu = gpu
        self.bias = {"bias_real_m": bias_real_m, "bias_object_m": bias_object_m}
        self.maps = ShadowMaps(gpu, casters, lamps)
        self._lamps = uniform_buffer(gpu, LAMP_RECORD.dtype.itemsize * MAX_LAMPS, "lamps")
        self._settings = uniform_buffer(gpu, DIRECT_RECORD.dtype.itemsize, "direct")
        self.resources: dict[int, Any] = {
            0: self._lamps,
            1: self._settings,
            2: self.maps.paraboloids.view,
            3: self.maps.planes.view,
        }

    def encode(self, encoder: Any, lamps: Sequence[Lamp]) -> int:
        """Brings maps and records to `lamps` (same names as at the start); returns maps redrawn."""
        moved = self.maps.update(encoder, lamps)
        groups = sorted_lamps(lamps)
        sizes = dict.fromkeys(self.maps.layers, self.maps.size)
        records = pack_lamps(groups, self.maps.layers, self.maps.frames, sizes)
        if len(records):
            write_buffer(self.gpu, self._lamps, records)
        names = ("points", "wide_spots", "spots", "directionals", "hemispheres")
        counts = {name: np.uint32(len(group)) for name, group in zip(names, groups, strict=True)}
        settings = DIRECT_RECORD.pack(**counts, **self.bias, near_m=NEAR_M)
        write_buffer(self.gpu, self._settings, settings)
        return moved
