"""Backdrops on the GPU: the atlas and the records of a scene, the levels of a view's frame."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from numpy.typing import NDArray

from andon.glass.backdrops.atlas import Rectangle, make_atlas
from andon.glass.backdrops.pyramids import levels_of
from andon.glass.backdrops.records import (
    BACKDROP_RECORD,
    ENVIRONMENT_RECORD,
    pack_backdrops,
    pack_environments,
)
from andon.glass.model import MAX_SOLIDS, Solid
from andon.gpu.bindings import BindGroup, bind_group
from andon.gpu.device import Gpu
from andon.gpu.passes import FullscreenPass, color_attachment
from andon.gpu.textures import Texture, make_texture, uniform_buffer, write_buffer

__all__ = ["BackdropBuffers", "FrameLevels"]

FORMAT = "rgba16float"


class BackdropBuffers:
    """What all views of a scene share; `notes` name pictures that were made smaller."""

    def __init__(
        self,
        gpu: Gpu,
        solids: Sequence[Solid],
        environment: NDArray[Any],
        luminance_per_unit: float,
        dimming: tuple[float, float, float] = (1.0, 1.0, 1.0),
    ) -> None:
        self.gpu, self._solids, self._unit = gpu, tuple(solids), luminance_per_unit
        self._atlas = make_atlas(solids, gpu.device.limits["max-texture-dimension-2d"])
        self.notes = self._atlas.notes
        height, width = self._atlas.texels.shape[:2]
        self.atlas = make_texture(gpu, FORMAT, width, height, label="backdrops")
        self.atlas.write(self._atlas.texels)
        size = MAX_SOLIDS * BACKDROP_RECORD.dtype.itemsize
        self._records = uniform_buffer(gpu, size, "backdrops")
        size = MAX_SOLIDS * ENVIRONMENT_RECORD.dtype.itemsize
        self._environments = uniform_buffer(gpu, size, "environments")
        self.write_solids(solids, dimming)
        self.write_environment(environment)

    def write_solids(
        self, solids: Sequence[Solid], dimming: tuple[float, float, float] = (1.0, 1.0, 1.0)
    ) -> None:
        """Other places of the same backdrops, other light on them."""
        write_buffer(self.gpu, self._records, pack_backdrops(solids, self._atlas, dimming))

    def write_environment(self, environment: NDArray[Any]) -> None:
        """(n, 9, 3) harmonics in cd/m², of each body."""
        write_buffer(self.gpu, self._environments, pack_environments(environment, self._unit))

    def group(self, levels: Texture) -> BindGroup:
        """Group 1 of a view, given the `levels` of its frame."""
        resources: dict[int, tuple[str, Any]] = {
            0: ("float", self.atlas.view),
            1: ("uniform", self._records),
            2: ("float", levels.view),
            3: ("uniform", self._environments),
        }
        return bind_group(self.gpu, resources, "backdrops")


class FrameLevels:
    """The frame before glass and its coarser levels in one texture, as pyramids.wgsl reads it.

    `frame` (rgba16float) is what is copied; `texture` is written.
    """

    def __init__(self, gpu: Gpu, frame: Texture) -> None:
        self.gpu, self._frame = gpu, frame
        levels = levels_of(frame.width, frame.height)
        self.place = Rectangle(0, 0, frame.width, frame.height, levels)
        width, height = self.place.extent
        self.texture = make_texture(gpu, FORMAT, width, height, label="frame levels")
        # A texture is not read and drawn into at once: the levels are drawn beside and copied.
        self._beside = make_texture(gpu, FORMAT, -(-width // 2), -(-height // 2), label="level")
        self._halve = [
            FullscreenPass(
                gpu,
                "andon/glass/backdrops/halve.wgsl",
                "halve",
                [FORMAT],
                [bind_group(gpu, {0: ("float", self.texture.view)}, "frame levels")],
                variants={"andon/glass/backdrops/halved.wgsl": self._level_text(level)},
            )
            for level in range(levels)
        ]

    def _corner(self, level: int) -> tuple[int, int]:
        high = self.place.extent[1]
        return (self.place.width, high - (2 * high >> level)) if level else (0, 0)

    def _size(self, level: int) -> tuple[int, int]:
        return -(-self.place.width >> level), -(-self.place.height >> level)

    def _level_text(self, level: int) -> str:
        corner, (width, height) = self._corner(level), self._size(level)
        lines = f"CORNER = vec2i{corner}", f"LAST = vec2i({width - 1}, {height - 1})"
        return "".join(f"const {line};\n" for line in lines)

    def encode(self, encoder: Any) -> None:
        """Records the copy of the frame, and its levels."""
        self._copy(encoder, self._frame, (0, 0), (self._frame.width, self._frame.height))
        for level, step in enumerate(self._halve):
            size = self._size(level + 1)
            render = encoder.begin_render_pass(
                label=step.label,
                color_attachments=[color_attachment(self._beside.view, load=True)],
            )
            render.set_pipeline(step.pipeline)
            render.set_bind_group(0, step.groups[0].group)
            render.set_scissor_rect(0, 0, *size)
            render.draw(3)
            render.end()
            self._copy(encoder, self._beside, self._corner(level + 1), size)

    def _copy(
        self, encoder: Any, source: Texture, corner: tuple[int, int], size: tuple[int, int]
    ) -> None:
        encoder.copy_texture_to_texture(
            {"texture": source.handle},
            {"texture": self.texture.handle, "origin": (*corner, 0)},
            (*size, 1),
        )
