"""One view on the GPU: its textures, stages and passes, made once."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from andon import gbuffer
from andon.composite import stage as composite
from andon.composite.reference import unlit_linear
from andon.display import ost
from andon.display.ost_stage import OstStage
from andon.display.stage import DisplayStage
from andon.engines.changes import Changes, Rectangle
from andon.engines.glare_gpu import GlareView
from andon.engines.glass_gpu import GlassView
from andon.engines.moment import Moment
from andon.engines.prepared import Prepared
from andon.glare.highlights import stage as highlights
from andon.glow.stage import GlowStage
from andon.gpu.bindings import BindGroup, bind_group
from andon.gpu.device import Gpu
from andon.gpu.passes import FullscreenPass
from andon.gpu.textures import make_texture
from andon.quantities import CameraFrame
from andon.surface.model import SurfaceModel
from andon.surface.stage import GpuSurface, SurfaceStage
from andon.transport.baked.stage import BakedPicture
from andon.transport.direct import stage as direct
from andon.transport.probes.stage import ProbePicture

if TYPE_CHECKING:
    from andon.engines.gpu import GpuEngine

__all__ = ["GpuView"]

FRAME = "andon/frame.wgsl"
STRUCTS = gbuffer.STRUCTS | direct.STRUCTS | composite.STRUCTS


class GpuView:
    """Everything of one view that lives on the GPU; made once."""

    def __init__(self, engine: GpuEngine, frame: CameraFrame) -> None:
        gpu, prepared = engine.gpu, engine.prepared
        self.frame = frame
        self.has_lamps = False
        view = frame.view
        start = engine.start
        shells = None if prepared.shells is None else prepared.shells.views[view.name]
        self.surface = SurfaceStage(gpu, prepared.surface, view, start.bodies, start.movers, shells)
        seen = self.surface.surface
        self.composite = _composite_of(engine, frame, seen)
        self.luminance = make_texture(gpu, "rgba16float", view.width, view.height, label="light")
        self.glass: GlassView | None = None
        if engine.glass is not None:
            lit = self.composite.resources, engine.direct
            self.glass = GlassView(gpu, engine.glass, frame, seen, self.luminance, lit)
        self.glow: GlowStage | None = None
        if prepared.glow is not None:
            alone = self.composite.lamps.alone
            self.glow = GlowStage(gpu, alone, self.luminance, prepared.glow, view)
            self.filtered = make_texture(gpu, alone.format, view.width, view.height, label="glow")
            self.hide = None if self.glass is None else self.glass.hiding(alone)
        own: dict[int, Any] = {0: ("uint", seen.texture.view), 1: ("uniform", seen.view_buffer)}
        self.baked: BakedPicture | None = None
        if engine.baked is not None:
            self.baked = BakedPicture(engine.baked, view, seen.texture.view, seen.view_buffer)
            self._moved = Changes(view, ())
            own[6] = ("float", self.baked.lux.view)
        groups = [
            bind_group(gpu, own | self.composite.resources, "frame"),
            engine.direct.group,
        ]
        self.probes: ProbePicture | None = None
        if engine.probes is not None:
            self.probes = ProbePicture(engine.probes, view, seen.texture.view, seen.view_buffer)
            self._changes = Changes(view, _standing_in_probes(prepared.surface))
            groups.append(bind_group(gpu, {0: ("float", self.probes.lux.view)}, "probes"))
        options: dict[str, Any] = {
            "structs": STRUCTS,
            "variants": gbuffer.projection_variant(view) | engine.variants,
        }
        self._make_highlights(engine, groups, options["variants"])
        self._make_display(gpu, prepared)
        entry = self._entry_point(prepared)
        self.relit = FullscreenPass(gpu, FRAME, entry, ["rgba16float"], groups, **options)
        # Half floats end at 65504, sunlight does not, and this picture is for machines.
        self.lux_map = make_texture(gpu, "rgba32float", view.width, view.height, label="lux")
        self.lux = FullscreenPass(
            gpu, FRAME, "illuminance_map", [self.lux_map.format], groups, **options
        )

    def _make_display(self, gpu: Gpu, prepared: Prepared) -> None:
        """Glare, and the display of what it leaves."""
        frame = self.frame
        self.glare: GlareView | None = None
        shown, through = self.luminance, prepared.exposure.see_through
        measured = prepared.measured.get(frame.view.name)
        unlit = None if through is None else unlit_linear(frame, prepared.ambient, measured)
        if prepared.glare is not None:
            real = None if through is None or unlit is None else ost.real_light(unlit, through)
            hiding = prepared.surface.shadow_casters
            mirrored = None if self.highlights is None else self.highlights.alone
            light = self.luminance
            self.glare = GlareView(gpu, prepared.glare, frame, light, hiding, real, mirrored)
            shown = self.glare.seen
        self.display: DisplayStage | OstStage
        if unlit is not None:
            self.display = OstStage(gpu, shown, frame, prepared.exposure, unlit)
        else:
            self.display = DisplayStage(
                gpu, shown, frame.response, prepared.exposure, frame.luminance_per_unit
            )

    def _make_highlights(
        self, engine: GpuEngine, groups: list[BindGroup], variants: dict[str, str]
    ) -> None:
        self.highlights: highlights.HighlightStage | None = None
        if engine.finishes is None:
            return
        gpu, frame = engine.gpu, self.frame
        own = engine.finishes, groups, STRUCTS, variants | {highlights.SUM: engine.lamps_mirrored}
        self.highlights = highlights.HighlightStage(gpu, frame.view, *own)

    def changed_rectangles(self, moment: Moment) -> list[Rectangle]:
        """Where the light of probes has to be drawn anew: all of it once, then what moved."""
        bodies = [body.geometry for body in moment.bodies]
        return self._changes.since_last([*moment.movers, *bodies])

    def has_moved(self, moment: Moment) -> bool:
        """Something else is seen somewhere than when this was asked last."""
        bodies = [body.geometry for body in moment.bodies]
        return bool(self._moved.since_last([*moment.movers, *bodies]))

    def _entry_point(self, prepared: Prepared) -> str:
        if self.composite.has_curves:
            return "relit_with_curves"
        if self.composite.has_maps:
            return "relit_with_maps"
        has_objects = prepared.surface.has_objects or self.surface.has_bodies
        return "relit_with_objects" if has_objects else "relit"


def _composite_of(
    engine: GpuEngine, frame: CameraFrame, seen: GpuSurface
) -> composite.CompositeStage:
    """What becomes of the photograph, with the photograph in it."""
    stage = composite.CompositeStage(
        engine.gpu,
        frame.view,
        engine.prepared.ambient,
        seen.texture.view,
        seen.view_buffer,
        seen.emitted_cd_m2,
        engine.taking,
        engine.prepared.measured.get(frame.view.name),
    )
    stage.load(frame)
    return stage


def _standing_in_probes(model: SurfaceModel) -> list[NDArray[np.float64]]:
    """(n, 3) corners of each object that stands still and is lit by probes."""
    still = model.objects_table[: len(model.objects_table) - len(model.movers)]
    lit = [number for number, info in enumerate(still) if info.lit_by_probes]
    return [model.corners_of(number).reshape(-1, 3) for number in lit]
