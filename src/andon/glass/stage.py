"""Tracing on the GPU: a view and its solids → the sharp layers of glass, and their blurs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon import gbuffer
from andon.glass.backdrops.records import STRUCTS as BACKDROP_STRUCTS
from andon.glass.backdrops.records import backdrop_variants
from andon.glass.bvh import hierarchy, packed
from andon.glass.model import MAX_HIGHLIGHTS, MAX_SOLIDS, Closed, Highlight, Solid
from andon.glass.outline import Outline, OutlinePass
from andon.glass.plan import variants_of
from andon.glass.records import GLASS_RECORD, STRUCTS, pack_highlights, pack_solids
from andon.glass.screen import Rectangle, rectangle_of
from andon.gpu.bindings import BindGroup, bind_group
from andon.gpu.device import Gpu
from andon.gpu.textures import Texture, make_texture, uniform_buffer, write_buffer
from andon.spaces import View

__all__ = ["SolidBuffers", "TraceStage"]

LAYER, SURFACE = "rgba16float", "rgba32uint"


class SolidBuffers:
    """What all views of a scene share: the solids, their meshes, the lamps they mirror."""

    def __init__(self, gpu: Gpu, solids: Sequence[Solid]) -> None:
        self.gpu = gpu
        shapes = [solid.shape for solid in solids]
        self._places = packed([hierarchy(s.geometry) for s in shapes if isinstance(s, Closed)])
        self._nodes = self._texture(self._places.nodes, "nodes")
        self._triangles = self._texture(self._places.triangles, "triangles")
        self._solids = uniform_buffer(
            gpu, MAX_SOLIDS * STRUCTS["SolidRecord"].dtype.itemsize, "solids"
        )
        size = MAX_HIGHLIGHTS * STRUCTS["HighlightRecord"].dtype.itemsize
        self._highlights = uniform_buffer(gpu, size, "highlights")
        self.highlights = 0
        self.write_solids(solids)
        self.write_highlights(())

    def _texture(self, texels: NDArray[np.float32], label: str) -> Texture:
        height, width = texels.shape[:2]
        texture = make_texture(self.gpu, "rgba32float", width, height, label=label)
        texture.write(texels)
        return texture

    def write_solids(self, solids: Sequence[Solid]) -> None:
        """Other places, indices and absorptions of the same shapes."""
        self.solids = tuple(solids)
        write_buffer(self.gpu, self._solids, pack_solids(solids, meshes=self._places))

    def write_highlights(self, highlights: Sequence[Highlight]) -> None:
        """Lamps that glass mirrors, at most MAX_HIGHLIGHTS."""
        self.highlights = len(highlights)
        write_buffer(self.gpu, self._highlights, pack_highlights(highlights))

    @property
    def resources(self) -> dict[int, tuple[str, Any]]:
        """Bindings 2, 4, 5 and 6 of group 0 of glass.wgsl."""
        return {
            2: ("uniform", self._solids),
            4: ("uniform", self._highlights),
            5: ("float", self._nodes.view),
            6: ("float", self._triangles.view),
        }


class TraceStage:
    """Draws the layers of one view's glass.

    Attributes
    ----------
    refracted, surface, reflected, sizes : textures (H, W) rgba16float, see glass.wgsl.
    stickers : (H, W) rgba32uint, a G-buffer of what sticks to the glass; None if nothing does.
    within : (x, y, width, height) in pixels, what is drawn; the rest is 0. None: no glass is seen.
    """

    def __init__(
        self,
        gpu: Gpu,
        view: View,
        solids: SolidBuffers,
        surface: tuple[Any, Any],
        backdrops: BindGroup,
        *,
        largest_px: float,
    ) -> None:
        """`surface`: view of the packed G-buffer's texture, and buffer of its `VIEW_RECORD`."""
        self.gpu, self.view, self._shared = gpu, view, solids
        self._largest_px = largest_px
        size = (view.width, view.height)
        names = ("refracted", "surface", "reflected", "sizes")
        self._layers = [make_texture(gpu, LAYER, *size, label=name) for name in names]
        self.refracted, self.surface, self.reflected, self.sizes = self._layers
        self._record = uniform_buffer(gpu, GLASS_RECORD.dtype.itemsize, "glass")
        resources: dict[int, tuple[str, Any]] = {
            0: ("uint", surface[0]),
            1: ("uniform", surface[1]),
            3: ("uniform", self._record),
        }
        groups = [bind_group(gpu, resources | solids.resources, "glass"), backdrops]
        options: dict[str, Any] = {
            "structs": gbuffer.STRUCTS | STRUCTS | BACKDROP_STRUCTS,
            "variants": gbuffer.projection_variant(view)
            | variants_of(solids.solids)
            | backdrop_variants(solids.solids, view.projection),
        }
        self._outline = Outline(gpu, view)
        self._trace = OutlinePass(gpu, "layers", [LAYER] * 4, groups, options)
        self.stickers: Texture | None = None
        if any(solid.sticker is not None for solid in solids.solids):
            self.stickers = make_texture(gpu, SURFACE, *size, label="stickers")
            self._stick = OutlinePass(gpu, "stickers", [SURFACE], groups, options)

    @property
    def within(self) -> Rectangle | None:
        """See the class."""
        return rectangle_of(self._shared.solids, self.view)

    def focus(
        self,
        focus_dioptres: float,
        pupil_m: float,
        luminance_per_unit: float,
        *,
        apparent: bool = True,
    ) -> None:
        """What the eye is focused on, and the unit of the picture in cd/m².

        `pupil_m` 0: nothing is blurred. `apparent`: a layer is as far away as it appears; else as
        far as where its light comes from, as in the paper.
        """
        record = GLASS_RECORD.pack(
            focus_dioptres=focus_dioptres,
            pupil_m=pupil_m,
            largest_px=self._largest_px,
            units_per_cd_m2=1 / luminance_per_unit,
            highlights=self._shared.highlights,
            apparent=apparent,
        )
        write_buffer(self.gpu, self._record, record)

    def encode(self, encoder: Any) -> None:
        """Records the layers."""
        self._outline.move(self._shared.solids)
        self._trace.encode(encoder, self._layers, self._outline)

    def encode_stickers(self, encoder: Any) -> None:
        """Records the G-buffer of what sticks to the glass, where something does."""
        if self.stickers is not None:
            self._outline.move(self._shared.solids)
            self._stick.encode(encoder, [self.stickers], self._outline)
