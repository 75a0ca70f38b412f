"""The coarser levels of a picture, and the paper's blur of it, made by passes.

A blur wider than σ = 4 texels is made in a coarser level, where it has σ = 2 to 4 texels, and
expanded again: what the boxes and the expansion blur by themselves is taken off its variance
((4ᵏ − 1)/12 and 4ᵏ/6 texels² of level 0). A blur of any width costs at most 33 taps along each
axis, and a wide one fewer texels. Beyond the border the last texel of the coarser level goes on.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.glass.backdrops.atlas import Rectangle
from andon.glass.backdrops.paper import taps_of
from andon.glass.backdrops.pyramids import levels_of
from andon.gpu.bindings import bind_group
from andon.gpu.device import Gpu
from andon.gpu.layout import HostStruct
from andon.gpu.passes import FullscreenPass, color_attachment
from andon.gpu.textures import Texture, make_texture, uniform_buffer, write_buffer

__all__ = ["BLUR_RECORD", "FORMAT", "FrameLevels", "Levels", "level_and_taps"]

FORMAT = "rgba16float"
# Where the picture's texels are, between blurring passes: half floats are cut by some drivers.
BETWEEN = "rgba32float"

BLUR_RECORD = HostStruct(
    "BlurRecord",
    (
        ("corner", "vec2f"),
        ("size", "vec2f"),
        ("step", "vec2f"),
        ("radius", "f32"),
        ("scale", "f32"),
    ),
)

# Standard deviation in texels of the level that a blur is made in, at least.
LEAST_SIGMA = 2.0
# To one side: those of σ = 4 texels end before 4σ, at ±K_g/2 = σ² otherwise.
MOST_TAPS = 16


def level_and_taps(kernel_texels: float, levels: int, /) -> tuple[int, NDArray[np.float64]]:
    """The level that a blur with K_g = `kernel_texels` is made in, and its weights there."""
    variance = max(kernel_texels, 0.0) / 2
    level = max(0, min(levels, math.floor(math.log2(max(math.sqrt(variance), 1) / LEAST_SIGMA))))
    if level == 0:
        return 0, taps_of(kernel_texels)
    left = (variance - (4**level - 1) / 12 - 4**level / 6) / 4**level
    radius = min(MOST_TAPS, int(kernel_texels / 2 / 2**level))
    weights = np.exp(-(np.arange(radius + 1) ** 2) / (2 * left))
    return level, weights / (weights[0] + 2 * weights[1:].sum())


class Levels:
    """Level 0 of a picture from `source` at `place`, into `target` with all coarser ones, there.

    Both are rgba16float; `source` needs no levels, `target` has room for them (`Rectangle.extent`).
    `blurs`: it can be asked for the paper's blur, which takes 40 bytes a texel.
    """

    def __init__(
        self,
        gpu: Gpu,
        source: Texture,
        corner: tuple[int, int],
        target: Texture,
        place: Rectangle,
        *,
        blurs: bool = False,
    ) -> None:
        self.gpu, self._source, self._corner, self._target = gpu, source, corner, target
        self.place = place
        # A texture is not read and drawn into at once: levels are drawn beside, and copied.
        half = self._size(1)
        self._beside = make_texture(gpu, FORMAT, *half, label="level")
        group = bind_group(gpu, {0: ("float", target.view)}, "levels")
        self._halve = [
            FullscreenPass(
                gpu,
                "andon/glass/backdrops/halve.wgsl",
                "halve",
                [FORMAT],
                [group],
                variants={"andon/glass/backdrops/halved.wgsl": self._level_text(level)},
            )
            for level in range(place.levels)
        ]
        self._blur = _Blur(gpu, target, place) if blurs else None

    def _place_of(self, level: int) -> tuple[int, int]:
        column, row, high = self.place.column, self.place.row, self.place.extent[1]
        if level == 0:
            return column, row
        return column + self.place.width, row + high - (2 * high >> level)

    def _size(self, level: int) -> tuple[int, int]:
        return -(-self.place.width >> level), -(-self.place.height >> level)

    def _level_text(self, level: int) -> str:
        width, height = self._size(level)
        lines = f"CORNER = vec2i{self._place_of(level)}", f"LAST = vec2i({width - 1}, {height - 1})"
        return "".join(f"const {line};\n" for line in lines)

    def encode(self, encoder: Any, kernel_texels: float = 0.0) -> None:
        """Records the copy and its levels; blurred by the paper's K_g = `kernel_texels`, if any
        blur was asked for.
        """
        size = self._size(0)
        self._copy(encoder, self._source, self._corner, self._place_of(0), size)
        level, taps = level_and_taps(kernel_texels, self.place.levels)
        if self._blur is None or len(taps) == 1:
            self._coarser(encoder, self.place.levels)
            return
        self._coarser(encoder, level)
        blurred = self._blur.encode(encoder, taps, self._place_of(level), self._size(level), level)
        self._copy(encoder, blurred, (0, 0), self._place_of(0), size)
        self._coarser(encoder, self.place.levels)

    def _coarser(self, encoder: Any, last: int) -> None:
        for level, step in enumerate(self._halve[:last]):
            size = self._size(level + 1)
            _draw(encoder, step, self._beside, size)
            self._copy(encoder, self._beside, (0, 0), self._place_of(level + 1), size)

    def _copy(
        self,
        encoder: Any,
        source: Texture,
        start: tuple[int, int],
        corner: tuple[int, int],
        size: tuple[int, int],
    ) -> None:
        encoder.copy_texture_to_texture(
            {"texture": source.handle, "origin": (*start, 0)},
            {"texture": self._target.handle, "origin": (*corner, 0)},
            (*size, 1),
        )


class FrameLevels(Levels):
    """The frame before glass and its coarser levels in a texture of their own, `texture`."""

    def __init__(self, gpu: Gpu, frame: Texture, *, blurs: bool = False) -> None:
        levels = levels_of(frame.width, frame.height)
        place = Rectangle(0, 0, frame.width, frame.height, levels)
        self.texture = make_texture(gpu, FORMAT, *place.extent, label="frame levels")
        super().__init__(gpu, frame, (0, 0), self.texture, place, blurs=blurs)


class _Blur:
    """Along columns, along rows, and back to level 0."""

    def __init__(self, gpu: Gpu, levels: Texture, place: Rectangle) -> None:
        self.gpu, size = gpu, (place.width, place.height)
        self._size = size
        self._across, self._down = (make_texture(gpu, BETWEEN, *size) for _ in range(2))
        self._whole = make_texture(gpu, FORMAT, *size)
        self._records = [uniform_buffer(gpu, BLUR_RECORD.dtype.itemsize) for _ in range(3)]
        self._weights = uniform_buffer(gpu, 8 * 16)
        sources = (levels, self._across, self._down)
        entries = (("along", BETWEEN), ("along", BETWEEN), ("expanded", FORMAT))
        self._passes = [
            FullscreenPass(
                gpu,
                "andon/glass/backdrops/blur.wgsl",
                entry,
                [format],
                [self._group(source, record)],
                structs={BLUR_RECORD.name: BLUR_RECORD},
            )
            for (entry, format), source, record in zip(entries, sources, self._records, strict=True)
        ]

    def _group(self, source: Texture, record: Any) -> Any:
        resources: dict[int, tuple[str, Any]] = {
            0: ("float", source.view),
            1: ("uniform", record),
            2: ("uniform", self._weights),
        }
        return bind_group(self.gpu, resources, "blur")

    def encode(
        self,
        encoder: Any,
        taps: NDArray[np.float64],
        corner: tuple[int, int],
        size: tuple[int, int],
        level: int,
    ) -> Texture:
        """The picture (level 0), blurred in the level of `size` that lies at `corner`."""
        weights = np.zeros(32, np.float32)
        weights[: len(taps)] = taps
        write_buffer(self.gpu, self._weights, weights)
        shared = {"size": size, "radius": len(taps) - 1, "scale": 0.5**level}
        for record, start, step in zip(
            self._records, (corner, (0, 0), (0, 0)), ((1, 0), (0, 1), (0, 0)), strict=True
        ):
            packed = BLUR_RECORD.pack(corner=start, step=step, **shared)
            write_buffer(self.gpu, record, packed)
        targets = (self._across, self._down, self._whole)
        for step, target, drawn in zip(
            self._passes, targets, (size, size, self._size), strict=True
        ):
            _draw(encoder, step, target, drawn)
        return self._whole


def _draw(encoder: Any, step: FullscreenPass, target: Texture, size: tuple[int, int]) -> None:
    render = encoder.begin_render_pass(
        label=step.label, color_attachments=[color_attachment(target.view, load=True)]
    )
    render.set_pipeline(step.pipeline)
    render.set_bind_group(0, step.groups[0].group)
    render.set_scissor_rect(0, 0, *size)
    render.draw(3)
    render.end()
