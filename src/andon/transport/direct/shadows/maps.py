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
from andon.quantities import Geometry
from andon.transport.direct.records import STRUCTS, WIDE_SPOT_RADIANS, PlanarFrame, is_exact
from andon.transport.direct.shadows.face_maps import FaceMaps

__all__ = ["NEAR_M", "ShadowMaps"]

# From the coarsest to the finest.
FILTERS = ("none", "linear", "exact")
FOLDER = "andon/transport/direct/shadows"
# Nothing nearer than this to a lamp casts a shadow (the bulb itself, its socket): metres.
NEAR_M = 0.01
# A depth map without casters would have an empty bounding sphere.
EMPTY_RADIUS_M = 1.0


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

    def __init__(self, gpu: Gpu, casters: Geometry, lamps: Sequence[Lamp]) -> None:
        self.gpu = gpu
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
        self._drawn: dict[str, bytes] = {}
        side = self.size if round_lamps else 2
        self.paraboloids = make_texture(
            gpu, "r32float", side, side, layers=max(2, 2 * len(round_lamps)), label="paraboloids"
        )
        side = self.size if flat_lamps else 2
        self.planes = make_texture(
            gpu, "depth32float", side, side, layers=max(1, len(flat_lamps)), label="planes"
        )
        self._load(casters)
        self._faces: FaceMaps | None = None
        if round_lamps:
            layers = range(self.paraboloids.layers or 0)
            views = [self.paraboloids.layer_view(layer) for layer in layers]
            self._faces = FaceMaps(
                gpu,
                self.positions,
                self.triangles,
                views,
                self.size,
                NEAR_M,
                exact=self.filter == "exact",
            )
        self.occluders = self._faces.occluders if self._faces else self.vertices
        self._planar = _Planar(self, len(flat_lamps)) if flat_lamps else None

    def _load(self, casters: Geometry) -> None:
        import wgpu

        self.positions = np.ascontiguousarray(casters.positions, np.float32)
        self.triangles = np.ascontiguousarray(casters.triangles, np.int32)
        centre = np.zeros(3)
        self.radius_m = EMPTY_RADIUS_M
        if len(self.positions):
            centre = 0.5 * (casters.positions.min(axis=0) + casters.positions.max(axis=0))
            self.radius_m = float(np.linalg.norm(casters.positions - centre, axis=1).max()) + 1e-3
        self.centre = centre
        device, usage = self.gpu.device, wgpu.BufferUsage
        vertices = self.positions if len(self.positions) else np.zeros((1, 3), np.float32)
        indices = self.triangles if len(self.triangles) else np.zeros((1, 3), np.int32)
        self.vertices = device.create_buffer_with_data(
            data=vertices, usage=usage.VERTEX | usage.STORAGE
        )
        self.indices = device.create_buffer_with_data(data=indices, usage=usage.INDEX)

    def update(self, encoder: Any, lamps: Sequence[Lamp]) -> int:
        """Records the maps of lamps that moved since they were drawn; returns how many."""
        moved = 0
        for lamp in lamps:
            if lamp.name not in self.layers:
                continue
            if not is_paraboloid(lamp):
                self.frames[lamp.name] = self._frame(lamp)
            pose = _pose(lamp)
            if self._drawn.get(lamp.name) == pose:
                continue
            self._draw(encoder, lamp)
            self._drawn[lamp.name] = pose
            moved += 1
        return moved

    def _draw(self, encoder: Any, lamp: Lamp) -> None:
        layer = self.layers[lamp.name]
        if is_paraboloid(lamp):
            assert self._faces is not None
            assert isinstance(lamp, PointLamp)
            self._faces.encode(encoder, lamp.position_m, layer)
        else:
            assert self._planar is not None
            self._planar.encode(encoder, self.frames[lamp.name], layer)

    def _frame(self, lamp: Lamp) -> PlanarFrame:
        if isinstance(lamp, SpotLamp):
            right, down = perpendicular(lamp.direction)
            # One texel wider, so that the cone's rim has its neighbours in the map.
            tangent = float(np.tan(lamp.outer_radians)) * (1 + 2 / self.size)
            return PlanarFrame(lamp.position_m, right, down, lamp.direction, tangent)
        assert isinstance(lamp, DirectionalLamp)
        right, down = perpendicular(lamp.direction)
        margin = 1.05
        return PlanarFrame(
            self.centre, right, down, lamp.direction, self.radius_m, 2 * margin * self.radius_m
        )


def _pose(lamp: Lamp) -> bytes:
    parts = [getattr(lamp, key, None) for key in ("position_m", "direction", "outer_radians")]
    return b"".join(np.asarray(part, np.float64).tobytes() for part in parts if part is not None)


def perpendicular(axis: NDArray[np.float64], /) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Two unit vectors that form a right-handed frame (right, down, axis) with `axis` (3,)."""
    helper = np.eye(3)[int(np.argmin(np.abs(axis)))]
    right = np.cross(helper, axis)
    right /= np.linalg.norm(right)
    return right, np.cross(axis, right)


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

    def encode(self, encoder: Any, frame: PlanarFrame, layer: int) -> None:
        matrix = clip_from_world(frame).T.astype(np.float32)
        write_buffer(self.maps.gpu, self.buffers[layer], matrix)
        render = encoder.begin_render_pass(
            label="shadow plane",
            color_attachments=[],
            depth_stencil_attachment=_depth_attachment(self.views[layer]),
        )
        render.set_pipeline(self.pipeline)
        render.set_bind_group(0, self.groups[layer].group)
        render.set_vertex_buffer(0, self.maps.vertices)
        render.set_index_buffer(self.maps.indices, "uint32")
        if self.maps.triangles.size:
            render.draw_indexed(self.maps.triangles.size)
        render.end()


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
