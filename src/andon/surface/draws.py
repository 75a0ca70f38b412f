"""Triangles as the rasteriser draws them: buffers, materials and textures of one geometry."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from andon.gpu.bindings import BindGroup
from andon.gpu.device import Gpu
from andon.gpu.textures import Texture, make_texture, uniform_buffer, write_buffer
from andon.quantities import Geometry
from andon.surface.textures import TEXTURE_SIDE_PX
from andon.surface.vertices import is_flat, vertex_arrays

__all__ = ["Draw", "Mesh", "storage_buffer"]


class Mesh(Protocol):
    """Buffers of triangles that somebody else keeps current.

    Attributes
    ----------
    vertices, indices : buffers of `VERTEX` and uint32.
    count : indices.
    """

    vertices: Any
    indices: Any
    count: int


class Draw:
    """Buffers of one geometry.

    Parameters
    ----------
    bind : makes group 0 of raster.wgsl of flags, materials, textures and background.
    flags : of the G-buffer.
    mesh : its triangles, where they move.
    first_slot : added to the numbers of its materials.
    bends : triangles that have one normal now may have three later.
    """

    def __init__(
        self,
        gpu: Gpu,
        bind: Callable[[Any, Any, Texture, Texture], BindGroup],
        geometry: Geometry,
        flags: int,
        *,
        mesh: Mesh | None = None,
        first_slot: int = 0,
        bends: bool = False,
    ) -> None:
        import wgpu

        bends = bends and geometry.normals is not None
        self.entry_point = "flat_surface" if is_flat(geometry) and not bends else "surface"
        device, usage = gpu.device, wgpu.BufferUsage
        if mesh is None:
            vertices, indices = vertex_arrays(geometry)
            self.count = indices.size
            self.vertices = device.create_buffer_with_data(data=vertices, usage=usage.VERTEX)
            self.indices = device.create_buffer_with_data(data=indices, usage=usage.INDEX)
        else:
            self.count, self.vertices, self.indices = mesh.count, mesh.vertices, mesh.indices
        flag_buffer = uniform_buffer(gpu, 16, "draw flags")
        write_buffer(gpu, flag_buffer, np.array([flags, first_slot, 0, 0], np.uint32))
        table, textures = _material_table(gpu, geometry)
        nothing = make_texture(gpu, "rgba32uint", 1, 1)
        self.group = bind(flag_buffer, storage_buffer(gpu, table), textures, nothing)

    def encode(self, render: Any) -> None:
        """Records it into a render pass."""
        render.set_bind_group(0, self.group.group)
        render.set_vertex_buffer(0, self.vertices)
        render.set_index_buffer(self.indices, "uint32")
        render.draw_indexed(self.count)


def storage_buffer(gpu: Gpu, data: NDArray[Any], /) -> Any:
    """A buffer of `data` that shaders read."""
    import wgpu

    return gpu.device.create_buffer_with_data(data=data, usage=wgpu.BufferUsage.STORAGE)


def _material_table(gpu: Gpu, geometry: Geometry) -> tuple[NDArray[np.float32], Texture]:
    textured = [m for m in geometry.materials if m.texture is not None]
    side = TEXTURE_SIDE_PX if textured else 1
    # Half floats hold linear light to 0.05 %; 8 bits would band in the darks.
    stack = make_texture(gpu, "rgba16float", side, side, layers=max(1, len(textured)))
    table = np.full((len(geometry.materials), 4), -1.0, np.float32)
    layer = 0
    for row, material in zip(table, geometry.materials, strict=True):
        row[:3] = material.reflectance
        if material.texture is not None and geometry.uvs is not None:
            stack.write(np.dstack([material.texture, np.ones((side, side))]), layer)
            row[3] = layer
            layer += 1
    return table, stack
