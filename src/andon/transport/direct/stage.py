"""Direct light on the GPU: keeps shadow maps and lamp records current."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from andon.gpu.bindings import bind_group
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


FILTER = "andon/transport/direct/shadows/filter_{}.wgsl"
SUM = "andon/transport/direct/sum.wgsl"
GROUPS = ("point", "wide_spot", "spot", "directional", "hemisphere")


def sum_of_lamps(
    groups: Sequence[Sequence[Lamp]], layers: Mapping[str, int], size: int, triangles: int, /
) -> str:
    """WGSL of `illuminance` for just these lamps: no loops, no branches, constants as constants.

    `layers` are those of the shadow maps by lamp name, `size` their texels along a side,
    `triangles` how many cast shadows.
    """
    lines = [f"const MAP_SIZE: f32 = {float(size)};", f"const TRIANGLES: i32 = {triangles};"]
    lines.append("fn illuminance(position: vec3f, normal: vec3f, bias: f32) -> vec3f {")
    lines.append("  var total = vec3f(0.0);")
    lamp = 0
    for name, group in zip(GROUPS, groups, strict=True):
        place = "normal" if name == "hemisphere" else "position, normal, bias"
        for member in group:
            layer = "" if name == "hemisphere" else f"{layers.get(member.name, -1)}, "
            lines.append(f"  total += {name}_illuminance({lamp}, {layer}{place});")
            lamp += 1
    return "\n".join([*lines, "  return total;", "}"])


class DirectStage:
    """Reads the lamps of a moment, writes what `illuminance` in direct.wgsl needs.

    On the GPU, illuminance is a *function* until somebody asks for a picture of it: writing it
    and reading it back would cost a quarter of a frame.

    Attributes
    ----------
    group : bind group 1 of any shader that imports direct.wgsl.
    variants : of such a shader, for the lamps of this scene.
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
        groups = sorted_lamps(lamps)
        self.variants = {
            SUM: sum_of_lamps(groups, self.maps.layers, self.maps.size, len(self.maps.triangles)),
            FILTER.format("none"): FILTER.format(self.maps.filter),
        }
        self._lamps = uniform_buffer(gpu, LAMP_RECORD.dtype.itemsize * MAX_LAMPS, "lamps")
        self._settings = uniform_buffer(gpu, DIRECT_RECORD.dtype.itemsize, "direct")
        self.group = bind_group(
            gpu,
            {
                0: ("uniform", self._lamps),
                1: ("uniform", self._settings),
                2: ("float array", self.maps.paraboloids.view),
                3: ("depth array", self.maps.planes.view),
                4: ("storage", self.maps.occluders),
            },
            "direct",
        )

    def encode(self, encoder: Any, lamps: Sequence[Lamp]) -> int:
        """Brings maps and records to `lamps` (same names as at the start); returns maps redrawn."""
        moved = self.maps.update(encoder, lamps)
        groups = sorted_lamps(lamps)
        records = pack_lamps(groups, self.maps.layers, self.maps.frames)
        if len(records):
            write_buffer(self.gpu, self._lamps, records)
        counts = {
            f"{name}s": np.uint32(len(group)) for name, group in zip(GROUPS, groups, strict=True)
        }
        settings = DIRECT_RECORD.pack(**counts, **self.bias, near_m=NEAR_M)
        write_buffer(self.gpu, self._settings, settings)
        return moved
