"""Sample points and edges of area lamps, as the shaders read them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.gpu.device import Gpu
from andon.gpu.textures import write_buffer
from andon.lamps import Lamp
from andon.lamps.areas import AreaLamp, MeshLamp, PolygonLamp
from andon.lamps.edges import lamp_edges
from andon.transport.direct.records import EDGE_RECORD, SAMPLE_RECORD
from andon.transport.direct.soft import sample_points

__all__ = ["AreaBuffers"]


class AreaBuffers:
    """Records of all area lamps; sizes are those of the lamps at the start.

    Attributes
    ----------
    edges : lamp name → first and count of its edges.
    """

    def __init__(self, gpu: Gpu, lamps: Sequence[Lamp]) -> None:
        self.gpu = gpu
        self.edges: dict[str, tuple[int, int]] = {}
        first = 0
        for lamp in lamps:
            if isinstance(lamp, PolygonLamp | MeshLamp):
                count = len(lamp_edges(lamp).a)
                self.edges[lamp.name] = (first, count)
                first += count
        samples, edges = _sample_records(lamps), _edge_records(lamps)
        self.samples_buffer = self._buffer(max(1, len(samples)) * SAMPLE_RECORD.dtype.itemsize)
        self.edges_buffer = self._buffer(max(1, len(edges)) * EDGE_RECORD.dtype.itemsize)

    def _buffer(self, size_bytes: int) -> Any:
        import wgpu

        usage = wgpu.BufferUsage.STORAGE | wgpu.BufferUsage.COPY_DST
        return self.gpu.device.create_buffer(size=size_bytes, usage=usage)

    def update(self, lamps: Sequence[Lamp]) -> None:
        """Takes the lamps of a moment."""
        for buffer, records in (
            (self.samples_buffer, _sample_records(lamps)),
            (self.edges_buffer, _edge_records(lamps)),
        ):
            if len(records):
                write_buffer(self.gpu, buffer, records)


def _sample_records(lamps: Sequence[Lamp]) -> NDArray[Any]:
    soft = [x for x in lamps if isinstance(x, AreaLamp)]
    found = [sample_points(x, x.shadow.samples) for x in soft if x.shadow is not None]
    records = np.zeros(sum(len(samples.points) for samples in found), SAMPLE_RECORD.dtype)
    first = 0
    for samples in found:
        rows = records[first : first + len(samples.points)]
        rows["point"], rows["normal"] = samples.points, samples.normals
        rows["light"], rows["sides"] = samples.light, samples.sides
        first += len(samples.points)
    return records


def _edge_records(lamps: Sequence[Lamp]) -> NDArray[Any]:
    found = [lamp_edges(x) for x in lamps if isinstance(x, PolygonLamp | MeshLamp)]
    records = np.zeros(sum(len(edges.a) for edges in found), EDGE_RECORD.dtype)
    first = 0
    for edges in found:
        rows = records[first : first + len(edges.a)]
        rows["start"], rows["end"] = edges.a, edges.b
        rows["left_plane"], rows["right_plane"] = edges.left_plane, edges.right_plane
        rows["left_light"] = edges.left_luminance_cd_m2
        rows["right_light"] = edges.right_luminance_cd_m2
        first += len(edges.a)
    return records
