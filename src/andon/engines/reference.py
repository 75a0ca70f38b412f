"""The slow, clear engine: NumPy in float64, rays by Embree."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from andon.composite import reference as composite
from andon.display import ost
from andon.display import reference as display
from andon.display.model import Seen
from andon.engines.glare_lamps import UnpicturedLamps
from andon.engines.glare_reference import glare_seen
from andon.engines.glass import SceneGlass
from andon.engines.moment import Moment
from andon.engines.prepared import Prepared
from andon.engines.probes import lampless_pixels, lit_pixels
from andon.glare.highlights.facets import Facets
from andon.glare.highlights.reference import Mirrored, facing_lux, mirrored_picture
from andon.glass import reference as glass
from andon.glass.backdrops.model import SceneOfView
from andon.glass.backdrops.paper import preblurred, with_blurred_pictures
from andon.glass.defocus import reference as defocus
from andon.glass.defocus.frame import frame_blurred
from andon.glass.layers import Layered
from andon.glass.model import GlassModel
from andon.glass.screen import middle_pixels_per_radian
from andon.glow import reference as glow
from andon.lamps import AreaLamp, Lamp
from andon.quantities import CameraFrame, DisplayImage, Illuminance, Luminance, Surface
from andon.surface import reference as surface
from andon.surface.shells import ShellsInView
from andon.transport.baked.model import BakedSeen
from andon.transport.direct import reference as direct
from andon.transport.direct.casters import ShadowRays

__all__ = ["ReferenceEngine"]

Float = NDArray[np.float64]

# As in frame.wgsl: light is asked for off the glass, since a ball hides lamps from what is inside.
OFF_GLASS_M = 2e-4
# Of a row of points, which is as long as a view may be.
MOST_POINTS = 65536


class ReferenceEngine:
    """The oracle of the tests, and what runs where there is no adapter."""

    name = "reference"
    adapter = "CPU (NumPy, Embree)"

    def __init__(self, prepared: Prepared) -> None:
        self.prepared = prepared
        self._surfaces: dict[str, Surface] = {}
        self._rays = ShadowRays(prepared.casters(prepared.at(0.0)))
        self._layered: Layered | None = None
        self._glare: Luminance | None = None
        self._unpictured = UnpicturedLamps(prepared.surface.shadow_casters)
        self._mirrored: Mirrored | None = None
        self._baked: BakedSeen | None = None
        self._blurred: tuple[float, GlassModel | None] = (0.0, None)
        self.maps_redrawn = 0

    def see(self, view_name: str, moment: Moment) -> Surface:
        """The surface of a view; made once, but for what moves."""
        if view_name not in self._surfaces:
            view = self.prepared.frames[view_name].view
            shells = self._shells(view_name)
            self._surfaces[view_name] = surface.see(self.prepared.surface, view, shells)
        still = self._surfaces[view_name]
        seen = surface.with_movers(still, self.prepared.surface, moment.movers)
        seen = surface.with_bodies(seen, moment.bodies)
        shells = self._shells(view_name)
        return seen if shells is None else shells.shining(seen, moment.bodies)

    def _shells(self, view_name: str) -> ShellsInView | None:
        own = self.prepared.shells
        return None if own is None else own.views[view_name]

    def illuminate(self, seen: Surface, moment: Moment) -> Illuminance:
        """Direct light of all lamps on the surface."""
        casters = self.prepared.casters(moment)
        if casters.version(()) != self._rays.casters.version(()):
            self._rays = ShadowRays(casters)
        bias = self.prepared.surface.bias
        bias_m: NDArray[np.float64] = np.where(seen.is_object, bias.object_m, bias.real_m)
        names = [body.name for body in moment.bodies]
        balls = self.prepared.balls
        lux = direct.illuminate(
            seen, moment.direct_lamps, self._rays, bias_m=bias_m, bodies=names, balls=balls
        )
        lux = self._received(seen, lux, moment)
        own = self.prepared.baked
        if own is not None:
            self._baked = own.seen(seen, self.prepared.surface, moment.time_seconds)
            lux = lux + self._baked.lux
        return Illuminance(lux, self.prepared.photometry)

    def read_baked(self, surface: Surface, moment: Moment) -> BakedSeen | None:
        """What the illuminance maps gave to the view that was drawn last."""
        return self._baked

    def _received(self, seen: Surface, lux: Float, moment: Moment) -> Float:
        """What objects take of `lux`: of those that lamps do not light nothing, and of those that
        probes light no sky that the probes have captured.
        """
        model, probes = self.prepared.surface, self.prepared.probes
        if probes is not None:
            lit = lit_pixels(seen, model)
            for lamp in moment.direct_lamps:
                if lamp.name in probes.captured:
                    lux[lit] -= direct.illuminance(lamp, seen.position[lit], seen.normal[lit])
        lux[lampless_pixels(seen, model)] = 0
        return lux

    def compose(
        self, frame: CameraFrame, seen: Surface, light: Illuminance, moment: Moment
    ) -> Luminance:
        """The photograph under its new light, with objects and lamps in it."""
        probes = self.prepared.probes
        standing = None
        if probes is not None:
            standing = probes.standing_lux(seen, self.prepared.surface, moment.object_middles)
        added = np.asarray(light.lux, np.float64)
        self._mirrored = self._mirror(seen, moment, standing)
        mirror = None
        if self._mirrored is not None:
            mirror = partial(self._mirrored.over, seen.emitted_cd_m2)
        measured = self.prepared.measured.get(frame.view.name)
        luminance = composite.compose(
            frame, seen, self.prepared.ambient, added, moment.lamps, standing, mirror, measured
        )
        return Luminance(luminance, self.prepared.photometry)

    def _mirror(self, seen: Surface, moment: Moment, standing: Float | None) -> Mirrored | None:
        """What virtual objects mirror."""
        own, probes = self.prepared.highlights, self.prepared.probes
        if own is None:
            return None
        lux = np.broadcast_to(self.prepared.ambient.standing_lux, (*seen.view.shape, 3))
        lux = lux if standing is None else np.where(np.isnan(standing), lux, standing)
        time = moment.time_seconds
        return mirrored_picture(
            seen,
            own.at(time),
            moment.lamps,
            self._arrives,
            lux,
            time,
            frozenset() if probes is None else probes.captured,
        )

    def read_highlights(self, frame: CameraFrame) -> Luminance | None:
        """Mirrored lamps alone, of the view that was drawn last."""
        found = self._mirrored
        return None if found is None else Luminance(found.lamps_cd_m2, self.prepared.photometry)

    def _arrives(self, lamp: Lamp, facets: Facets) -> Float:
        """What of a lamp arrives at n facets, as `lamp_highlight` has it."""
        place = facets.position, facets.ground
        lifted = facets.position + self.prepared.surface.bias.object_m * facets.ground
        if isinstance(lamp, AreaLamp):
            return direct.seen_share(lamp, *place, lifted, self._rays)
        lux = direct.arriving(lamp, *place, lifted, self._rays, self.prepared.balls)
        return facing_lux(lamp, facets, lux)

    def glass_over(
        self, frame: CameraFrame, seen: Surface, luminance: Luminance, moment: Moment
    ) -> Luminance:
        """The picture with glass in it, blurred by where its layers are."""
        own = self.prepared.glass
        if own is None:
            return luminance
        cd_m2 = np.asarray(luminance.cd_m2, np.float64)
        behind = SceneOfView(cd_m2, seen, frame.view, frame.luminance_per_unit, own.dimming)
        lamps = own.highlights(moment.lamps)
        model, blurred = self._paper(own, behind, moment)
        self._layered = glass.layers_of(
            model,
            blurred,
            moment.focus,
            lamps,
            lambda points, normals: own.standing_lux + self._lit(points, normals, moment),
        )
        beside = cd_m2
        if own.model.defocus_frame and moment.focus is not None:
            sizes = glass.frame_blur_px(own.model, behind, moment.focus)
            beside = frame_blurred(cd_m2, sizes, 1 / seen.distance_m)
        layers = defocus.blurred(self._layered.layers, own.model.blur)
        return Luminance(layers.over(beside), self.prepared.photometry)

    def _paper(
        self, own: SceneGlass, behind: SceneOfView, moment: Moment
    ) -> tuple[GlassModel, SceneOfView]:
        """Bodies and frame with blurred backdrops, in mode ``paper``."""
        blur_m = own.paper_blur_m(moment.focus)
        if blur_m == 0:
            return own.model, behind
        if blur_m != self._blurred[0]:
            solids = with_blurred_pictures(own.model.solids, blur_m)
            self._blurred = blur_m, replace(own.model, solids=solids)
        model = self._blurred[1]
        assert model is not None
        if all(solid.backdrop.kind == "texture" for solid in model.solids):
            return model, behind
        per_m = middle_pixels_per_radian(behind.view) / own.backdrop_m
        return model, behind.with_luminance(preblurred(behind.luminance, per_m, blur_m))

    def _lit(self, points: Float, normals: Float, moment: Moment) -> Float:
        """(n, 3) lux of the lamps at `points` (n, 3) with unit `normals` (n, 3)."""
        lux = np.zeros_like(points)
        for start in range(0, len(points), MOST_POINTS):
            part = slice(start, start + MOST_POINTS)
            row = Surface.of_points(points[part] + OFF_GLASS_M * normals[part], normals[part])
            bias_m = np.full(row.view.shape, self.prepared.surface.bias.object_m)
            lux[part] = direct.illuminate(
                row, moment.direct_lamps, self._rays, bias_m=bias_m, balls=self.prepared.balls
            )[0]
        probes = self.prepared.probes
        captured = frozenset[str]() if probes is None else probes.captured
        for lamp in moment.direct_lamps:
            if lamp.name in captured:
                lux -= direct.illuminance(lamp, points, normals)
        return lux

    def read_glass(self, frame: CameraFrame, seen: Surface, moment: Moment) -> Layered | None:
        """The layers of the glass, sharp, of the view that was drawn last."""
        return self._layered

    def glow(
        self, frame: CameraFrame, seen: Surface, luminance: Luminance, moment: Moment
    ) -> Luminance:
        """The picture with the light of luminous bodies scattered around them."""
        if self.prepared.glow is None:
            return luminance
        bodies = self._unhidden(composite.bodies_luminance(seen, moment.lamps))
        cd_m2 = glow.add_glow(luminance.cd_m2, bodies, self.prepared.glow, frame.view)
        return Luminance(cd_m2, self.prepared.photometry)

    def _unhidden(self, bodies: Float) -> Float:
        """What is left of bodies' light (H, W, 3) where glass is in front of them."""
        if self._layered is None:
            return bodies
        return bodies * (1 - self._layered.layers.coverage)[..., None]

    def glare(
        self, frame: CameraFrame, seen: Surface, luminance: Luminance, moment: Moment
    ) -> Luminance:
        """The picture as the observer's eye scatters it."""
        own, word = self.prepared.glare, self.prepared.photometry
        if own is None:
            return luminance
        light = all_light = np.maximum(np.nan_to_num(np.asarray(luminance.cd_m2, np.float64)), 0)
        through = self.prepared.exposure.see_through
        if through is not None:
            # Real light glares in the eye by itself.
            unlit = self._unlit(frame)
            real = frame.luminance_per_unit * ost.real_light(unlit, through)
            light = np.maximum(all_light - real, 0)
        mirrored = None if self._mirrored is None else self._mirrored.lamps_cd_m2
        stays, added = glare_seen(own, light, frame.view, moment.lamps, self._unpictured, mirrored)
        self._glare = Luminance(added, word)
        return Luminance((stays if through is None else all_light) + added, word)

    def _unlit(self, frame: CameraFrame) -> Float:
        """Linear camera values (H, W, 3) of a view without any lamp."""
        measured = self.prepared.measured.get(frame.view.name)
        return composite.unlit_linear(frame, self.prepared.ambient, measured)

    def read_glare(self, frame: CameraFrame) -> Luminance | None:
        """What glare added to the view that was drawn last."""
        return self._glare

    def encode(self, frame: CameraFrame, luminance: Luminance) -> DisplayImage:
        """8-bit codes for the screen."""
        through, white = self.prepared.exposure.see_through, frame.luminance_per_unit
        if through is not None:
            cd_m2 = np.asarray(luminance.cd_m2, np.float64)
            real, unlit = (
                white * ost.real_light(light, through)
                for light in (frame.linear, self._unlit(frame))
            )
            share = ost.shown_share(cd_m2, real, through, white, unlit)
            return DisplayImage(ost.display_codes(share))
        codes = display.encode(
            luminance.cd_m2, self.prepared.exposure, frame.response, frame.luminance_per_unit
        )
        return DisplayImage(codes)

    def read_seen(
        self, frame: CameraFrame, luminance: Luminance, image: DisplayImage
    ) -> Seen | None:
        """What is seen through an optical see-through display."""
        if self.prepared.exposure.see_through is None:
            return None
        return ost.seen_through(luminance, frame, self.prepared.exposure, image.rgb)

    def finish(self) -> None:
        """Nothing is pending."""

    def read(
        self, seen: Surface, light: Illuminance, luminance: Luminance, image: DisplayImage
    ) -> tuple[Surface, Illuminance, Luminance, DisplayImage]:
        """The quantities as arrays: they are already."""
        return seen, light, luminance, image

    def picture(self, image: DisplayImage) -> DisplayImage:
        """What `encode` gave, as an array."""
        return image

    def read_bodies(
        self, frame: CameraFrame, seen: Surface, moment: Moment
    ) -> tuple[Luminance | None, Luminance | None]:
        """Luminous bodies alone, and as the glow filters them."""
        alone = composite.bodies_luminance(seen, moment.lamps)
        if not alone.any():
            return None, None
        word, settings = self.prepared.photometry, self.prepared.glow
        alone = alone if settings is None else self._unhidden(alone)
        scattered = None if settings is None else glow.filtered(alone, settings, frame.view)
        return Luminance(alone, word), None if scattered is None else Luminance(scattered, word)
