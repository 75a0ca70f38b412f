"""Shadow maps around the sample points of area lamps."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.gpu.device import Gpu
from andon.gpu.textures import make_texture
from andon.lamps import Lamp
from andon.lamps.areas import AreaLamp
from andon.transport.direct.shadows.caster_buffers import CasterBuffers
from andon.transport.direct.shadows.face_maps import FaceMaps
from andon.transport.direct.soft import Samples, sample_points

__all__ = ["SoftMaps"]


class SoftMaps:
    """Paraboloid pairs around all samples of all area lamps, in one texture array.

    Attributes
    ----------
    size : texels along a side, the largest that a lamp asks for.
    filter : ``none`` if all lamps want it, else ``linear``.
    paraboloids : r32float array, two layers a sample.
    firsts : lamp name → number of its first sample; its maps begin at twice that.
    """

    def __init__(self, gpu: Gpu, buffers: CasterBuffers, lamps: Sequence[Lamp]) -> None:
        self.gpu, self.buffers = gpu, buffers
        soft = [x for x in lamps if isinstance(x, AreaLamp) and x.shadow is not None]
        shadows = [lamp.shadow for lamp in soft if lamp.shadow is not None]
        counts = [shadow.samples for shadow in shadows]
        firsts = np.cumsum([0, *counts])
        self.firsts = {lamp.name: int(n) for lamp, n in zip(soft, firsts, strict=False)}
        self.count = int(firsts[-1])
        self.size = max((shadow.map_size for shadow in shadows), default=2)
        self.size += self.size % 2
        self.filter = "linear" if any(x.filter != "none" for x in shadows) else "none"
        _check_layers(gpu, 2 * self.count)
        _check_memory(self.count, self.size)
        layers = max(2, 2 * self.count)
        self.paraboloids = make_texture(
            gpu, "r32float", self.size, self.size, layers=layers, label="soft paraboloids"
        )
        self._faces: FaceMaps | None = None
        if soft:
            views = [self.paraboloids.layer_view(layer) for layer in range(layers)]
            self._faces = FaceMaps(gpu, buffers, views, self.size, slots=1)
        self._drawn: dict[str, tuple[bytes, tuple[int, ...]]] = {}

    def update(self, lamps: Sequence[Lamp]) -> int:
        """Draws the maps that are not true any more, and submits them; returns how many."""
        drawn = 0
        for lamp in lamps:
            if not isinstance(lamp, AreaLamp) or lamp.shadow is None:
                continue
            samples = sample_points(lamp, lamp.shadow.samples)
            through = lamp.shadow.through
            state = (samples.points.tobytes(), self.buffers.casters.version(through))
            if self._drawn.get(lamp.name) != state:
                hiding = self.buffers.casters.hiding(through)
                self._draw(samples, self.firsts[lamp.name], hiding, lamp.shadow.near_m)
                self._drawn[lamp.name] = state
                drawn += len(samples.points)
        return drawn

    def _draw(
        self, samples: Samples, first: int, hiding: NDArray[np.bool_] | None, near_m: float
    ) -> None:
        """One submission a sample: all share the buffers of one slot."""
        assert self._faces is not None
        for number, point in enumerate(samples.points):
            encoder = self.gpu.device.create_command_encoder(label="soft shadow")
            self._faces.encode(encoder, point, 2 * (first + number), hiding, near_m)
            self.gpu.device.queue.submit([encoder.finish()])


def _check_layers(gpu: Gpu, layers: int) -> None:
    limit = gpu.device.limits["max-texture-array-layers"]
    if layers > limit:
        raise InputError(
            f"{layers // 2} samples of area lamps, this adapter holds {limit // 2}",
            field="lamp.shadow_samples",
            remedy="take fewer samples, or shadow = false for some lamps",
        )


# What all soft shadow maps of a frame may take, in bytes.
MOST_BYTES = 2 << 30


def _check_memory(samples: int, size: int) -> None:
    """All maps have the size that the most demanding lamp asks for."""
    total = 2 * samples * size * size * 4
    if total > MOST_BYTES:
        raise InputError(
            f"{samples} samples of area lamps with maps of {size}² texels take "
            f"{total / 2**30:.1f} GB, at most {MOST_BYTES >> 30} are used",
            field="lamp.shadow_map_size",
            remedy="take fewer samples or smaller maps",
        )
