"""Baked light on the GPU: the maps of the moments in use, and a picture of their light in a view.

One pass over a frame reads all maps. A pass for each map, adding up by blending, would read the
G-buffer and write the sum once for each, and adding up needs more digits than those formats have
that every adapter blends. The picture is kept: camera, maps and shares that stand still cost
nothing.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from andon import gbuffer
from andon.errors import InputError, MachineError
from andon.gpu.bindings import bind_group
from andon.gpu.device import Gpu
from andon.gpu.passes import FullscreenPass
from andon.gpu.textures import make_texture, uniform_buffer, write_buffer
from andon.spaces import View
from andon.transport.baked.atlas import atlas_of
from andon.transport.baked.model import BakedLight, BakedMoment
from andon.transport.baked.records import (
    BAKED_MAP,
    BAKED_SETTINGS,
    MAX_LAMPS,
    MAX_MAPS,
    STRUCTS,
    check_memory,
    moments_text,
    settings_text,
)
from andon.transport.baked.slots import Slot

__all__ = ["BAKED_PICTURE", "FRAME_VARIANTS", "MOMENTS", "SETTINGS", "BakedBuffers", "BakedPicture"]

_FOLDER = "andon/transport/baked"
BAKED_PICTURE, BAKED_RIMS = f"{_FOLDER}/picture.wgsl", f"{_FOLDER}/rims.wgsl"
# What stands in for none.wgsl in frames: baked light for all that lamps light, and beside probes
# whose light has the same reflections in it.
_TAKEN = {f"{_FOLDER}/none.wgsl": f"{_FOLDER}/picture_light.wgsl"}
FRAME_VARIANTS = {
    "all": _TAKEN,
    "beside probes": _TAKEN | {f"{_FOLDER}/refusing.wgsl": f"{_FOLDER}/refusing_probes.wgsl"},
}
SETTINGS, MOMENTS = f"{_FOLDER}/settings.wgsl", f"{_FOLDER}/moments.wgsl"


class BakedBuffers:
    """Baked light on the GPU, shared by all views.

    The maps of at most two moments are there at a time.

    Attributes
    ----------
    resources : bindings 2 to 4 of group 0 of picture.wgsl.
    variants : of picture.wgsl, when the light is that of one moment, and of two.
    moments : whether it is that of one or two at present.
    version : counts up when the light changes.
    """

    def __init__(self, gpu: Gpu, light: BakedLight) -> None:
        self.gpu, self.light, self.moments, self.version = gpu, light, 1, 0
        first = light.load(0)
        self._form = _form(first)
        self.lamps = sorted({*light.parts, *_lamps(first)})
        _check_counts(maps=len(first.maps), lamps=len(self.lamps))
        views = [seen.view for seen in first.maps]
        atlas = atlas_of(
            [view.shape for view in views], gpu.device.limits["max-texture-dimension-2d"]
        )
        most = min(2, len(light.moments))
        check_memory(atlas, lamps=len(self.lamps), moments=most)
        settings = {SETTINGS: settings_text(views, len(self.lamps), light.mode)}
        self.variants = [
            {**settings, MOMENTS: moments_text(len(views), count)} for count in range(1, most + 1)
        ]
        texels = make_texture(
            gpu,
            "rgba32uint",
            atlas.width,
            atlas.height,
            layers=most * atlas.pages,
            label="baked texels",
        )
        self._slots = [
            Slot(gpu, atlas, self.lamps, texels, number * atlas.pages, settings)
            for number in range(most)
        ]
        self._maps = uniform_buffer(gpu, 2 * MAX_MAPS * BAKED_MAP.dtype.itemsize, "baked maps")
        self._settings = uniform_buffer(gpu, BAKED_SETTINGS.dtype.itemsize, "baked")
        self._written = b""
        self.resources: dict[int, tuple[str, Any]] = {
            2: ("uint array", texels.view),
            3: ("uniform", self._maps),
            4: ("uniform", self._settings),
        }

    def encode(self, encoder: Any, time_seconds: float) -> None:
        """Records what brings the maps to a time; nothing where nothing has changed.

        Raises `InputError` where a moment's maps have other sizes, projections or lamps than the
        first one's.
        """
        earlier, later, share = self.light.around(time_seconds)
        shares = self.light.shares(time_seconds)
        slots = self._holding(earlier, later)
        mixed = [slot.mix(encoder, shares) for slot in dict.fromkeys(slots)]
        self.moments = len(mixed)
        records = np.zeros(2 * MAX_MAPS, BAKED_MAP.dtype)
        for place, slot in zip((0, MAX_MAPS), slots, strict=True):
            records[place : place + len(slot.records)] = slot.records
        settings = BAKED_SETTINGS.pack(
            earlier_scale=slots[0].scale,
            later_scale=slots[1].scale,
            later_share=share,
            depth_tolerance_m=self.light.depth_tolerance_m,
        )
        written = records.tobytes() + settings.tobytes()
        if written != self._written:
            write_buffer(self.gpu, self._maps, records)
            write_buffer(self.gpu, self._settings, settings)
        self.version += any(mixed) or written != self._written
        self._written = written

    def _holding(self, earlier: int, later: int) -> tuple[Slot, Slot]:
        """The slots of two moments, after filling those that are not there yet."""
        wanted = {earlier, later}
        free = [slot for slot in self._slots if slot.moment not in wanted]
        for number in sorted(wanted - {slot.moment for slot in self._slots}):
            free.pop(0).fill(number, self._loaded(number), self.light.depth_tolerance_m)
        holding = {slot.moment: slot for slot in self._slots}
        return holding[earlier], holding[later]

    def _loaded(self, number: int) -> BakedMoment:
        moment = self.light.load(number)
        if _form(moment) != self._form or not _lamps(moment) <= set(self.lamps):
            raise InputError(
                f"the maps at {moment.time_seconds:g} s have other sizes, projections or lamps "
                "than the first ones",
                field="baked.folder",
                remedy="bake them again (andon bake)",
            )
        return moment


def _form(moment: BakedMoment) -> list[tuple[str, int, int]]:
    """What must be alike in all moments."""
    return [(seen.view.projection, *seen.view.shape) for seen in moment.maps]


def _lamps(moment: BakedMoment) -> set[str]:
    return {name for seen in moment.maps for name in seen.lux}


def _check_counts(**counts: int) -> None:
    most = {"maps": MAX_MAPS, "lamps": MAX_LAMPS}
    for what, count in counts.items():
        if count > most[what]:
            raise MachineError(
                f"{count} {what} of baked light are more than shaders hold, {most[what]}",
                remedy=f"bake fewer {what}, or use --engine reference",
            )


class BakedPicture:
    """Reads a G-buffer, writes the baked light on what it shows.

    Attributes
    ----------
    lux : rgba32float; illuminance in lux, and in alpha 1 where a map sees the surface, else 0:
        there the light is that of a rim (rims.py), or none.
    """

    def __init__(
        self, buffers: BakedBuffers, view: View, gbuffer_view: Any, view_buffer: Any
    ) -> None:
        gpu = buffers.gpu
        self.buffers, self.view = buffers, view
        seen = make_texture(gpu, "rgba32float", view.width, view.height, label="baked light seen")
        self.lux = make_texture(gpu, "rgba32float", view.width, view.height, label="baked lux")
        self._seen = seen.view
        self._drawn: int | None = None
        scene = {0: ("uint", gbuffer_view), 1: ("uniform", view_buffer)}
        group = bind_group(gpu, scene | buffers.resources, "baked")
        structs, projection = gbuffer.STRUCTS | STRUCTS, gbuffer.projection_variant(view)
        self._passes = [
            FullscreenPass(
                gpu,
                BAKED_PICTURE,
                "baked_picture",
                [seen.format],
                [group],
                structs=structs,
                variants=projection | variants,
            )
            for variants in buffers.variants
        ]
        beside = scene | {2: ("float", seen.view), 3: buffers.resources[4]}
        self._rims = FullscreenPass(
            gpu,
            BAKED_RIMS,
            "baked_rims",
            [self.lux.format],
            [bind_group(gpu, beside, "baked rims")],
            structs=structs,
            variants=projection,
        )

    def encode(self, encoder: Any, time_seconds: float, *, changed: bool = False) -> bool:
        """Records the drawing at a time, if the light or, as `changed` says, the G-buffer is new.

        Returns whether it is drawn.
        """
        self.buffers.encode(encoder, time_seconds)
        if self._drawn == self.buffers.version and not changed:
            return False
        self._passes[self.buffers.moments - 1].encode(encoder, [self._seen])
        self._rims.encode(encoder, [self.lux.view])
        self._drawn = self.buffers.version
        return True
