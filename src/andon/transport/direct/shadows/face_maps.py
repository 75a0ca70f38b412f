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
from andon.transport.direct.shadows.caster_buffers import CasterBuffers
from andon.transport.direct.shadows.culling import face_triangles

__all__ = ["FaceMaps"]

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
    casters : what casts shadows.
    discs : views of the layers to fill, two for each lamp.
    map_size : texels along a side of a disc.
    exact : discs hold which triangle is seen, and `occluders` describes it.
    slots : lamps that can be recorded before the commands are submitted; None: all.

    Attributes
    ----------
    occluders : (lamps · m · 4,) vec4f storage buffer, see filter_exact.wgsl; one row without
        `exact`.
    """

    def __init__(
        self,
        gpu: Gpu,
        casters: CasterBuffers,
        discs: Sequence[Any],
        map_size: int,
        *,
        exact: bool = False,
        slots: int | None = None,
    ) -> None:
        self.gpu, self.discs, self.exact = gpu, discs, exact
        self.casters = casters
        self.face = map_size // 2
        size = (3 * self.face, 2 * self.face)
        self.depth = make_texture(gpu, "depth32float", *size, label="faces: depth")
        self.seen = make_texture(gpu, "rgba32float", *size, label="faces: planes")
        self._slots = [self._slot() for _ in range(slots or len(discs) // 2)]
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
        rows = 4 * len(casters.triangles) * len(self._slots) if exact else 1
        self.occluders = self._storage(16 * max(1, rows))

    def _storage(self, size_bytes: int) -> Any:
        import wgpu

        usage = wgpu.BufferUsage.STORAGE | wgpu.BufferUsage.COPY_DST
        return self.gpu.device.create_buffer(size=size_bytes, usage=usage)

    def _slot(self) -> _Slot:
        # Worst case: every face sees every triangle.
        most = max(1, 6 * len(self.casters.triangles))
        lamp = uniform_buffer(self.gpu, FACE_RECORD.dtype.itemsize, "shadow lamp")
        corners, planes = self._storage(12 * most), self._storage(16 * most)
        drawing = {
            0: ("uniform", lamp),
            1: ("storage", self.casters.vertices),
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

    def encode(
        self,
        encoder: Any,
        position: NDArray[np.float64],
        layer: int,
        hiding: NDArray[np.bool_] | None,
        near_m: float,
    ) -> None:
        """Records the map of a lamp at `position` (3,) into the discs `layer` and `layer` + 1.

        `hiding` (m,) says which triangles hide this lamp; None: all. Nothing nearer than `near_m`
        does.
        """
        slot = self._slots[layer // 2 % len(self._slots)]
        casters = self.casters
        faces = face_triangles(casters.positions, casters.triangles, position.astype(np.float32))
        if hiding is not None:
            faces = [face[hiding[face]] for face in faces]
        self._upload(slot, position, np.concatenate(faces), near_m)
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

    def _upload(
        self,
        slot: _Slot,
        position: NDArray[np.float64],
        seen: NDArray[np.int32],
        near_m: float,
    ) -> None:
        record = FACE_RECORD.pack(position=position, near_m=near_m)
        write_buffer(self.gpu, slot.lamp, record)
        if len(seen):
            write_buffer(self.gpu, slot.corners, self.casters.triangles[seen])
            planes = self.casters.planes.seen_from(position)
            write_buffer(self.gpu, slot.planes, planes[seen])
            if self.exact:
                rows = np.stack([planes, *self.casters.planes.edges_from(position)], axis=1)
                first = self._slots.index(slot) * rows.nbytes
                self.gpu.device.queue.write_buffer(self.occluders, first, rows.view(np.uint8))
