"""Textures and buffers: made once, filled and read back in whole pictures."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import MachineError
from andon.gpu.device import Gpu

__all__ = ["HALF_MOST", "Texture", "make_texture", "uniform_buffer", "write_buffer"]

# The largest half float.
HALF_MOST = 65504.0
# WebGPU copies rows at multiples of this many bytes (WebGPU specification, 3.6.2).
ROW_ALIGNMENT = 256

# format: (NumPy dtype, channels)
_FORMATS: dict[str, tuple[str, int]] = {
    "rgba8unorm": ("<u1", 4),
    "rgba16float": ("<f2", 4),
    "rgba32float": ("<f4", 4),
    "rgba32uint": ("<u4", 4),
    "r32float": ("<f4", 1),
    "r32uint": ("<u4", 1),
    "rg32float": ("<f4", 2),
    "rg16float": ("<f2", 2),
    "depth32float": ("<f4", 1),
}


@dataclass(frozen=True)
class Texture:
    """A 2-D texture or an array of them.

    Attributes
    ----------
    gpu : where it lives.
    handle : `wgpu.GPUTexture`.
    view : of all layers, for binding (2d-array where `layers` was given).
    """

    gpu: Gpu
    handle: Any
    view: Any
    format: str
    width: int
    height: int
    layers: int | None = None

    def layer_view(self, layer: int) -> Any:
        """View of one layer, for rendering into."""
        return self.handle.create_view(dimension="2d", base_array_layer=layer, array_layer_count=1)

    def write(self, values: NDArray[Any], layer: int = 0) -> None:
        """Fills a layer with `values` (H, W, channels) or (H, W); cast to the texture's type."""
        self.write_rows(values.reshape(self.height, self.width, -1), 0, layer)

    def write_rows(self, values: NDArray[Any], first: int, layer: int = 0) -> None:
        """Fills rows from `first` on with `values` (rows, W, channels)."""
        data = np.ascontiguousarray(values, _FORMATS[self.format][0])
        self.gpu.device.queue.write_texture(
            {"texture": self.handle, "origin": (0, first, layer)},
            data,
            {"bytes_per_row": data.strides[0], "rows_per_image": len(data)},
            (self.width, len(data), 1),
        )

    def read(self, layer: int = 0) -> NDArray[Any]:
        """The layer's values (H, W, channels); waits for the device."""
        dtype, channels = _FORMATS[self.format]
        row = self.width * channels * np.dtype(dtype).itemsize
        padded = -(-row // ROW_ALIGNMENT) * ROW_ALIGNMENT
        data = self.gpu.device.queue.read_texture(
            {"texture": self.handle, "origin": (0, 0, layer)},
            {"bytes_per_row": padded, "rows_per_image": self.height},
            (self.width, self.height, 1),
        )
        rows = np.frombuffer(data, np.uint8).reshape(self.height, -1)[:, :row]
        return np.ascontiguousarray(rows).view(dtype).reshape(self.height, self.width, channels)


def make_texture(
    gpu: Gpu, format: str, width: int, height: int, *, layers: int | None = None, label: str = ""
) -> Texture:
    """A texture that can be rendered into, bound, filled and read."""
    import wgpu

    limit = gpu.device.limits["max-texture-dimension-2d"]
    if max(width, height) > limit:
        raise MachineError(
            f"a {width}×{height} picture exceeds the adapter's {limit} px",
            remedy="use a smaller picture or --engine reference",
        )
    usage = wgpu.TextureUsage
    handle = gpu.device.create_texture(
        label=label,
        size=(width, height, layers or 1),
        format=format,
        usage=usage.RENDER_ATTACHMENT
        | usage.TEXTURE_BINDING
        | usage.COPY_SRC
        | (0 if format.startswith("depth") else usage.COPY_DST),
    )
    view = handle.create_view(dimension="2d" if layers is None else "2d-array")
    return Texture(gpu, handle, view, format, width, height, layers)


def uniform_buffer(gpu: Gpu, size_bytes: int, label: str = "") -> Any:
    """A buffer for host structs, to be filled by `write_buffer`."""
    import wgpu

    return gpu.device.create_buffer(
        label=label, size=size_bytes, usage=wgpu.BufferUsage.UNIFORM | wgpu.BufferUsage.COPY_DST
    )


def write_buffer(gpu: Gpu, buffer: Any, values: NDArray[Any]) -> None:
    """Fills the start of `buffer` with the bytes of `values`."""
    gpu.device.queue.write_buffer(buffer, 0, np.ascontiguousarray(values).view(np.uint8))
