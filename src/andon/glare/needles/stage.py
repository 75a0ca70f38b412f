"""Needles on the GPU."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from andon import gbuffer
from andon.errors import InputError
from andon.glare.needles.model import NeedleModel, Needles
from andon.glare.needles.records import (
    MOST_PARTS,
    NEEDLE_RECORD,
    STRUCTS,
    pack_constants,
    pack_needles,
)
from andon.gpu.bindings import bind_group
from andon.gpu.device import Gpu
from andon.gpu.passes import PLUS, color_attachment, pipeline_layout, shader_module
from andon.gpu.textures import Texture, uniform_buffer, write_buffer
from andon.spaces import View

__all__ = ["NeedleStage"]

FORMAT = "rgba16float"
MODULE = "andon/glare/needles/needles.wgsl"
STRIP = "andon/glare/needles/strip_{}.wgsl"
CAP = "andon/glare/quads/{}.wgsl"
# Vertices of a needle or a part of it: a quad, and another one beyond the seam.
VERTICES = {"pinhole": 6, "fisheye": 6, "latlong": 12}


class NeedleStage:
    """Adds needles to a picture, rgba16float of the view's size; its alpha stays.

    Sums are rounded to half floats at each needle, and cut by some drivers: up to 0.05 % for each
    that overlaps, 2 to 3 % where all of a star do. Above 65504 units of the picture a needle is
    cut, and a sum of several is infinite: white on any display.
    """

    def __init__(
        self,
        gpu: Gpu,
        view: View,
        capacity: int,
        *,
        model: NeedleModel | None = None,
        luminance_per_unit: float = 1.0,
    ) -> None:
        """At most `capacity` needles, all of one `model`; `luminance_per_unit` of the target."""
        import wgpu

        self.gpu, self.view, self.capacity = gpu, view, capacity
        self.model, self._luminance_per_unit = model or NeedleModel(), luminance_per_unit
        self._drawn = 0
        parts = 1 if view.projection == "pinhole" else MOST_PARTS
        constants = pack_constants(self.model, view)
        seen = gbuffer.pack_view(view)
        buffers = [uniform_buffer(gpu, part.nbytes, "needles") for part in (seen, constants)]
        for buffer, values in zip(buffers, (seen, constants), strict=True):
            write_buffer(gpu, buffer, values)
        self._records = gpu.device.create_buffer(
            label="needles",
            size=max(1, capacity) * parts * NEEDLE_RECORD.dtype.itemsize,
            usage=wgpu.BufferUsage.STORAGE | wgpu.BufferUsage.COPY_DST,
        )
        self._group = bind_group(
            gpu,
            {0: ("uniform", buffers[0]), 1: ("uniform", buffers[1]), 2: ("storage", self._records)},
            "needles",
        )
        self._pipeline = self._make_pipeline()

    def _make_pipeline(self) -> Any:
        projection = self.view.projection
        variants = gbuffer.projection_variant(self.view) | {
            CAP.format("pinhole"): CAP.format(projection),
            STRIP.format("straight"): STRIP.format(
                "straight" if projection == "pinhole" else "curved"
            ),
        }
        module = shader_module(self.gpu, MODULE, STRUCTS | gbuffer.STRUCTS, variants)
        return self.gpu.device.create_render_pipeline(
            label=MODULE,
            layout=pipeline_layout(self.gpu, [self._group]),
            vertex={"module": module, "entry_point": "needle_corner"},
            primitive={"topology": "triangle-list"},
            fragment={
                "module": module,
                "entry_point": "needle_light",
                "targets": [{"format": FORMAT, "blend": PLUS}],
            },
        )

    def update(self, needles: Sequence[Needles], /) -> None:
        """The needles that are drawn from now on.

        Raises `InputError` for more than `capacity`, or another model than the stage's.
        """
        count = sum(len(star) for star in needles)
        if count > self.capacity:
            raise InputError(f"at most {self.capacity} needles, got {count}", field="needles")
        if any(star.model != self.model for star in needles):
            raise InputError("all needles of a stage have its model", field="needles.model")
        records = pack_needles(needles, self.view, self._luminance_per_unit)
        if count:
            write_buffer(self.gpu, self._records, records)
        self._drawn = len(records)

    def encode(self, encoder: Any, target: Texture) -> None:
        """Records the needles onto `target`, whose light stays."""
        if not self._drawn:
            return
        render = encoder.begin_render_pass(
            label="needles", color_attachments=[color_attachment(target.view, load=True)]
        )
        render.set_pipeline(self._pipeline)
        render.set_bind_group(0, self._group.group)
        render.draw(VERTICES[self.view.projection], self._drawn)
        render.end()
