"""Passes: pipelines made once, encoded with one call."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from andon.gpu.device import Gpu
from andon.gpu.layout import HostStruct
from andon.gpu.wgsl import resolve

__all__ = ["FullscreenPass", "bind", "color_attachment", "shader_module"]

# One triangle that covers the screen: cheaper than two, and no diagonal seam.
FULLSCREEN_VERTEX = """
@vertex fn fullscreen(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
  return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}
"""


def shader_module(gpu: Gpu, path: str, structs: Mapping[str, HostStruct] | None = None) -> Any:
    """The compiled module at `path`, imports resolved, with the full-screen vertex stage."""
    code = resolve(path, structs) + FULLSCREEN_VERTEX
    return gpu.device.create_shader_module(label=path, code=code)


def bind(gpu: Gpu, pipeline: Any, group: int, resources: Mapping[int, Any]) -> Any:
    """A bind group for `pipeline`: binding number → texture view, sampler or buffer."""
    import wgpu

    entries: list[dict[str, Any]] = []
    for binding, resource in resources.items():
        if isinstance(resource, wgpu.GPUBuffer):
            resource = {"buffer": resource, "offset": 0, "size": resource.size}
        entries.append({"binding": binding, "resource": resource})
    return gpu.device.create_bind_group(
        layout=pipeline.get_bind_group_layout(group), entries=entries
    )


def color_attachment(view: Any, *, load: bool = False) -> dict[str, Any]:
    """An attachment that is cleared to zero, or loaded."""
    return {
        "view": view,
        "load_op": "load" if load else "clear",
        "store_op": "store",
        "clear_value": (0, 0, 0, 0),
    }


class FullscreenPass:
    """One fragment entry point over a whole picture."""

    def __init__(
        self,
        gpu: Gpu,
        path: str,
        entry_point: str,
        target_formats: Sequence[str],
        *,
        structs: Mapping[str, HostStruct] | None = None,
        blend: Mapping[str, Any] | None = None,
    ) -> None:
        self.gpu = gpu
        self.label = f"{path}:{entry_point}"
        module = shader_module(gpu, path, structs)
        targets = [{"format": f, **({"blend": blend} if blend else {})} for f in target_formats]
        self.pipeline = gpu.device.create_render_pipeline(
            label=self.label,
            layout="auto",
            vertex={"module": module, "entry_point": "fullscreen"},
            primitive={"topology": "triangle-list"},
            fragment={"module": module, "entry_point": entry_point, "targets": targets},
        )

    def bind(self, group: int, resources: Mapping[int, Any]) -> Any:
        """A bind group for this pass."""
        return bind(self.gpu, self.pipeline, group, resources)

    def encode(self, encoder: Any, targets: Sequence[Any], groups: Sequence[Any]) -> None:
        """Records the pass: `targets` are texture views, `groups` bind groups 0, 1, …"""
        render = encoder.begin_render_pass(
            label=self.label, color_attachments=[color_attachment(view) for view in targets]
        )
        render.set_pipeline(self.pipeline)
        for index, group in enumerate(groups):
            render.set_bind_group(index, group)
        render.draw(3)
        render.end()
