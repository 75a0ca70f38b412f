"""The frame beside the glass, blurred by its own depth, on the GPU."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from andon import gbuffer
from andon.glass.defocus.kernels import MAX_BLUR_PX
from andon.glass.defocus.plan import STEPS, DiscPlan, size_table
from andon.gpu.bindings import bind_group
from andon.gpu.device import Gpu
from andon.gpu.layout import HostStruct
from andon.gpu.passes import FullscreenPass
from andon.gpu.textures import Texture, make_texture, uniform_buffer, write_buffer
from andon.spaces import View

__all__ = ["FRAME_RECORD", "FrameDefocusStage"]

FRAME_RECORD = HostStruct(
    "FrameRecord", (("focus_dioptres", "f32"), ("pupil_m", "f32"), ("largest_px", "f32"))
)

FORMAT = "rgba16float"
SHADER, PYRAMID, LEVEL = (
    f"andon/glass/defocus/{name}.wgsl" for name in ("frame", "frame_pyramid", "frame_level")
)
# At full, half and a quarter of the size: diameters in pixels between which discs become the
# level's; and texels to one side that they reach where they become the next one's.
FIRST = ((-2.0, -1.0), (4.6, 6.0), (17.0, 21.0))
NEVER = (1000.0, 1001.0)
REACH = (3, 6, 8)
# Second moments along an axis, in texels², that means 1 3 3 1 (¾ px² a level, 4 times that on the
# next) and linear interpolation (the mean of s·(1 − s) over a texel's pixels) add.
ADDED = (0.0, 1.5 / 4, 6.5 / 16)
# Rounds of ranges: texels between those that each takes together.
APART = (1, 3, 4)
# Alpha of the frame stays.
KEEPING = {
    "color": {"operation": "add", "src_factor": "one", "dst_factor": "zero"},
    "alpha": {"operation": "add", "src_factor": "zero", "dst_factor": "one"},
}


def _constants(level: int, apart: int = 1) -> str:
    """What stands in for frame_level.wgsl."""
    texel = 2.0**level
    last = (*FIRST, NEVER)[level + 1]
    lines = {
        "TEXEL: f32": texel,
        "FIRST": f"vec2f{FIRST[level]}",
        "LAST": f"vec2f{last}",
        "HALF_SHARPENING: f32": ADDED[level] / 2,
        "REACH: i32": REACH[level],
        "STEPS: f32": float(STEPS),
        "APART: i32": apart,
    }
    text = "".join(f"const {name} = {value};\n" for name, value in lines.items())
    return f"//!import andon/gpu/pi.wgsl\n{text}"


class FrameDefocusStage:
    """Blurs `target` (H, W) rgba16float in place by the depths of a G-buffer of the same view.

    Discs are those of `frame.frame_blurred`, at most `MAX_BLUR_PX` wide; the rule is its rule.
    """

    def __init__(self, gpu: Gpu, view: View, surface: tuple[Any, Any], target: Texture) -> None:
        """`surface`: view of the packed G-buffer's texture, and buffer of its `VIEW_RECORD`."""
        self.gpu, self._target = gpu, target
        self._record = uniform_buffer(gpu, FRAME_RECORD.dtype.itemsize, "frame's defocus")
        table = size_table(DiscPlan("optical"))
        self._table = make_texture(gpu, "r32float", table.shape[1], 1, label="sizes of discs")
        self._table.write(table)
        sizes = [(-(-view.width // 2**n), -(-view.height // 2**n)) for n in range(3)]
        self._seen = [make_texture(gpu, FORMAT, *size, label="seen") for size in sizes]
        self._sharp = [make_texture(gpu, FORMAT, *size, label="sharp") for size in sizes[1:]]
        self._sums = [make_texture(gpu, FORMAT, *size, label="sums") for size in sizes[1:]]
        shared = {0: ("uint", surface[0]), 1: ("uniform", surface[1])}
        shared |= {2: ("uniform", self._record), 3: ("float", self._table.view)}
        self._ranges = [make_texture(gpu, FORMAT, *sizes[2], label="ranges") for _ in APART]
        full, half, quarter = self._seen
        variants = gbuffer.projection_variant(view)
        passes = [
            ("seen", [target], 0, full),
            ("halve", [full], 0, half),
            ("halve", [half], 1, quarter),
            ("range", [quarter], 2, self._ranges[0]),
            ("range", [self._ranges[0]], 2, self._ranges[1]),
            ("range", [self._ranges[1]], 2, self._ranges[2]),
            ("sharpen", [half], 1, self._sharp[0]),
            ("sharpen", [quarter], 2, self._sharp[1]),
            ("spread", [self._sharp[0]], 1, self._sums[0]),
            ("spread", [self._sharp[1]], 2, self._sums[1]),
        ]
        rounds = iter(APART)
        apart_of = [next(rounds) if name == "range" else 1 for name, *_ in passes]
        self._passes = [
            (self._pass(name, shared, sources, level, variants, apart), result)
            for (name, sources, level, result), apart in zip(passes, apart_of, strict=True)
        ]
        levels = [full, half, self._sums[0], quarter, self._sums[1]]
        self._lay = self._pass("lay", shared, levels, 0, variants)

    def _pass(
        self,
        entry_point: str,
        shared: Mapping[int, tuple[str, Any]],
        textures: list[Texture],
        level: int,
        variants: Mapping[str, str],
        apart: int = 1,
    ) -> FullscreenPass:
        own = {4 + place: ("float", one.view) for place, one in enumerate(textures)}
        draws = entry_point in ("spread", "lay")
        if draws:
            own[9] = ("float", self._ranges[-1].view)
        return FullscreenPass(
            self.gpu,
            SHADER if draws else PYRAMID,
            entry_point,
            [FORMAT],
            [bind_group(self.gpu, {**shared, **own}, "frame's defocus")],
            structs=gbuffer.STRUCTS | {FRAME_RECORD.name: FRAME_RECORD},
            variants={**variants, LEVEL: _constants(level, apart)},
            blend=KEEPING if entry_point == "lay" else None,
        )

    def encode(self, encoder: Any, focus_dioptres: float, pupil_m: float) -> None:
        """Records the blur of `target`."""
        record = FRAME_RECORD.pack(
            focus_dioptres=focus_dioptres, pupil_m=pupil_m, largest_px=MAX_BLUR_PX
        )
        write_buffer(self.gpu, self._record, record)
        for step, texture in self._passes:
            step.encode(encoder, [texture.view])
        whole = (0, 0, self._target.width, self._target.height)
        self._lay.encode_within(encoder, [self._target.view], whole)
