"""Six plane faces around a lamp, resampled into two paraboloids."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.gpu.bindings import BindGroup, bind_group
from andon.gpu.device import Gpu
from andon.gpu.passes import FullscreenPass, color_attachment, pipeline_layout, shader_module
from andon.gpu.textures import make_texture, uniform_buffer, write_buffer
from andon.transport.direct.records import FACE_RECORD, STRUCTS
from andon.transport.direct.shadows.culling import face_triangles

__all__ = ["FaceMaps", "TrianglePlanes"]

FOLDER = "andon/transport/direct/shadows"
DISTANCE, TRIANGLE = f"{FOLDER}/resample_distance.wgsl", f"{FOLDER}/resample_triangle.wgsl"


@dataclass(frozen=True)
class _Slot:
    """Buffers and bind groups of one lamp."""

    lamp: Any
    corners: Any
    planes: Any
    drawing: BindGroup
    resampling: BindGroup


class FaceMaps:
    """Draws which plane a lamp sees in each direction, then how far it is.

    Parameters
    ----------
    positions, triangles : (n, 3) float32 metres and (m, 3) int32, what casts shadows.
    discs : views of the layers to fill, two for each lamp.
    map_size : texels along a side of a disc.
    exact : discs hold which triangle is seen, and `occluders` describes it.

    Attributes
    ----------
    occluders : (lamps · m · 4,) vec4f storage buffer, see filter_exact.wgsl; one row without
        `exact`.
    near_m : nothing nearer to the lamp casts a shadow.
    """

    def __init__(
        self,
        gpu: Gpu,
        positions: NDArray[np.float32],
        triangles: NDArray[np.int32],
        discs: Sequence[Any],
        map_size: int,
        near_m: float,
        *,
        exact: bool = False,
    ) -> None:
        self.gpu, self.discs, self.near_m, self.exact = gpu, discs, near_m, exact
        self.positions, self.triangles = positions, triangles
        self._planes = TrianglePlanes(positions, triangles)
        self.face = map_size // 2
        size = (3 * self.face, 2 * self.face)
        self.depth = make_texture(gpu, "depth32float", *size, label="faces: depth")
        self.seen = make_texture(gpu, "rgba32float", *size, label="faces: planes")
        self._vertices = self._storage(max(12, positions.nbytes))
        if len(positions):
            write_buffer(gpu, self._vertices, positions)
        self._slots = [self._slot() for _ in range(len(discs) // 2)]
        self._drawing = self._pipeline(self._slots[0].drawing)
        self._resampling = FullscreenPass(
            gpu,
            f"{FOLDER}/resample.wgsl",
            "both_discs",
            ["r32float", "r32float"],
            [self._slots[0].resampling],
            structs=STRUCTS,
            variants={DISTANCE: TRIANGLE} if exact else {},
        )
        rows = 4 * len(triangles) * len(self._slots) if exact else 1
        self.occluders = self._storage(16 * max(1, rows))

    def _storage(self, size_bytes: int) -> Any:
        import wgpu

        usage = wgpu.BufferUsage.STORAGE | wgpu.BufferUsage.COPY_DST
        return self.gpu.device.create_buffer(size=size_bytes, usage=usage)

    def _slot(self) -> _Slot:
        # Worst case: every face sees every triangle.
        most = max(1, 6 * len(self.triangles))
        lamp = uniform_buffer(self.gpu, FACE_RECORD.dtype.itemsize, "shadow lamp")
        corners, planes = self._storage(12 * most), self._storage(16 * most)
        drawing = {
            0: ("uniform", lamp),
            1: ("storage", self._vertices),
            2: ("storage", corners),
            3: ("storage", planes),
        }
        resampling = {0: ("float", self.seen.view)}
        return _Slot(
            lamp,
            corners,
            planes,
            bind_group(self.gpu, drawing, "faces"),
            bind_group(self.gpu, resampling, "resample"),
        )

    def _pipeline(self, group: BindGroup) -> Any:
        module = shader_module(self.gpu, f"{FOLDER}/faces.wgsl", STRUCTS)
        return self.gpu.device.create_render_pipeline(
            label="shadow faces",
            layout=pipeline_layout(self.gpu, [group]),
            vertex={"module": module, "entry_point": "face_corner"},
            primitive={"topology": "triangle-list", "cull_mode": "none"},
            depth_stencil={
                "format": "depth32float",
                "depth_write_enabled": True,
                "depth_compare": "greater",
            },
            fragment={
                "module": module,
                "entry_point": "face_plane",
                "targets": [{"format": self.seen.format}],
            },
        )

    def encode(self, encoder: Any, position: NDArray[np.float64], layer: int) -> None:
        """Records the map of a lamp at `position` (3,) into the discs `layer` and `layer` + 1."""
        slot = self._slots[layer // 2]
        faces = face_triangles(self.positions, self.triangles, position.astype(np.float32))
        self._upload(slot, position, np.concatenate(faces))
        render = encoder.begin_render_pass(
            label="shadow faces",
            color_attachments=[color_attachment(self.seen.view)],
            depth_stencil_attachment={
                "view": self.depth.view,
                "depth_load_op": "clear",
                "depth_store_op": "discard",
                "depth_clear_value": 0.0,
            },
        )
        render.set_pipeline(self._drawing)
        render.set_bind_group(0, slot.drawing.group)
        start = 0
        for face, triangles in enumerate(faces):
            corner = (face % 3 * self.face, face // 3 * self.face, self.face, self.face)
            render.set_viewport(*corner, 0, 1)
            render.set_scissor_rect(*corner)
            if len(triangles):
                render.draw(3 * len(triangles), 1, start, face)
            start += 3 * len(triangles)
        render.end()
        self._resampling.encode(encoder, self.discs[layer : layer + 2], [slot.resampling])

    def _upload(self, slot: _Slot, position: NDArray[np.float64], seen: NDArray[np.int32]) -> None:
        record = FACE_RECORD.pack(position=position, near_m=self.near_m)
        write_buffer(self.gpu, slot.lamp, record)
        if len(seen):
            write_buffer(self.gpu, slot.corners, self.triangles[seen])
            planes = self._planes.seen_from(position)
            write_buffer(self.gpu, slot.planes, planes[seen])
            if self.exact:
                rows = np.stack([planes, *self._planes.edges_from(position)], axis=1)
                first = self._slots.index(slot) * rows.nbytes
                self.gpu.device.queue.write_buffer(self.occluders, first, rows.view(np.uint8))


class TrianglePlanes:
    """Planes of triangles as any lamp has them; normals are made once."""

    def __init__(self, positions: NDArray[np.float32], triangles: NDArray[np.int32]) -> None:
        self._corners: NDArray[np.float64] = positions.astype(np.float64)[triangles]
        a, b, c = (self._corners[:, i] for i in range(3))
        self._normal: NDArray[np.float64] = np.cross(b - a, c - a)
        self._offset: NDArray[np.float64] = np.einsum("ij,ij->i", self._normal, a)
        self._tiny = 1e-12 * np.linalg.norm(self._normal, axis=1) + 1e-300

    def seen_from(self, lamp: NDArray[np.float64], /) -> NDArray[np.float32]:
        """(m, 4): q in xyz with q·(P − lamp) = 1 for the points P of each triangle's plane; its
        number plus one in w.

        q = n/(n·(a − lamp)); along a unit direction d the plane is 1/(q·d) away. Large where the
        lamp lies in the plane, which then is seen edge-on.
        """
        distance: NDArray[np.float64] = self._offset - self._normal @ lamp
        distance = np.where(np.abs(distance) < self._tiny, self._tiny, distance)
        planes = np.zeros((len(distance), 4), np.float32)
        planes[:, :3] = np.clip(self._normal / distance[:, None], -1e30, 1e30)
        planes[:, 3] = np.arange(1, len(planes) + 1)
        return planes

    def edges_from(self, lamp: NDArray[np.float64], /) -> list[NDArray[np.float32]]:
        """Three (m, 4): unit normals, inwards, of the planes through the lamp and each edge."""
        corners = self._corners - lamp
        side = np.sign(np.asarray(self._offset - self._normal @ lamp, np.float64))
        edges: list[NDArray[np.float32]] = []
        for first, second in ((0, 1), (1, 2), (2, 0)):
            normal = np.cross(corners[:, first], corners[:, second]) * side[:, None]
            length = np.linalg.norm(normal, axis=1, keepdims=True)
            unit = np.divide(normal, length, out=np.zeros_like(normal), where=length > 0)
            edges.append(np.pad(unit, ((0, 0), (0, 1))).astype(np.float32))
        return edges
