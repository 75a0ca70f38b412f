"""An object that moves, on the GPU: vertices that are written anew when they moved."""

from __future__ import annotations

from andon.gbuffer import VERTEX
from andon.gpu.device import Gpu
from andon.gpu.textures import write_buffer
from andon.quantities import Geometry
from andon.rays import face_normals
from andon.surface.vertices import corner_numbers, vertex_arrays

__all__ = ["MoverMesh"]


class MoverMesh:
    """Vertices of one object.

    Attributes
    ----------
    vertices, indices : buffers of `VERTEX` and uint32.
    count : indices.
    """

    def __init__(self, gpu: Gpu, geometry: Geometry) -> None:
        import wgpu

        self.gpu = gpu
        self._stored, indices = vertex_arrays(geometry)
        self._corner = corner_numbers(geometry)
        self.count = indices.size
        usage = wgpu.BufferUsage
        self.vertices = gpu.device.create_buffer(
            size=self._stored.size * VERTEX.itemsize, usage=usage.VERTEX | usage.COPY_DST
        )
        self.indices = gpu.device.create_buffer_with_data(data=indices, usage=usage.INDEX)
        self._shown: Geometry | None = None

    def move(self, geometry: Geometry, /) -> None:
        """Takes the object as it is now: the same triangles, materials and texture coordinates."""
        if geometry is self._shown:
            return
        self._stored["position"] = geometry.positions[self._corner]
        if geometry.normals is not None:
            self._stored["normal"] = geometry.normals[self._corner]
        else:
            self._stored["normal"] = face_normals(geometry).repeat(3, axis=0)
        write_buffer(self.gpu, self.vertices, self._stored)
        self._shown = geometry
