"""Backdrops on the GPU: the atlas, and the records of a scene."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from numpy.typing import NDArray

from andon.glass.backdrops.atlas import make_atlas
from andon.glass.backdrops.levels import FORMAT, FrameLevels, Levels
from andon.glass.backdrops.records import (
    BACKDROP_RECORD,
    ENVIRONMENT_RECORD,
    pack_backdrops,
    pack_environments,
)
from andon.glass.model import MAX_SOLIDS, Solid
from andon.gpu.bindings import BindGroup, bind_group
from andon.gpu.device import Gpu
from andon.gpu.textures import Texture, make_texture, uniform_buffer, write_buffer

__all__ = ["BackdropBuffers", "FrameLevels"]


class BackdropBuffers:
    """What all views of a scene share; `notes` name pictures that were made smaller.

    `blurs`: pictures can be blurred as the paper does it (`encode_blur`).
    """

    def __init__(
        self,
        gpu: Gpu,
        solids: Sequence[Solid],
        environment: NDArray[Any],
        luminance_per_unit: float,
        dimming: tuple[float, float, float] = (1.0, 1.0, 1.0),
        *,
        blurs: bool = False,
    ) -> None:
        self.gpu, self._solids, self._unit = gpu, tuple(solids), luminance_per_unit
        self._atlas = make_atlas(solids, gpu.device.limits["max-texture-dimension-2d"])
        self.notes = self._atlas.notes
        height, width = self._atlas.texels.shape[:2]
        self.atlas = make_texture(gpu, FORMAT, width, height, label="backdrops")
        self.atlas.write(self._atlas.texels)
        self._blurs = self._blurring(solids) if blurs else {}
        size = MAX_SOLIDS * BACKDROP_RECORD.dtype.itemsize
        self._records = uniform_buffer(gpu, size, "backdrops")
        size = MAX_SOLIDS * ENVIRONMENT_RECORD.dtype.itemsize
        self._environments = uniform_buffer(gpu, size, "environments")
        self.write_solids(solids, dimming)
        self.write_environment(environment)

    def write_solids(
        self, solids: Sequence[Solid], dimming: tuple[float, float, float] = (1.0, 1.0, 1.0)
    ) -> None:
        """Other places of the same backdrops, other light on them."""
        write_buffer(self.gpu, self._records, pack_backdrops(solids, self._atlas, dimming))

    def write_environment(self, environment: NDArray[Any]) -> None:
        """(n, 9, 3) harmonics in cd/m², of each body."""
        write_buffer(self.gpu, self._environments, pack_environments(environment, self._unit))

    def _blurring(self, solids: Sequence[Solid]) -> dict[int, Levels]:
        """Of each body whose backdrop is a picture, that picture's levels, to be blurred."""
        sharp = make_texture(self.gpu, FORMAT, self.atlas.width, self.atlas.height, label="sharp")
        sharp.write(self._atlas.texels)
        return {
            index: Levels(self.gpu, sharp, (at.column, at.row), self.atlas, at, blurs=True)
            for index, at in enumerate(self._atlas.backdrops)
            if solids[index].backdrop.picture is not None
        }

    def encode_blur(self, encoder: Any, solid: int, kernel_texels: float) -> None:
        """Records the paper's blur, K_g in texels, of the picture behind a body: when it changes.

        `kernel_texels` is that of the picture as it was given. Needs `blurs`.
        """
        given = self._solids[solid].backdrop.picture
        if given is not None:
            share = self._atlas.backdrops[solid].width / given.shape[1]
            self._blurs[solid].encode(encoder, kernel_texels * share)

    def group(self, levels: Texture) -> BindGroup:
        """Group 1 of a view, given the `levels` of its frame."""
        resources: dict[int, tuple[str, Any]] = {
            0: ("float", self.atlas.view),
            1: ("uniform", self._records),
            2: ("float", levels.view),
            3: ("uniform", self._environments),
        }
        return bind_group(self.gpu, resources, "backdrops")
