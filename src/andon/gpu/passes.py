"""Passes: pipelines made once, encoded with one call."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from andon.gpu.bindings import BindGroup
from andon.gpu.device import Gpu
from andon.gpu.layout import HostStruct
from andon.gpu.wgsl import resolve

__all__ = ["PLUS", "FullscreenPass", "color_attachment", "pipeline_layout", "shader_module"]

# Blending that adds to what is there, alpha too.
PLUS = {
    part: {"operation": "add", "src_factor": "one", "dst_factor": "one"}
    for part in ("color", "alpha")
}
# One triangle that covers the screen: cheaper than two, and no diagonal seam.
FULLSCREEN_VERTEX = """
@vertex fn fullscreen(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
  return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}
"""


def shader_module(
    gpu: Gpu,
    path: str,
    structs: Mapping[str, HostStruct] | None = None,
    variants: Mapping[str, str] | None = None,
) -> Any:
    """The compiled module at `path`, imports resolved, with the full-screen vertex stage."""
    code = resolve(path, structs, variants) + FULLSCREEN_VERTEX
    return gpu.device.create_shader_module(label=path, code=code)


def pipeline_layout(gpu: Gpu, groups: Sequence[BindGroup]) -> Any:
    """The layout of a pipeline that is given `groups` 0, 1, …"""
    return gpu.device.create_pipeline_layout(bind_group_layouts=[group.layout for group in groups])


def color_attachment(view: Any, *, load: bool = False) -> dict[str, Any]:
    """An attachment that is cleared to zero, or loaded."""
    return {
        "view": view,
        "load_op": "load" if load else "clear",
        "store_op": "store",
        "clear_value": (0, 0, 0, 0),
    }


class FullscreenPass:
    """One fragment entry point over a whole picture; `groups` are bind groups 0, 1, …

    `blend` is that of all targets, or of each.
    """

    def __init__(
        self,
        gpu: Gpu,
        path: str,
        entry_point: str,
        target_formats: Sequence[str],
        groups: Sequence[BindGroup],
        *,
        structs: Mapping[str, HostStruct] | None = None,
        variants: Mapping[str, str] | None = None,
        blend: Mapping[str, Any] | Sequence[Mapping[str, Any] | None] | None = None,
    ) -> None:
        self.gpu, self.groups = gpu, tuple(groups)
        self.label = f"{path}:{entry_point}"
        module = shader_module(gpu, path, structs, variants)
        blends = [blend] * len(target_formats) if isinstance(blend, Mapping | None) else blend
        targets = [
            {"format": name, **({"blend": own} if own else {})}
            for name, own in zip(target_formats, blends, strict=True)
        ]
        self.pipeline = gpu.device.create_render_pipeline(
            label=self.label,
            layout=pipeline_layout(gpu, groups),
            vertex={"module": module, "entry_point": "fullscreen"},
            primitive={"topology": "triangle-list"},
            fragment={"module": module, "entry_point": entry_point, "targets": targets},
        )

    def encode(
        self,
        encoder: Any,
        targets: Sequence[Any],
        groups: Sequence[BindGroup] | None = None,
        *,
        keep_first: bool = False,
    ) -> None:
        """Records the pass: `targets` are texture views, `groups` stand in for the pass's own.

        With `keep_first` the first target is drawn over, not cleared.
        """
        attachments = [
            color_attachment(view, load=keep_first and number == 0)
            for number, view in enumerate(targets)
        ]
        render = encoder.begin_render_pass(label=self.label, color_attachments=attachments)
        render.set_pipeline(self.pipeline)
        for index, bound in enumerate(groups or self.groups):
            render.set_bind_group(index, bound.group)
        render.draw(3)
        render.end()

    def encode_within(
        self, encoder: Any, targets: Sequence[Any], within: tuple[int, int, int, int]
    ) -> None:
        """Records the pass over x, y, width, height in pixels; what is beside it stays."""
        attachments = [color_attachment(view, load=True) for view in targets]
        render = encoder.begin_render_pass(label=self.label, color_attachments=attachments)
        render.set_pipeline(self.pipeline)
        for index, bound in enumerate(self.groups):
            render.set_bind_group(index, bound.group)
        render.set_scissor_rect(*within)
        render.draw(3)
        render.end()
