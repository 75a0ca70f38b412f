"""Passes over the polygon around a view's glass: of a ball's square a fifth is no ball."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from andon.glass.model import Solid
from andon.glass.screen import MOST_CORNERS, Rectangle, outline_of, rectangle_of
from andon.gpu.bindings import BindGroup
from andon.gpu.device import Gpu
from andon.gpu.passes import color_attachment, pipeline_layout, shader_module
from andon.gpu.textures import Texture, write_buffer
from andon.spaces import View

__all__ = ["GLASS", "Outline", "OutlinePass"]

GLASS = "andon/glass/glass.wgsl"
# Two numbers of four bytes.
CORNER_BYTES = 8


class Outline:
    """The polygon as triangles that share their first corner.

    Attributes
    ----------
    vertices : buffer of clip coordinates; `count` of them are drawn.
    within : (x, y, width, height) in pixels around it; None: no glass is seen.
    places : what tells two outlines apart.
    """

    def __init__(self, gpu: Gpu, view: View) -> None:
        import wgpu

        self.gpu, self.view = gpu, view
        self.vertices = gpu.device.create_buffer(
            label="outline of glass",
            size=3 * MOST_CORNERS * CORNER_BYTES,
            usage=wgpu.BufferUsage.VERTEX | wgpu.BufferUsage.COPY_DST,
        )
        self.count = 0
        self.places = b""
        self.within: Rectangle | None = None

    def move(self, solids: Sequence[Solid]) -> None:
        """Around `solids`, wherever they are now."""
        self.within = rectangle_of(solids, self.view)
        if self.within is None:
            self.count, self.places = 0, b""
            return
        corners = outline_of(solids, self.view)
        size = np.array([self.view.width, self.view.height])
        clip = (2 * (corners + 0.5) / size - 1) * [1, -1]
        fan = [clip[[0, k, k + 1]] for k in range(1, len(clip) - 1)]
        vertices = np.concatenate(fan).astype(np.float32)
        if vertices.tobytes() != self.places:
            write_buffer(self.gpu, self.vertices, vertices)
            self.count, self.places = len(vertices), vertices.tobytes()


class OutlinePass:
    """One fragment entry point of glass.wgsl over an outline; what is outside it is 0."""

    def __init__(
        self,
        gpu: Gpu,
        entry_point: str,
        formats: Sequence[str],
        groups: Sequence[BindGroup],
        options: Mapping[str, Any],
    ) -> None:
        """`options`: structs and variants of the shader."""
        module = shader_module(gpu, GLASS, **options)
        buffer = {
            "array_stride": CORNER_BYTES,
            "step_mode": "vertex",
            "attributes": [{"format": "float32x2", "offset": 0, "shader_location": 0}],
        }
        self.label, self.groups = f"{GLASS}:{entry_point}", tuple(groups)
        self.pipeline = gpu.device.create_render_pipeline(
            label=self.label,
            layout=pipeline_layout(gpu, groups),
            vertex={"module": module, "entry_point": "outline", "buffers": [buffer]},
            primitive={"topology": "triangle-list", "cull_mode": "none"},
            fragment={
                "module": module,
                "entry_point": entry_point,
                "targets": [{"format": name} for name in formats],
            },
        )
        self._drawn: bytes | None = None

    def encode(self, encoder: Any, targets: Sequence[Texture], outline: Outline) -> None:
        """Records the pass into `targets`, the same ones each time."""
        # It writes all of its outline: only where that has moved is there something to clear.
        keeps = self._drawn == outline.places
        self._drawn = outline.places
        render = encoder.begin_render_pass(
            label=self.label,
            color_attachments=[color_attachment(target.view, load=keeps) for target in targets],
        )
        if outline.within is not None:
            render.set_pipeline(self.pipeline)
            for index, group in enumerate(self.groups):
                render.set_bind_group(index, group.group)
            render.set_vertex_buffer(0, outline.vertices)
            render.set_scissor_rect(*outline.within)
            render.draw(outline.count)
        render.end()
