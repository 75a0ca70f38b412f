"""Baked light on the GPU: the maps of the moments in use, and a picture of their light in a view.

One pass over a frame loops over its maps. A pass for each map, adding up by blending, would read
the G-buffer and write the sum once for each, and adding up needs more digits than the formats
have that every adapter blends. The picture is kept: camera, maps and shares that stand still cost
nothing.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon import gbuffer
from andon.errors import InputError, MachineError
from andon.gpu.bindings import BindGroup, bind_group
from andon.gpu.device import Gpu
from andon.gpu.passes import FullscreenPass
from andon.gpu.textures import Texture, make_texture, uniform_buffer, write_buffer
from andon.spaces import View
from andon.transport.baked.atlas import atlas_of
from andon.transport.baked.model import BakedLight, BakedMoment
from andon.transport.baked.records import (
    BAKED_MAP,
    BAKED_SETTINGS,
    MAX_LAMPS,
    MAX_MAPS,
    STRUCTS,
    pack_map,
    pack_pages,
    pack_shares,
    settings_text,
)

__all__ = ["BAKED_PICTURE", "SETTINGS", "BakedBuffers", "BakedPicture"]

_FOLDER = "andon/transport/baked"
BAKED_PICTURE, MIX = f"{_FOLDER}/picture.wgsl", f"{_FOLDER}/mix.wgsl"
SETTINGS = f"{_FOLDER}/settings.wgsl"
_CLAIM = "the maps of all moments must have the same sizes, projections and lamps"


class _Slot:
    """Room for the maps of one moment: texels and lamps of every page, and what is in them."""

    def __init__(self, gpu: Gpu, size: tuple[int, int, int], lamps: int) -> None:
        pages, height, width = size
        self.moment: int | None = None
        self.mixed: Mapping[str, float] | None = None
        self.most_lux: NDArray[np.float64] = np.zeros(lamps)
        self.scale = 1.0
        self.shares = uniform_buffer(gpu, 4 * MAX_LAMPS, "baked shares")
        self.surfaces = [
            make_texture(gpu, "rgba32uint", width, height, label="baked surface")
            for _ in range(pages)
        ]
        self.lamps = [
            make_texture(
                gpu, "rgba16float", width, height, layers=max(lamps, 1), label="baked lamps"
            )
            for _ in range(pages)
        ]

    def groups(self, gpu: Gpu) -> list[BindGroup]:
        """Bind groups of mix.wgsl, one a page."""
        return [
            bind_group(
                gpu,
                {
                    0: ("uint", surface.view),
                    1: ("float array", lamps.view),
                    2: ("uniform", self.shares),
                },
                "baked mix",
            )
            for surface, lamps in zip(self.surfaces, self.lamps, strict=True)
        ]


class BakedBuffers:
    """Baked light on the GPU, shared by all views.

    The maps of at most two moments are there at a time.

    Attributes
    ----------
    resources : bindings 2 to 4 of group 0 of picture.wgsl.
    variants : of picture.wgsl.
    version : counts up when the light changes.
    """

    def __init__(self, gpu: Gpu, light: BakedLight) -> None:
        self.gpu, self.light, self.version = gpu, light, 0
        first = light.load(0)
        self._form = _form(first)
        self.lamps = sorted({*light.parts, *(name for seen in first.maps for name in seen.lux)})
        self._check_counts(first)
        views = [seen.view for seen in first.maps]
        self.atlas = atlas_of(
            [view.shape for view in views], gpu.device.limits["max-texture-dimension-2d"]
        )
        size = self.atlas.pages, self.atlas.height, self.atlas.width
        count = min(2, len(light.moments))
        self._slots = [_Slot(gpu, size, len(self.lamps)) for _ in range(count)]
        self._texels = make_texture(
            gpu, "rgba32uint", size[2], size[1], layers=count * size[0], label="baked texels"
        )
        self._layers = [self._texels.layer_view(layer) for layer in range(count * size[0])]
        self.variants = {SETTINGS: settings_text(views, len(self.lamps), light.mode)}
        groups = [group for slot in self._slots for group in slot.groups(gpu)]
        self._groups = groups
        self._mix = FullscreenPass(
            gpu, MIX, "baked_mix", ["rgba32uint"], groups[:1], variants=self.variants
        )
        self._records = np.zeros(2 * MAX_MAPS, BAKED_MAP.dtype)
        self._maps = uniform_buffer(gpu, self._records.nbytes, "baked maps")
        self._settings = uniform_buffer(gpu, BAKED_SETTINGS.dtype.itemsize, "baked settings")
        self._written = b""
        self.resources: dict[int, tuple[str, Any]] = {
            2: ("uint array", self._texels.view),
            3: ("uniform", self._maps),
            4: ("uniform", self._settings),
        }

    def _check_counts(self, first: BakedMoment) -> None:
        for most, count, what in (
            (MAX_MAPS, len(first.maps), "maps"),
            (MAX_LAMPS, len(self.lamps), "lamps in them"),
        ):
            if count > most:
                raise MachineError(
                    f"{count} baked {what} are more than shaders hold, {most}",
                    remedy="use fewer, or --engine reference",
                )

    def encode(self, encoder: Any, time_seconds: float) -> None:
        """Records what brings the maps to a time; nothing where nothing has changed."""
        earlier, later, share = self.light.around(time_seconds)
        slots = self._slots_of(earlier, later)
        shares = dict(self.light.shares(time_seconds))
        changed = False
        for number in {*slots}:
            changed |= self._mixed(encoder, number, shares)
        first, second = (self._slots[number] for number in slots)
        settings = BAKED_SETTINGS.pack(
            map_count=len(self._form),
            moment_count=1 if earlier == later else 2,
            earlier_slot=slots[0],
            later_slot=slots[1],
            earlier_scale=first.scale,
            later_scale=second.scale,
            later_share=share,
            depth_tolerance_m=self.light.depth_tolerance_m,
        )
        if settings.tobytes() != self._written:
            write_buffer(self.gpu, self._settings, settings)
            self._written, changed = settings.tobytes(), True
        self.version += changed

    def _slots_of(self, earlier: int, later: int) -> tuple[int, int]:
        """The slots that hold two moments, after filling those that do not yet."""
        wanted = (earlier,) if earlier == later else (earlier, later)
        holds = {slot.moment: number for number, slot in enumerate(self._slots)}
        free = [number for number, slot in enumerate(self._slots) if slot.moment not in wanted]
        for moment in wanted:
            if moment not in holds:
                holds[moment] = free.pop(0)
                self._fill(holds[moment], moment)
        return holds[earlier], holds[later]

    def _fill(self, number: int, moment: int) -> None:
        maps, slot = self.light.load(moment).maps, self._slots[number]
        if _form(self.light.load(moment)) != self._form or any(
            name not in self.lamps for seen in maps for name in seen.lux
        ):
            time_seconds = self.light.moments[moment]
            raise InputError(f"{_CLAIM}; those at {time_seconds:g} s differ", field="baked.folder")
        pages = pack_pages(maps, self.atlas, self.lamps, self.light.depth_tolerance_m)
        for page, surface in enumerate(slot.surfaces):
            surface.write(pages.surface[page])
            for lamp in range(len(self.lamps)):
                slot.lamps[page].write(pages.lamps[page, lamp], lamp)
        for index, (seen, place) in enumerate(zip(maps, self.atlas.places, strict=True)):
            record = pack_map(seen.view, place, number * self.atlas.pages)
            self._records[number * MAX_MAPS + index] = record[0]
        write_buffer(self.gpu, self._maps, self._records)
        slot.moment, slot.mixed, slot.most_lux = moment, None, pages.most_lux

    def _mixed(self, encoder: Any, number: int, shares: Mapping[str, float]) -> bool:
        """Adds the lamps of a slot up, if their shares are others than when that was last done."""
        slot, pages = self._slots[number], self.atlas.pages
        if slot.mixed == shares:
            return False
        packed, slot.scale = pack_shares(self.lamps, slot.most_lux, shares)
        write_buffer(self.gpu, slot.shares, packed)
        for layer in range(number * pages, (number + 1) * pages):
            self._mix.encode(encoder, [self._layers[layer]], [self._groups[layer]])
        slot.mixed = shares
        return True


def _form(moment: BakedMoment) -> list[tuple[str, int, int]]:
    """What must be alike in all moments."""
    return [(seen.view.projection, *seen.view.shape) for seen in moment.maps]


class BakedPicture:
    """Reads a G-buffer, writes the baked light on what it shows.

    Attributes
    ----------
    lux : rgba32float; illuminance in lux, and in alpha 1 where a map sees the surface, else 0.
    """

    def __init__(
        self, buffers: BakedBuffers, view: View, gbuffer_view: Any, view_buffer: Any
    ) -> None:
        gpu = buffers.gpu
        self.buffers, self.view = buffers, view
        self.lux: Texture = make_texture(
            gpu, "rgba32float", view.width, view.height, label="baked lux"
        )
        self._drawn: int | None = None
        scene = {0: ("uint", gbuffer_view), 1: ("uniform", view_buffer)}
        self._pass = FullscreenPass(
            gpu,
            BAKED_PICTURE,
            "baked_picture",
            [self.lux.format],
            [bind_group(gpu, scene | buffers.resources, "baked")],
            structs=gbuffer.STRUCTS | STRUCTS,
            variants=gbuffer.projection_variant(view) | buffers.variants,
        )

    def encode(self, encoder: Any, time_seconds: float, *, changed: bool = False) -> bool:
        """Records the drawing at a time, if the light or, as `changed` says, the G-buffer is new.

        Returns whether it is drawn.
        """
        self.buffers.encode(encoder, time_seconds)
        if self._drawn == self.buffers.version and not changed:
            return False
        self._pass.encode(encoder, [self.lux.view])
        self._drawn = self.buffers.version
        return True
