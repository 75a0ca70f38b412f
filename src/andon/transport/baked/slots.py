"""Room on the GPU for the maps of one moment."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.gpu.bindings import bind_group
from andon.gpu.device import Gpu
from andon.gpu.passes import FullscreenPass
from andon.gpu.textures import Texture, make_texture, uniform_buffer, write_buffer
from andon.transport.baked.atlas import Atlas
from andon.transport.baked.model import BakedMoment
from andon.transport.baked.records import (
    BAKED_MAP,
    MAX_LAMPS,
    pack_map,
    pack_pages,
    pack_shares,
)

__all__ = ["MIX", "Slot"]

MIX = "andon/transport/baked/mix.wgsl"


class Slot:
    """The maps of one moment at a time: their lamps apart, and mixed into the layers of a texture.

    Attributes
    ----------
    moment : number of the moment that it holds; None: none.
    records : (maps,) `BAKED_MAP`, their cameras.
    scale : lux of a unit of the mixed texels.
    """

    def __init__(
        self,
        gpu: Gpu,
        atlas: Atlas,
        lamps: Sequence[str],
        texels: Texture,
        first_layer: int,
        variants: Mapping[str, str],
    ) -> None:
        self.gpu, self.atlas, self.lamps, self.first_layer = gpu, atlas, lamps, first_layer
        self.moment: int | None = None
        self.records: NDArray[Any] = np.zeros(0, BAKED_MAP.dtype)
        self.scale = 1.0
        self._most_lux: NDArray[np.float64] = np.zeros(len(lamps))
        self._mixed: Mapping[str, float] | None = None
        self._shares = uniform_buffer(gpu, 4 * MAX_LAMPS, "baked shares")
        size, layers = (atlas.width, atlas.height), max(len(lamps), 1)
        pages = range(atlas.pages)
        self._surfaces = [make_texture(gpu, "rgba32uint", *size, label="baked") for _ in pages]
        self._lamps = [
            make_texture(gpu, "rgba16float", *size, layers=layers, label="baked lamps")
            for _ in pages
        ]
        self._layers = [texels.layer_view(first_layer + page) for page in pages]
        self._passes = [self._pass(page, variants) for page in pages]

    def _pass(self, page: int, variants: Mapping[str, str]) -> FullscreenPass:
        resources = {
            0: ("uint", self._surfaces[page].view),
            1: ("float array", self._lamps[page].view),
            2: ("uniform", self._shares),
        }
        group = bind_group(self.gpu, resources, "baked mix")
        return FullscreenPass(
            self.gpu, MIX, "baked_mix", ["rgba32uint"], [group], variants=variants
        )

    def fill(self, number: int, moment: BakedMoment, depth_tolerance_m: float) -> None:
        """Puts a moment's maps here, in the places of the atlas."""
        pages = pack_pages(moment.maps, self.atlas, self.lamps, depth_tolerance_m)
        for page, surface in enumerate(self._surfaces):
            surface.write(pages.surface[page])
            for lamp in range(len(self.lamps)):
                self._lamps[page].write(pages.lamps[page, lamp], lamp)
        placed = zip(moment.maps, self.atlas.places, strict=True)
        records = [pack_map(seen.view, place, self.first_layer) for seen, place in placed]
        self.records = np.concatenate([self.records[:0], *records])
        self.moment, self._mixed, self._most_lux = number, None, pages.most_lux

    def mix(self, encoder: Any, shares: Mapping[str, float]) -> bool:
        """Adds the lamps up, if their shares are not those of the last time; whether it did."""
        if self._mixed == dict(shares):
            return False
        packed, self.scale = pack_shares(self.lamps, self._most_lux, shares)
        write_buffer(self.gpu, self._shares, packed)
        for layer, mixing in zip(self._layers, self._passes, strict=True):
            mixing.encode(encoder, [layer])
        self._mixed = dict(shares)
        return True
