"""The fast engine: WGSL, software Vulkan included."""

from __future__ import annotations

from typing import Any

import numpy as np

from andon.display.model import Seen
from andon.display.ost_stage import OstStage
from andon.display.stage import DisplayStage
from andon.engines.glass_gpu import GlassBuffers
from andon.engines.gpu_view import GpuView
from andon.engines.moment import Moment
from andon.engines.prepared import Prepared
from andon.engines.probes import NO_LAMPS, PROBES, taking
from andon.glare.highlights import stage as highlights
from andon.glare.highlights.sum import highlights_of_lamps
from andon.glass.layers import Layered
from andon.gpu.device import open_gpu
from andon.gpu.textures import HALF_MOST, Texture, make_texture
from andon.lamps import Lamp
from andon.quantities import CameraFrame, DisplayImage, Illuminance, Luminance, Surface
from andon.surface.stage import GpuSurface
from andon.transport.baked.model import BakedSeen
from andon.transport.baked.stage import FRAME_VARIANTS, BakedBuffers
from andon.transport.direct import stage as direct
from andon.transport.probes.stage import ProbeBuffers

__all__ = ["GpuEngine"]

RECEIVERS = "andon/composite/receivers{}.wgsl"


class GpuEngine:
    """Draws frames on the device; nothing is read back until it is asked for.

    Raises `MachineError` where there is no adapter.
    """

    name = "gpu"

    def __init__(self, prepared: Prepared) -> None:
        self.gpu = open_gpu()
        self.adapter = self.gpu.adapter_name
        self.prepared = prepared
        bias = prepared.surface.bias
        self.start = prepared.at(0.0)
        probes = prepared.probes
        self.taking = taking(prepared.surface, has_probes=probes is not None)
        self.probes: ProbeBuffers | None = None
        if probes is not None and (self.taking & PROBES).any():
            slots = prepared.surface.object_of_slot
            self.probes = ProbeBuffers(self.gpu, probes.dimmed, probes.lookup, slots)
        captured = frozenset[str]() if probes is None else probes.captured
        self.baked: BakedBuffers | None = None
        if prepared.baked is not None:
            self.baked = BakedBuffers(self.gpu, prepared.baked.light)
        self.direct = direct.DirectStage(
            self.gpu,
            prepared.casters(self.start),
            self._lamps(self.start),
            [body.name for body in self.start.bodies],
            bias_real_m=bias.real_m,
            bias_object_m=bias.object_m,
            captured=captured,
            silent=frozenset(lamp.name for lamp in self.start.lamps)
            - frozenset(lamp.name for lamp in self.start.direct_lamps),
            balls=prepared.balls,
            shells=frozenset() if prepared.shells is None else prepared.shells.names,
        )
        self.finishes: highlights.FinishBuffers | None = None
        self.lamps_mirrored = ""
        if prepared.highlights is not None:
            self.finishes = highlights.FinishBuffers(self.gpu, prepared.highlights.at(0.0))
            self.lamps_mirrored = highlights_of_lamps(
                self.start.lamps,
                terms=self.direct.terms,
                softening=self.direct.softening,
                edges=self.direct.areas.edges,
                captured=captured,
            )
        self.glass: GlassBuffers | None = None
        if prepared.glass is not None:
            white = next(iter(prepared.frames.values())).luminance_per_unit
            self.glass = GlassBuffers(self.gpu, prepared.glass, white)
        self.variants = self.direct.variants | self._receivers() | self._baked_light()
        self._views = {name: GpuView(self, frame) for name, frame in prepared.frames.items()}
        self._encoder: Any = None
        self.maps_redrawn = 0

    def _lamps(self, moment: Moment) -> tuple[Lamp, ...]:
        """Those whose shadows are looked up: what is baked as a whole only where it is mirrored."""
        return moment.direct_lamps if self.prepared.highlights is None else moment.lamps

    def _baked_light(self) -> dict[str, str]:
        """Shaders for baked light, and for who takes it."""
        own = self.prepared.baked
        if own is None:
            return {}
        return FRAME_VARIANTS["beside probes" if own.in_probes else "all"]

    def _receivers(self) -> dict[str, str]:
        """Shaders for what light the virtual objects take."""
        if self.probes is not None:
            return {RECEIVERS.format(""): RECEIVERS.format("_probes")}
        some = bool((self.taking & NO_LAMPS).any())
        return {RECEIVERS.format(""): RECEIVERS.format("_lamps")} if some else {}

    @property
    def encoder(self) -> Any:
        """The commands recorded since the last `finish`."""
        if self._encoder is None:
            self._encoder = self.gpu.device.create_command_encoder(label="frame")
        return self._encoder

    def see(self, view_name: str, moment: Moment) -> GpuSurface:
        """Records the drawing of the G-buffer."""
        stage = self._views[view_name].surface
        return stage.encode(self.encoder, moment.bodies, moment.movers)

    def illuminate(self, seen: GpuSurface, moment: Moment) -> GpuView:
        """Brings shadow maps and lamps up to date; shared by both eyes."""
        casters = self.prepared.casters(moment)
        self.maps_redrawn = self.direct.encode(self.encoder, self._lamps(moment), casters)
        return self._views[seen.view.name]

    def compose(
        self, frame: CameraFrame, seen: GpuSurface, light: GpuView, moment: Moment
    ) -> Texture:
        """Records direct light and composite in one pass, then the visible lamps."""
        if self.probes is not None and light.probes is not None:
            self.probes.move(moment.object_middles)
            light.probes.encode(self.encoder, light.changed_rectangles(moment))
        if light.baked is not None:
            changed = light.has_moved(moment)
            light.baked.encode(self.encoder, moment.time_seconds, changed=changed)
        light.relit.encode(self.encoder, [light.luminance.view])
        own = self.prepared.highlights
        if own is not None and self.finishes is not None and light.highlights is not None:
            self.finishes.update(own.at(moment.time_seconds), moment.time_seconds)
            light.highlights.encode(self.encoder, light.luminance.view)
        light.has_lamps = light.composite.lamps.encode(
            self.encoder, light.luminance.view, seen, moment.lamps, frame.luminance_per_unit
        )
        return light.luminance

    def read_highlights(self, frame: CameraFrame) -> Luminance | None:
        """Mirrored lamps alone, as they were drawn last."""
        stage = self._views[frame.view.name].highlights
        if stage is None:
            return None
        return Luminance(stage.alone.read()[..., :3], self.prepared.photometry)

    def read_baked(self, surface: Surface, moment: Moment) -> BakedSeen | None:
        """What the illuminance maps gave to the view that was drawn last, and `surface` is of."""
        picture, own = self._views[surface.view.name].baked, self.prepared.baked
        if picture is None or own is None:
            return None
        values = picture.lux.read()
        asked = own.asked(surface, self.prepared.surface)
        covered = asked & (values[..., 3] > 0.5)
        return BakedSeen(np.where(asked[..., None], values[..., :3], 0.0), covered, asked)

    def glass_over(
        self, frame: CameraFrame, seen: GpuSurface, luminance: Texture, moment: Moment
    ) -> Texture:
        """Records the glass, blurred by where its layers are."""
        view = self._views[frame.view.name]
        if self.glass is not None and view.glass is not None:
            self.glass.update(moment.lamps)
            view.glass.encode(self.encoder, moment)
        return luminance

    def read_glass(self, frame: CameraFrame, seen: GpuSurface, moment: Moment) -> Layered | None:
        """The layers of the glass, sharp; for figures, not for frames."""
        view = self._views[frame.view.name]
        return None if view.glass is None else view.glass.read()

    def glow(
        self, frame: CameraFrame, seen: GpuSurface, luminance: Texture, moment: Moment
    ) -> Texture:
        """Records the scattering of the bodies' light around them."""
        view = self._views[frame.view.name]
        if view.glow is not None and view.has_lamps:
            if view.glass is not None and view.hide is not None and view.glass.within is not None:
                alone = view.composite.lamps.alone.view
                view.hide.encode_within(self.encoder, [alone], view.glass.within)
            view.glow.encode(self.encoder, view.composite.lamps.within)
        return luminance

    def glare(
        self, frame: CameraFrame, seen: GpuSurface, luminance: Texture, moment: Moment
    ) -> Texture:
        """Records the picture as the observer's eye scatters it; waits to know its sources."""
        own = self._views[frame.view.name].glare
        if own is None:
            return luminance
        own.encode_sources(self.encoder)
        self.finish()
        own.update(moment.lamps)
        own.encode(self.encoder)
        return own.seen

    def read_glare(self, frame: CameraFrame) -> Luminance | None:
        """What glare added to the view that was drawn last; for figures, not for frames."""
        own = self._views[frame.view.name].glare
        if own is None:
            return None
        view = frame.view
        alone = make_texture(self.gpu, "rgba16float", view.width, view.height, label="glare")
        own.encode_glare(self.encoder, alone)
        self.finish()
        return self._cd_m2(alone, frame)

    def encode(self, frame: CameraFrame, luminance: Texture) -> DisplayStage | OstStage:
        """Records the display."""
        display = self._views[frame.view.name].display
        display.encode(self.encoder)
        return display

    def read_seen(
        self, frame: CameraFrame, luminance: Texture, image: DisplayStage | OstStage
    ) -> Seen | None:
        """What is seen through an optical see-through display; for figures, not for frames."""
        return image.read_seen(self.prepared.photometry) if isinstance(image, OstStage) else None

    def finish(self) -> None:
        """Submits what was recorded and waits for it."""
        if self._encoder is not None:
            self.gpu.device.queue.submit([self._encoder.finish()])
            self._encoder = None
        self.gpu.wait()

    def read(
        self, seen: GpuSurface, light: GpuView, luminance: Texture, image: DisplayStage | OstStage
    ) -> tuple[Surface, Illuminance, Luminance, DisplayImage]:
        """The quantities as arrays; draws the illuminance map, which no frame needs."""
        light.lux.encode(self.encoder, [light.lux_map.view])
        self.finish()
        lux = np.ascontiguousarray(light.lux_map.read()[..., :3])
        word = self.prepared.photometry
        surface = seen.read()
        if surface.body_id is not None and light.has_lamps:
            alone = self._cd_m2(light.composite.lamps.alone, light.frame).cd_m2
            own = surface.body_id >= 0
            surface.emitted_cd_m2[own] = alone[own]
        return surface, Illuminance(lux, word), self._cd_m2(luminance, light.frame), image.read()

    def picture(self, image: DisplayStage | OstStage) -> DisplayImage:
        """What `encode` gave, as an array."""
        return image.read()

    def read_bodies(
        self, frame: CameraFrame, seen: GpuSurface, moment: Moment
    ) -> tuple[Luminance | None, Luminance | None]:
        """Luminous bodies alone, and as the glow filters them; for figures, not for frames."""
        view = self._views[frame.view.name]
        if not view.has_lamps:
            return None, None
        alone = self._cd_m2(view.composite.lamps.alone, frame)
        if view.glow is None:
            return alone, None
        view.glow.encode_filtered(self.encoder, view.filtered)
        self.finish()
        return alone, self._cd_m2(view.filtered, frame)

    def _cd_m2(self, picture: Texture, frame: CameraFrame) -> Luminance:
        # Sums beyond half floats are infinite on most devices.
        linear = np.minimum(picture.read()[..., :3].astype(np.float32), HALF_MOST)
        return Luminance(linear * np.float32(frame.luminance_per_unit), self.prepared.photometry)
