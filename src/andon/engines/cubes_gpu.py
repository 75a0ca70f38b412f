"""Cube maps by rasterising: six faces, one after the other, through one set of pipelines.

What a face needs of its own is a hundred bytes of its view; geometry, shadow maps, shaders and
pictures are made once. The illuminance is read back beside the G-buffer and put together on the
host: a photograph's reflectance may exceed 1, where the G-buffer's 8 bits end.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon import gbuffer
from andon.composite.records import STRUCTS as AMBIENT_STRUCTS
from andon.engines.cubes import CubeSetting, cube_views, mirrored
from andon.gpu.bindings import bind_group
from andon.gpu.device import open_gpu
from andon.gpu.passes import FullscreenPass
from andon.gpu.textures import make_texture, write_buffer
from andon.harmonics import cube_directions
from andon.quantities import Geometry
from andon.surface.stage import SurfaceStage
from andon.transport.direct import stage as direct
from andon.transport.probes.capture import Seen

__all__ = ["GpuCubes"]

Float = NDArray[np.float64]

FRAME = "andon/frame.wgsl"
STRUCTS = gbuffer.STRUCTS | direct.STRUCTS | AMBIENT_STRUCTS


class GpuCubes:
    """Looks around from places, on the device.

    Raises `MachineError` where there is no adapter.
    """

    name = "gpu"

    def __init__(self, setting: CubeSetting, size: int) -> None:
        self.setting, self.size = setting, size
        self.gpu = gpu = open_gpu()
        self.adapter = gpu.adapter_name
        moment, bias = setting.moment, setting.prepared.surface.bias
        self._casters = setting.prepared.casters(moment)
        self._direct = direct.DirectStage(
            gpu,
            self._casters,
            setting.lamps,
            [body.name for body in moment.bodies],
            bias_real_m=bias.real_m,
            bias_object_m=bias.object_m,
        )
        view = cube_views(np.zeros(3), size)[0]
        self._stage = SurfaceStage(gpu, setting.surface, view)
        seen = self._stage.surface
        self._lux_map = make_texture(gpu, "rgba32float", size, size, label="probe lux")
        own = {0: ("uint", seen.texture.view), 1: ("uniform", seen.view_buffer)}
        self._lux = FullscreenPass(
            gpu,
            FRAME,
            "illuminance_map",
            [self._lux_map.format],
            [bind_group(gpu, own, "probe"), self._direct.group],
            structs=STRUCTS,
            variants=gbuffer.projection_variant(view) | self._direct.variants,
        )
        self._materials = tuple(
            _Materials.of(part) for part in (setting.surface.real, setting.surface.objects)
        )
        self._directions = cube_directions(size)
        # Depth is planar: along a ray it is longer by this.
        self._stretch = 1 / np.abs(self._directions).max(axis=-1)
        self._has_maps = False

    def look(self, position: Float, /, *, lit: bool = True) -> tuple[Seen, Float | None]:
        """See `CubeEngine`."""
        packed: list[NDArray[Any]] = []
        lux: list[NDArray[Any]] = []
        seen = self._stage.surface
        for view in cube_views(position, self.size):
            write_buffer(self.gpu, seen.view_buffer, gbuffer.pack_view(view))
            encoder = self.gpu.device.create_command_encoder(label="probe")
            self._stage.encode(encoder)
            if lit:
                self._draw_maps(encoder)
                self._lux.encode(encoder, [self._lux_map.view])
            self.gpu.device.queue.submit([encoder.finish()])
            packed.append(seen.texture.read())
            if lit:
                lux.append(self._lux_map.read()[..., :3])
        light = mirrored(np.stack(lux)).astype(np.float64) if lit else None
        return self._seen(position, mirrored(np.stack(packed))), light

    def _draw_maps(self, encoder: Any) -> None:
        """Shadow maps of what stands still are drawn once."""
        if not self._has_maps:
            self._direct.encode(encoder, self.setting.lamps, self._casters)
            self._has_maps = True

    def _seen(self, position: Float, packed: NDArray[np.uint32]) -> Seen:
        fields = gbuffer.unpack_surface(packed, self._stage.view)
        valid = fields["valid"]
        distance = np.where(valid, fields["depth"] * self._stretch, np.inf)
        with np.errstate(invalid="ignore"):
            points = position + self._directions * distance[..., None]
        is_object = valid & fields["is_object"]
        reflectance = np.where(valid[..., None], fields["reflectance"], 0.0)
        emitted = np.zeros_like(reflectance)
        for table, own in zip(self._materials, (valid & ~is_object, is_object), strict=True):
            number = fields["material_id"][own]
            emitted[own] = table.emitted_cd_m2[number]
            packed_rho, plain = reflectance[own], table.is_plain[number]
            packed_rho[plain] = table.reflectance[number[plain]]
            reflectance[own] = packed_rho
        return Seen(
            np.where(valid[..., None], points, np.nan),
            np.where(valid[..., None], fields["normal"], np.nan),
            distance,
            is_object,
            reflectance,
            emitted,
        )


@dataclass(frozen=True, eq=False)
class _Materials:
    """By number: what is emitted, ρ, and which ρ no texture changes.

    Where none does, the material's own is as good as on the reference; the G-buffer's has 8 bits.
    """

    emitted_cd_m2: Float
    reflectance: Float
    is_plain: NDArray[np.bool_]

    @staticmethod
    def of(part: Geometry) -> _Materials:
        rows = part.materials
        return _Materials(
            np.array([m.emissive_cd_m2 for m in rows], float),
            np.clip(np.array([m.reflectance for m in rows], float), 0, 1),
            np.array([m.texture is None or part.uvs is None for m in rows]),
        )
