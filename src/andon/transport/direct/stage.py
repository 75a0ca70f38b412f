"""Direct light on the GPU: keeps shadow maps and lamp records current."""

from __future__ import annotations

from collections.abc import Sequence, Set
from typing import Any

from andon.gpu.bindings import BindGroup, bind_group
from andon.gpu.device import Gpu
from andon.gpu.textures import uniform_buffer, write_buffer
from andon.lamps import Lamp
from andon.transport.direct.area_buffers import AreaBuffers
from andon.transport.direct.balls.buffers import BallBuffers
from andon.transport.direct.balls.model import GlassBall
from andon.transport.direct.casters import Casters
from andon.transport.direct.luminaire_tables import LuminaireTables
from andon.transport.direct.records import (
    DIRECT_RECORD,
    LAMP_RECORD,
    MAX_LAMPS,
    STRUCTS,
    pack_lamps,
)
from andon.transport.direct.shadows.caster_buffers import CasterBuffers
from andon.transport.direct.shadows.maps import NEAR_M, ShadowMaps
from andon.transport.direct.shadows.soft_maps import SoftMaps
from andon.transport.direct.sum import lamp_terms, softenings, sum_of_lamps

__all__ = ["FILTER", "SOFT_FILTER", "STRUCTS", "SUM", "DirectStage"]


FILTER = "andon/transport/direct/shadows/filter_{}.wgsl"
SOFT_FILTER = "andon/transport/direct/shadows/soft_{}.wgsl"
SUM = "andon/transport/direct/sum.wgsl"


class DirectStage:
    """Reads the lamps of a moment, writes what `illuminance` in direct.wgsl needs.

    On the GPU, illuminance is a *function* until somebody asks for a picture of it: writing it
    and reading it back would cost a quarter of a frame.

    Attributes
    ----------
    group : bind group 1 of any shader that imports direct.wgsl.
    variants : of such a shader, for the lamps of this scene.
    terms : lamp name → WGSL of its shadowed lux at `position` and `normal`; no area lamps.
    softening : name of an area lamp → what `softened` in soft.wgsl wants of it.
    """

    def __init__(
        self,
        gpu: Gpu,
        casters: Casters,
        lamps: Sequence[Lamp],
        bodies: Sequence[str] = (),
        *,
        bias_real_m: float,
        bias_object_m: float,
        captured: Set[str] = frozenset(),
        silent: Set[str] = frozenset(),
        balls: Sequence[GlassBall] = (),
        shells: Set[str] = frozenset(),
    ) -> None:
        self.gpu = gpu
        self.bias = {"bias_real_m": bias_real_m, "bias_object_m": bias_object_m}
        self.casters = CasterBuffers(gpu, casters)
        self.maps = ShadowMaps(gpu, self.casters, lamps)
        self.soft = SoftMaps(gpu, self.casters, lamps)
        self.areas = AreaBuffers(gpu, lamps)
        luminaires = LuminaireTables(gpu, lamps)
        self.balls = tuple(balls)
        self.glass = BallBuffers(gpu, lamps, self.balls, luminaires.tables)
        code = sum_of_lamps(
            lamps,
            bodies,
            layers=self.maps.layers,
            samples=self.soft.firsts,
            edges=self.areas.edges,
            tables=luminaires.tables,
            map_size=self.maps.size,
            soft_map_size=self.soft.size,
            triangles=len(self.casters.triangles),
            captured=captured,
            silent=silent,
            shells=shells,
        )
        self.terms = lamp_terms(lamps, self.maps.layers, luminaires.tables)
        self.softening = softenings(lamps, self.soft.firsts)
        self.variants = {
            SUM: code,
            FILTER.format("none"): FILTER.format(self.maps.filter),
            SOFT_FILTER.format("linear"): SOFT_FILTER.format(self.soft.filter),
            **self.glass.variants,
        }
        self._lamps = uniform_buffer(gpu, LAMP_RECORD.dtype.itemsize * MAX_LAMPS, "lamps")
        self._settings = uniform_buffer(gpu, DIRECT_RECORD.dtype.itemsize, "direct")
        self.group = self._group(luminaires)

    def _group(self, luminaires: LuminaireTables) -> BindGroup:
        gpu = self.gpu
        return bind_group(
            gpu,
            {
                0: ("uniform", self._lamps),
                1: ("uniform", self._settings),
                2: ("float array", self.maps.paraboloids.view),
                3: ("depth array", self.maps.planes.view),
                4: ("storage", self.maps.occluders),
                5: ("float array", self.soft.paraboloids.view),
                6: ("storage", self.areas.samples_buffer),
                7: ("storage", self.areas.edges_buffer),
                8: ("storage", luminaires.buffer),
                9: ("sampler", gpu.device.create_sampler()),
                **self.glass.resources,
            },
            "direct",
        )

    def encode(
        self,
        encoder: Any,
        lamps: Sequence[Lamp],
        casters: Casters,
        balls: Sequence[GlassBall] | None = None,
    ) -> int:
        """Brings maps and records to `lamps` (same names as at the start); returns maps redrawn.

        `balls` are as many as at the start; None: they have not moved.
        """
        self.balls = self.balls if balls is None else tuple(balls)
        self.casters.move(casters)
        self.glass.update(lamps, self.balls)
        redrawn = self.soft.update(lamps) + self.maps.update(encoder, lamps)
        self.areas.update(lamps)
        if lamps:
            write_buffer(self.gpu, self._lamps, pack_lamps(lamps, self.maps.frames))
        settings = DIRECT_RECORD.pack(**self.bias, near_m=NEAR_M)
        write_buffer(self.gpu, self._settings, settings)
        return redrawn
