"""Triangles that cast shadows, on the GPU and as planes."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from andon.gpu.device import Gpu
from andon.gpu.textures import write_buffer
from andon.transport.direct.casters import Casters

__all__ = ["CasterBuffers", "TrianglePlanes"]

# A depth map without casters would have an empty bounding sphere.
EMPTY_RADIUS_M = 1.0


class CasterBuffers:
    """The casters of one moment; bodies may move, triangles stay the same.

    Attributes
    ----------
    casters : where they are now.
    positions, triangles : (n, 3) float32 metres and (m, 3) int32.
    vertices, indices : the same as buffers.
    """

    def __init__(self, gpu: Gpu, casters: Casters) -> None:
        import wgpu

        self.gpu, self.casters = gpu, casters
        geometry = casters.geometry
        self.positions = np.ascontiguousarray(geometry.positions, np.float32)
        self.triangles = np.ascontiguousarray(geometry.triangles, np.int32)
        usage = wgpu.BufferUsage
        self.vertices = gpu.device.create_buffer(
            size=max(12, self.positions.nbytes),
            usage=usage.VERTEX | usage.STORAGE | usage.COPY_DST,
        )
        indices = self.triangles if len(self.triangles) else np.zeros((1, 3), np.int32)
        self.indices = gpu.device.create_buffer_with_data(data=indices, usage=usage.INDEX)
        self._upload()

    def _upload(self) -> None:
        if len(self.positions):
            write_buffer(self.gpu, self.vertices, self.positions)

    def move(self, casters: Casters, /) -> None:
        """Takes the casters of another moment: the same triangles, elsewhere."""
        moved = casters.version(()) != self.casters.version(())
        self.casters = casters
        if moved:
            self.positions = np.ascontiguousarray(casters.geometry.positions, np.float32)
            self.__dict__.pop("planes", None)
            self.__dict__.pop("bounds", None)
            self._upload()

    @cached_property
    def planes(self) -> TrianglePlanes:
        """Planes of the triangles where they are now."""
        return TrianglePlanes(self.positions, self.triangles)

    @cached_property
    def bounds(self) -> tuple[NDArray[np.float64], float]:
        """Centre (3,) and radius in metres of a ball around all casters."""
        if not len(self.positions):
            return np.zeros(3), EMPTY_RADIUS_M
        centre = 0.5 * (self.positions.min(axis=0) + self.positions.max(axis=0))
        radius = float(np.linalg.norm(self.positions - centre, axis=1).max())
        return centre.astype(np.float64), radius + 1e-3


class TrianglePlanes:
    """Planes of triangles as any lamp has them; normals are made once."""

    def __init__(self, positions: NDArray[np.float32], triangles: NDArray[np.int32]) -> None:
        self._corners: NDArray[np.float64] = positions.astype(np.float64)[triangles]
        a, b, c = (self._corners[:, i] for i in range(3))
        self._normal: NDArray[np.float64] = np.cross(b - a, c - a)
        self._offset: NDArray[np.float64] = np.einsum("ij,ij->i", self._normal, a)
        self._tiny = 1e-12 * np.linalg.norm(self._normal, axis=1) + 1e-300

    def seen_from(self, lamp: NDArray[np.float64], /) -> NDArray[np.float32]:
        """(m, 4): q in xyz with q·(P − lamp) = 1 for the points P of each triangle's plane; its
        number plus one in w.

        q = n/(n·(a − lamp)); along a unit direction d the plane is 1/(q·d) away. Large where the
        lamp lies in the plane, which then is seen edge-on.
        """
        distance: NDArray[np.float64] = self._offset - self._normal @ lamp
        distance = np.where(np.abs(distance) < self._tiny, self._tiny, distance)
        planes = np.zeros((len(distance), 4), np.float32)
        planes[:, :3] = np.clip(self._normal / distance[:, None], -1e30, 1e30)
        planes[:, 3] = np.arange(1, len(planes) + 1)
        return planes

    def edges_from(self, lamp: NDArray[np.float64], /) -> list[NDArray[np.float32]]:
        """Three (m, 4): unit normals, inwards, of the planes through the lamp and each edge."""
        corners = self._corners - lamp
        side = np.sign(np.asarray(self._offset - self._normal @ lamp, np.float64))
        edges: list[NDArray[np.float32]] = []
        for first, second in ((0, 1), (1, 2), (2, 0)):
            normal = np.cross(corners[:, first], corners[:, second]) * side[:, None]
            length = np.linalg.norm(normal, axis=1, keepdims=True)
            unit = np.divide(normal, length, out=np.zeros_like(normal), where=length > 0)
            edges.append(np.pad(unit, ((0, 0), (0, 1))).astype(np.float32))
        return edges
