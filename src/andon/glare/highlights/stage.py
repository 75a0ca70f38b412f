"""Highlights on the GPU: one pass over the picture, and a picture of them alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from andon import gbuffer
from andon.glare.highlights.albedo import albedo_table
from andon.glare.highlights.model import Finish
from andon.glare.highlights.records import STRUCTS, pack_finishes, pack_waves
from andon.gpu.bindings import BindGroup, bind_group
from andon.gpu.device import Gpu
from andon.gpu.layout import HostStruct
from andon.gpu.passes import FullscreenPass
from andon.gpu.textures import make_texture, write_buffer
from andon.spaces import View

__all__ = ["SUM", "FinishBuffers", "HighlightStage"]

SHADER = "andon/highlights.wgsl"
SUM = "andon/glare/highlights/sum.wgsl"
_KEPT = {"operation": "add", "src_factor": "one", "dst_factor": "src-alpha"}
# Alpha of the frame stays 1.
_ALPHA = {"operation": "add", "src_factor": "zero", "dst_factor": "one"}


class FinishBuffers:
    """Finishes and ripples of a moment, shared by both eyes.

    Attributes
    ----------
    group : bind group 3 of highlights.wgsl.
    """

    def __init__(self, gpu: Gpu, finishes: Sequence[Finish | None]) -> None:
        self.gpu = gpu
        records, waves = pack_finishes(finishes), pack_waves(finishes, 0.0)
        self._finishes = self._filled(records)
        self._waves = self._filled(waves)
        table = self._filled(np.asarray(albedo_table(), np.float32))
        resources = {
            0: ("storage", self._finishes),
            1: ("storage", self._waves),
            2: ("storage", table),
        }
        self.group = bind_group(gpu, resources, "finishes")

    def _filled(self, values: Any) -> Any:
        import wgpu

        usage = wgpu.BufferUsage.STORAGE | wgpu.BufferUsage.COPY_DST
        data = np.ascontiguousarray(values)
        return self.gpu.device.create_buffer_with_data(data=data, usage=usage)

    def update(self, finishes: Sequence[Finish | None], time_seconds: float) -> None:
        """Takes the finishes of a moment, as many as at the start."""
        write_buffer(self.gpu, self._finishes, pack_finishes(finishes))
        write_buffer(self.gpu, self._waves, pack_waves(finishes, time_seconds))


class HighlightStage:
    """Draws what one view sees mirrored.

    Parameters
    ----------
    groups : bind groups 0 and 1 of frame.wgsl, and 2 where there are probes.
    structs, variants : of frame.wgsl; `variants` names the module in place of `SUM`.

    Attributes
    ----------
    alone : rgba32float, mirrored lamps in cd/m², 0 elsewhere.
    """

    def __init__(
        self,
        gpu: Gpu,
        view: View,
        finishes: FinishBuffers,
        groups: Sequence[BindGroup],
        structs: Mapping[str, HostStruct],
        variants: Mapping[str, str],
    ) -> None:
        # Not half floats: they end at 65504, and the image of a lamp does not.
        self.alone = make_texture(gpu, "rgba32float", view.width, view.height, label="highlights")
        padding = [bind_group(gpu, {})] * (3 - len(groups))
        self._pass = FullscreenPass(
            gpu,
            SHADER,
            "mirrored_light",
            ["rgba16float", self.alone.format],
            [*groups, *padding, finishes.group],
            structs=gbuffer.STRUCTS | dict(structs) | STRUCTS,
            variants=variants,
            blend=[{"color": _KEPT, "alpha": _ALPHA}, None],
        )

    def encode(self, encoder: Any, luminance: Any) -> None:
        """Records the pass over the view of the texture `luminance`, in units of the picture."""
        self._pass.encode(encoder, [luminance, self.alone.view], keep_first=True)
