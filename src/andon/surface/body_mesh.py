"""A luminous body on the GPU: it moves, and every vertex has a light of its own."""

from __future__ import annotations

import numpy as np

from andon.gbuffer import BODY_LIGHT, VERTEX
from andon.gpu.device import Gpu
from andon.gpu.textures import write_buffer
from andon.lamps.bodies import Body
from andon.surface.vertices import corner_numbers, vertex_arrays

__all__ = ["BodyMesh"]


class BodyMesh:
    """Vertices of one body, written anew when it moves.

    Attributes
    ----------
    number : which body, from 0.
    vertices, light, indices : buffers of `VERTEX`, `BODY_LIGHT` and uint32.
    count : indices.
    positions : (n, 3) metres, where its vertices are now.
    """

    def __init__(self, gpu: Gpu, body: Body, number: int) -> None:
        import wgpu

        self.gpu, self.number = gpu, number
        vertices, indices = vertex_arrays(body.geometry)
        self.count = indices.size
        usage = wgpu.BufferUsage
        writable = usage.VERTEX | usage.COPY_DST
        device = gpu.device
        self.vertices = device.create_buffer(size=vertices.size * VERTEX.itemsize, usage=writable)
        self.light = device.create_buffer(size=vertices.size * BODY_LIGHT.itemsize, usage=writable)
        self.indices = device.create_buffer_with_data(data=indices, usage=usage.INDEX)
        self._shown: Body | None = None
        self.positions = body.geometry.positions

    def move(self, body: Body) -> None:
        """Takes the body as it is now: the same triangles."""
        if body is self._shown:
            return
        vertices, _ = vertex_arrays(body.geometry)
        corner = corner_numbers(body.geometry)
        light = np.zeros(len(corner), BODY_LIGHT)
        light["outside"] = body.outside_cd_m2[corner]
        light["inside"] = body.inside_cd_m2[corner]
        write_buffer(self.gpu, self.vertices, vertices)
        write_buffer(self.gpu, self.light, light)
        self._shown = body
        self.positions = body.geometry.positions
