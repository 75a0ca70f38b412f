"""Bind groups with stated layouts: a shader may use fewer of the bindings than the group has.

Layouts that wgpu derives from a shader leave out what that shader does not read, so a group would
fit one shader only. Stated once beside the resources, one group serves every shader of a frame.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from andon.gpu.device import Gpu

__all__ = ["BindGroup", "bind_group"]

_UNFILTERABLE = {"sample_type": "unfilterable-float", "view_dimension": "2d"}
_ENTRIES: dict[str, dict[str, Any]] = {
    "uniform": {"buffer": {"type": "uniform"}},
    "storage": {"buffer": {"type": "read-only-storage"}},
    "float": {"texture": _UNFILTERABLE},
    "float array": {"texture": {**_UNFILTERABLE, "view_dimension": "2d-array"}},
    "uint": {"texture": {"sample_type": "uint", "view_dimension": "2d"}},
    "uint array": {"texture": {"sample_type": "uint", "view_dimension": "2d-array"}},
    "depth": {"texture": {"sample_type": "depth", "view_dimension": "2d"}},
    "sampler": {"sampler": {"type": "non-filtering"}},
    "smooth": {"texture": {"sample_type": "float", "view_dimension": "2d"}},
    "linear sampler": {"sampler": {"type": "filtering"}},
    "depth array": {"texture": {"sample_type": "depth", "view_dimension": "2d-array"}},
}


@dataclass(frozen=True)
class BindGroup:
    """A `wgpu.GPUBindGroup` and its layout."""

    group: Any
    layout: Any


def bind_group(gpu: Gpu, resources: Mapping[int, tuple[str, Any]], label: str = "") -> BindGroup:
    """A group of binding → (kind, texture view or buffer).

    Kinds: ``uniform``, ``storage`` (read-only), ``float``, ``float array``, ``uint``, ``uint
    array``, ``depth``, ``depth array``, ``sampler``; floats are read by `textureLoad`, unfiltered.
    ``smooth`` are half floats that a ``linear sampler`` interpolates. Seen by both shader stages.
    """
    import wgpu

    visibility = wgpu.ShaderStage.VERTEX | wgpu.ShaderStage.FRAGMENT
    layout = gpu.device.create_bind_group_layout(
        label=label,
        entries=[
            {"binding": binding, "visibility": visibility, **_ENTRIES[kind]}
            for binding, (kind, _) in resources.items()
        ],
    )
    entries: list[dict[str, Any]] = []
    for binding, (kind, resource) in resources.items():
        if kind in ("uniform", "storage"):
            resource = {"buffer": resource, "offset": 0, "size": resource.size}
        entries.append({"binding": binding, "resource": resource})
    group = gpu.device.create_bind_group(label=label, layout=layout, entries=entries)
    return BindGroup(group, layout)
