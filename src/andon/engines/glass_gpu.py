"""Glass of one view on the GPU: trace, light what sticks to it, blur, compose."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon import gbuffer
from andon.composite import stage as composite
from andon.composite.records import AMBIENT_RECORD, pack_ambient
from andon.engines.glass import SceneGlass
from andon.engines.glass_blur import BlurBounds
from andon.engines.moment import Moment
from andon.glass.backdrops.buffers import BackdropBuffers
from andon.glass.backdrops.levels import FrameLevels
from andon.glass.backdrops.paper import texels_per_metre
from andon.glass.defocus.frame_stage import FrameDefocusStage
from andon.glass.defocus.kernels import MAX_BLUR_PX
from andon.glass.defocus.stage import DefocusStage
from andon.glass.layers import Counts, Layered, Layers
from andon.glass.model import Focus
from andon.glass.screen import middle_pixels_per_radian
from andon.glass.stage import SolidBuffers, TraceStage
from andon.gpu.bindings import bind_group
from andon.gpu.device import Gpu
from andon.gpu.passes import FullscreenPass
from andon.gpu.textures import Texture, uniform_buffer, write_buffer
from andon.lamps import Lamp
from andon.quantities import CameraFrame
from andon.surface.stage import GpuSurface
from andon.transport.direct import stage as direct

__all__ = ["GlassBuffers", "GlassView"]

FRAME = "andon/frame.wgsl"
# Light times what reflects it, which is there already.
TIMES = {
    "color": {"operation": "add", "src_factor": "dst", "dst_factor": "zero"},
    "alpha": {"operation": "add", "src_factor": "zero", "dst_factor": "one"},
}
# What is there, less what glass covers.
LESS = {
    part: {"operation": "add", "src_factor": "zero", "dst_factor": "one-minus-src"}
    for part in ("color", "alpha")
}
LOST, MISSED, CLAMPED, BESIDE = 1, 2, 4, 8


class GlassBuffers:
    """What both eyes share."""

    def __init__(self, gpu: Gpu, glass: SceneGlass, luminance_per_unit: float) -> None:
        self.glass = glass
        model = glass.model
        self.solids = SolidBuffers(gpu, model.solids)
        self.backdrops = BackdropBuffers(
            gpu,
            model.solids,
            model.environment,
            luminance_per_unit,
            glass.dimming,
            blurs=model.blur == "paper",
        )
        self._blur_m = 0.0
        self.sees_frame = any(s.backdrop.kind != "texture" for s in model.solids)

    def update(self, lamps: tuple[Lamp, ...]) -> None:
        """Lamps of a moment, as the bodies mirror them."""
        self.solids.write_highlights(self.glass.highlights(lamps))

    def blur(self, encoder: Any, blur_m: float) -> None:
        """Records the paper's blur of the backdrops' pictures, where it has changed."""
        if blur_m == self._blur_m:
            return
        self._blur_m = blur_m
        for number, solid in enumerate(self.glass.model.solids):
            if solid.backdrop.picture is not None:
                per_m = texels_per_metre(solid.backdrop, 1.0, 1.0)
                self.backdrops.encode_blur(encoder, number, per_m * blur_m)


class GlassView:
    """All of one view's glass that lives on the GPU; made once."""

    def __init__(
        self,
        gpu: Gpu,
        shared: GlassBuffers,
        frame: CameraFrame,
        seen: GpuSurface,
        luminance: Texture,
        lit: tuple[dict[int, tuple[str, Any]], direct.DirectStage],
    ) -> None:
        """`lit`: bindings 2 to 5 of frame.wgsl, and the light of the lamps."""
        self.gpu, self.shared, self.frame = gpu, shared, frame
        view, model = frame.view, shared.glass.model
        self._per_radian = middle_pixels_per_radian(view)
        self._stuck: object = None
        self._bounds = BlurBounds(model, view)
        self._levels = FrameLevels(gpu, luminance, blurs=model.blur == "paper")
        self.trace = TraceStage(
            gpu,
            view,
            shared.solids,
            (seen.texture.view, seen.view_buffer),
            shared.backdrops.group(self._levels.texture),
            largest_px=MAX_BLUR_PX,
        )
        trace = self.trace
        self._light = self._sticker_light(seen, *lit) if trace.stickers is not None else None
        layers = (trace.refracted, trace.surface, trace.reflected, trace.sizes)
        self._beside: FrameDefocusStage | None = None
        if model.defocus_frame:
            of_view = seen.texture.view, seen.view_buffer
            self._beside = FrameDefocusStage(gpu, view, of_view, luminance)
        size = (view.width, view.height)
        self._defocus = DefocusStage(gpu, *layers, luminance, model.blur, size)

    def _sticker_light(
        self, seen: GpuSurface, resources: dict[int, tuple[str, Any]], lamps: direct.DirectStage
    ) -> FullscreenPass:
        assert self.trace.stickers is not None
        gpu, glass, view = self.gpu, self.shared.glass, self.frame.view
        standing = uniform_buffer(gpu, AMBIENT_RECORD.dtype.itemsize, "standing")
        record = pack_ambient(glass.ambient, self.frame.luminance_per_unit)
        record["object_lux"] = glass.standing_lux
        write_buffer(gpu, standing, record)
        own: dict[int, tuple[str, Any]] = {
            0: ("uint", self.trace.stickers.view),
            1: ("uniform", seen.view_buffer),
        }
        groups = [
            bind_group(gpu, own | resources | {2: ("uniform", standing)}, "stickers"),
            lamps.group,
        ]
        return FullscreenPass(
            gpu,
            FRAME,
            "sticker_light",
            [self.trace.surface.format],
            groups,
            structs=gbuffer.STRUCTS | direct.STRUCTS | composite.STRUCTS,
            variants=gbuffer.projection_variant(view) | lamps.variants,
            blend=TIMES,
        )

    def encode(self, encoder: Any, moment: Moment) -> None:
        """Records the glass over the view's luminance."""
        within = self.trace.within
        focus, model = moment.focus, self.shared.glass.model
        blurs = focus is not None and model.blur != "off"
        if within is None:
            self._encode_beside(encoder, focus)
            return
        self.trace.focus(
            focus.dioptres if focus is not None else 0.0,
            model.pupil_m if blurs else 0.0,
            self.frame.luminance_per_unit,
            apparent=model.blur != "paper",
        )
        blur_m = self.shared.glass.paper_blur_m(focus)
        self.shared.blur(encoder, blur_m)
        if self.shared.sees_frame:
            per_m = self._per_radian / self.shared.glass.backdrop_m
            self._levels.encode(encoder, per_m * blur_m)
        self._encode_stickers(encoder, moment)
        self.trace.encode(encoder)
        if self._light is not None:
            self._light.encode_within(encoder, [self.trace.surface.view], within)
        # Behind the glass stays the sharp frame: it has been read by now.
        self._encode_beside(encoder, focus)
        none = (0.0, 0.0, 0.0)
        most, least = (none, none) if focus is None or not blurs else self._bounds.of(focus)
        self._defocus.encode(encoder, within, most, least)

    def _encode_beside(self, encoder: Any, focus: Focus | None) -> None:
        """The frame by its own depth, where that is asked for."""
        if self._beside is not None and focus is not None:
            self._beside.encode(encoder, focus.dioptres, self.shared.glass.model.pupil_m)

    def _encode_stickers(self, encoder: Any, moment: Moment) -> None:
        """Anew where something moves: what hides the glass, or the glass itself."""
        moves = bool(moment.bodies) or bool(moment.movers)
        if moves or self._stuck is not self.shared.solids.solids:
            self.trace.encode_stickers(encoder)
            self._stuck = self.shared.solids.solids

    @property
    def within(self) -> tuple[int, int, int, int] | None:
        """(x, y, width, height) in pixels that holds all glass; None: none is seen."""
        return self.trace.within

    def hiding(self, bodies: Texture) -> FullscreenPass:
        """The pass that takes from a picture of luminous bodies what glass is in front of."""
        group = bind_group(self.gpu, {0: ("float", self.trace.sizes.view)}, "hide")
        shader = "andon/glass/hide.wgsl"
        return FullscreenPass(self.gpu, shader, "hide", [bodies.format], [group], blend=LESS)

    def read(self) -> Layered:
        """The sharp layers as arrays, and their counts; waits for the device."""
        unit = self.frame.luminance_per_unit
        trace = self.trace
        refracted, surface, reflected, sizes = (
            one.read().astype(np.float64)
            for one in (trace.refracted, trace.surface, trace.reflected, trace.sizes)
        )
        coverage = sizes[..., 0]
        share = np.maximum(coverage, 1e-6)
        layers = Layers(
            coverage,
            refracted[..., :3] * unit,
            surface[..., :3] * unit,
            surface[..., 3],
            reflected[..., :3] * unit,
            refracted[..., 3] / share,
            sizes[..., 1] / share,
            reflected[..., 3] / share,
        )
        return Layered(layers, _counted(coverage > 0, sizes[..., 2].astype(np.uint8)))


def _counted(is_glass: NDArray[np.bool_], flags: NDArray[np.uint8]) -> Counts:
    found = [int(np.count_nonzero(is_glass & (flags & bit > 0))) for bit in _BITS]
    return Counts(int(np.count_nonzero(is_glass)), *found)


_BITS = (LOST, MISSED, BESIDE, CLAMPED)
