"""Shadow maps of all lamps of a frame; a lamp that has not moved keeps its map."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.gpu.bindings import bind_group
from andon.gpu.device import Gpu
from andon.gpu.passes import pipeline_layout, shader_module
from andon.gpu.textures import make_texture, uniform_buffer, write_buffer
from andon.lamps import DirectionalLamp, Lamp, PointLamp, Shadow, SpotLamp
from andon.spaces import perpendicular
from andon.transport.direct.records import STRUCTS, WIDE_SPOT_RADIANS, PlanarFrame, is_exact
from andon.transport.direct.shadows.caster_buffers import CasterBuffers
from andon.transport.direct.shadows.face_maps import FaceMaps

__all__ = ["NEAR_M", "ShadowMaps"]

# From the coarsest to the finest.
FILTERS = ("none", "linear", "exact")
FOLDER = "andon/transport/direct/shadows"
# The near plane of planar maps, metres.
NEAR_M = 0.01


def shadow_of(lamp: Lamp, /) -> Shadow | None:
    """How the lamp's shadow is wanted; None for lamps that cast none."""
    return lamp.shadow if isinstance(lamp, PointLamp | DirectionalLamp) else None


def is_paraboloid(lamp: Lamp, /) -> bool:
    """The lamp looks into all directions (or nearly), or wants exact shadows."""
    if isinstance(lamp, SpotLamp):
        return lamp.outer_radians > WIDE_SPOT_RADIANS or is_exact(lamp)
    return isinstance(lamp, PointLamp)


class ShadowMaps:
    """Depth maps around lamps: paraboloid pairs and planes, in two texture arrays.

    All maps of a frame have one size and one filter: the finest that a lamp asks for.

    Attributes
    ----------
    paraboloids : r32float array, two layers a lamp, radial distance in metres.
    planes : depth32float array, one layer a lamp: near/depth for spots, linear for directional.
    layers : lamp name → first layer.
    frames : lamp name → `PlanarFrame`, for lamps with a plane.
    """

    def __init__(self, gpu: Gpu, buffers: CasterBuffers, lamps: Sequence[Lamp]) -> None:
        self.gpu, self.buffers = gpu, buffers
        shadowed = [lamp for lamp in lamps if shadow_of(lamp) is not None]
        wishes = [wish for lamp in lamps if (wish := shadow_of(lamp)) is not None]
        self.size = max((wish.map_size for wish in wishes), default=2)
        self.size += self.size % 2
        finest = max((FILTERS.index(wish.filter) for wish in wishes), default=0)
        self.filter = FILTERS[finest]
        round_lamps = [lamp.name for lamp in shadowed if is_paraboloid(lamp)]
        flat_lamps = [lamp.name for lamp in shadowed if not is_paraboloid(lamp)]
        self.layers = {name: 2 * i for i, name in enumerate(round_lamps)}
        self.layers |= {name: i for i, name in enumerate(flat_lamps)}
        self.frames: dict[str, PlanarFrame] = {}
        self._drawn: dict[str, tuple[Any, ...]] = {}
        side = self.size if round_lamps else 2
        self.paraboloids = make_texture(
            gpu, "r32float", side, side, layers=max(2, 2 * len(round_lamps)), label="paraboloids"
        )
        side = self.size if flat_lamps else 2
        self.planes = make_texture(
            gpu, "depth32float", side, side, layers=max(1, len(flat_lamps)), label="planes"
        )
        self._faces: FaceMaps | None = None
        if round_lamps:
            layers = range(self.paraboloids.layers or 0)
            views = [self.paraboloids.layer_view(layer) for layer in layers]
            exact = self.filter == "exact"
            self._faces = FaceMaps(gpu, buffers, views, self.size, exact=exact)
        self.occluders = self._faces.occluders if self._faces else buffers.vertices
        self._planar = _Planar(self, len(flat_lamps)) if flat_lamps else None

    def update(self, encoder: Any, lamps: Sequence[Lamp]) -> int:
        """Records the maps that are not true any more: the lamp moved, or a body that hides it.

        Returns how many.
        """
        moved = 0
        for lamp in lamps:
            if lamp.name not in self.layers:
                continue
            if not is_paraboloid(lamp):
                self.frames[lamp.name] = self._frame(lamp)
            state = (_pose(lamp), self.buffers.casters.version(_through(lamp)))
            if self._drawn.get(lamp.name) == state:
                continue
            self._draw(encoder, lamp)
            self._drawn[lamp.name] = state
            moved += 1
        return moved

    def _draw(self, encoder: Any, lamp: Lamp) -> None:
        layer = self.layers[lamp.name]
        if is_paraboloid(lamp):
            assert self._faces is not None
            assert isinstance(lamp, PointLamp)
            hiding = self.buffers.casters.hiding(_through(lamp))
            near_m = NEAR_M if lamp.shadow is None else lamp.shadow.near_m
            self._faces.encode(encoder, lamp.position_m, layer, hiding, near_m)
        else:
            assert self._planar is not None
            hiding = self.buffers.casters.hiding(_through(lamp))
            self._planar.encode(encoder, self.frames[lamp.name], layer, hiding)

    def _frame(self, lamp: Lamp) -> PlanarFrame:
        if isinstance(lamp, SpotLamp):
            right, down = perpendicular(lamp.direction)
            # One texel wider, so that the cone's rim has its neighbours in the map.
            tangent = float(np.tan(lamp.outer_radians)) * (1 + 2 / self.size)
            return PlanarFrame(lamp.position_m, right, down, lamp.direction, tangent)
        assert isinstance(lamp, DirectionalLamp)
        right, down = perpendicular(lamp.direction)
        margin = 1.05
        centre, radius = self.buffers.bounds
        return PlanarFrame(centre, right, down, lamp.direction, radius, 2 * margin * radius)


def _through(lamp: Lamp) -> frozenset[str]:
    shadow = shadow_of(lamp)
    return frozenset() if shadow is None else shadow.through


def _pose(lamp: Lamp) -> bytes:
    parts = [getattr(lamp, key, None) for key in ("position_m", "direction", "outer_radians")]
    return b"".join(np.asarray(part, np.float64).tobytes() for part in parts if part is not None)


def _vertex_state(module: Any, entry: str) -> dict[str, Any]:
    attributes = [{"format": "float32x3", "offset": 0, "shader_location": 0}]
    return {
        "module": module,
        "entry_point": entry,
        "buffers": [{"array_stride": 12, "step_mode": "vertex", "attributes": attributes}],
    }


def _depth_state() -> dict[str, Any]:
    return {"format": "depth32float", "depth_write_enabled": True, "depth_compare": "greater"}


def _depth_attachment(view: Any) -> dict[str, Any]:
    return {
        "view": view,
        "depth_load_op": "clear",
        "depth_store_op": "store",
        "depth_clear_value": 0.0,
    }


class _Planar:
    """One plane map a lamp."""

    def __init__(self, maps: ShadowMaps, count: int) -> None:
        gpu = maps.gpu
        self.maps = maps
        self.buffers = [uniform_buffer(gpu, 64, "clip_from_world") for _ in range(count)]
        self.groups = [bind_group(gpu, {0: ("uniform", buffer)}) for buffer in self.buffers]
        module = shader_module(gpu, f"{FOLDER}/planar.wgsl", STRUCTS)
        self.pipeline = gpu.device.create_render_pipeline(
            label="shadow plane",
            layout=pipeline_layout(gpu, [self.groups[0]]),
            vertex=_vertex_state(module, "planar_corner"),
            primitive={"topology": "triangle-list", "cull_mode": "none"},
            depth_stencil=_depth_state(),
        )
        self.views = [maps.planes.layer_view(layer) for layer in range(count)]

    def encode(
        self, encoder: Any, frame: PlanarFrame, layer: int, hiding: NDArray[np.bool_] | None
    ) -> None:
        matrix = clip_from_world(frame).T.astype(np.float32)
        write_buffer(self.maps.gpu, self.buffers[layer], matrix)
        render = encoder.begin_render_pass(
            label="shadow plane",
            color_attachments=[],
            depth_stencil_attachment=_depth_attachment(self.views[layer]),
        )
        render.set_pipeline(self.pipeline)
        render.set_bind_group(0, self.groups[layer].group)
        render.set_vertex_buffer(0, self.maps.buffers.vertices)
        render.set_index_buffer(self.maps.buffers.indices, "uint32")
        for first, end in _runs(hiding, len(self.maps.buffers.triangles)):
            render.draw_indexed(3 * (end - first), 1, 3 * first)
        render.end()


def _runs(hiding: NDArray[np.bool_] | None, count: int) -> list[tuple[int, int]]:
    """(first, end) of the runs of triangles that are drawn; groups of casters are runs."""
    drawn = np.ones(count, bool) if hiding is None else hiding
    steps = np.flatnonzero(np.diff(np.pad(drawn.astype(np.int8), 1)))
    return [(int(first), int(end)) for first, end in steps.reshape(-1, 2)]


def clip_from_world(frame: PlanarFrame, /) -> NDArray[np.float64]:
    """(4, 4) projection of a planar map; depth near/z for cones, ½ − z/range for parallel light."""
    rows = np.zeros((4, 4))
    rows[0, :3] = frame.right / frame.half_width
    rows[1, :3] = -frame.down / frame.half_width
    if frame.depth_range_m:
        rows[2, :3] = -frame.axis / frame.depth_range_m
        rows[3, 3] = 1
    else:
        rows[3, :3] = frame.axis
    rows[:, 3] -= rows[:, :3] @ frame.centre
    rows[2, 3] += 0.5 if frame.depth_range_m else NEAR_M
    return rows
