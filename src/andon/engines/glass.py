"""Glass of a scene for both engines: bodies, mirrored lamps, and what the eyes are focused on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product

import numpy as np
from numpy.typing import NDArray

from andon.composite.model import Ambient
from andon.engines.adaptation import adaptation_cd_m2
from andon.engines.gaze import SceneGaze, gaze_of
from andon.engines.probes import SceneProbes
from andon.glass.backdrops.distances import plane_distance, sphere_distance
from andon.glass.backdrops.environment import environment_of
from andon.glass.backdrops.paper import blur_metres
from andon.glass.backdrops.reference import sticker_at
from andon.glass.focus import Distances, LayerVergences, crossing_dioptres, layer_vergences
from andon.glass.layers import Layered
from andon.glass.load import check_eye, solids_of
from andon.glass.model import MAX_HIGHLIGHTS, Backdrop, Ball, Focus, GlassModel, Highlight, Solid
from andon.glass.paths import trace
from andon.glass.report import GlassReport
from andon.lamps import (
    AreaLamp,
    DirectionalLamp,
    HemisphereLamp,
    Lamp,
    PointLamp,
    SkyLamp,
)
from andon.lamps.kinds import middle_of_area
from andon.observer.pupil import pupil_mm
from andon.quantities import CameraFrame, photometric
from andon.rays import RayScene
from andon.scene import Scene
from andon.spaces import View, perpendicular
from andon.surface.model import SurfaceModel
from andon.transport.direct import reference as direct
from andon.transport.direct.balls.model import GlassBall
from andon.transport.direct.casters import OBJECTS, REAL, Casters, ShadowRays
from andon.transport.probes.light import probe_coefficients

__all__ = ["SceneGlass", "glass_of"]

Float = NDArray[np.float64]

# Pupil of relative scenes, which do not say how bright anything is: a lit room in the evening.
PUPIL_MM = 4.0
# How far beside a hole of the geometry its depth is looked for.
BESIDE_RADIANS = np.radians(1.0)


@dataclass(frozen=True, eq=False)
class SceneGlass:
    """Glass of a scene, ready for both engines.

    Attributes
    ----------
    model : bodies and how they are blurred.
    gaze : what the eyes are focused on over time; None: everything is sharp.
    vergences : of the layers, for the point between the eyes; None where no ray gets through.
    eyes : one or two positions (3,).
    distances : to the first body's backdrop, see `andon.glass.focus`.
    surface : geometry that lamps are hidden by, for what is mirrored.
    ambient : the light of the photograph.
    standing_lux : (3,) lx that stickers stand in beside the light of the lamps: what is left of
        E0, or the mean of the probes around the first body.
    """

    model: GlassModel
    gaze: SceneGaze | None
    vergences: LayerVergences
    eyes: tuple[Float, ...]
    distances: Distances
    surface: SurfaceModel
    ambient: Ambient
    standing_lux: Float

    @property
    def dimming(self) -> tuple[float, float, float]:
        """What is left of the light of the photograph."""
        return self.ambient.dimming

    @property
    def balls(self) -> tuple[GlassBall, ...]:
        """Bodies that bend the light of lamps."""
        return tuple(
            GlassBall(
                solid.world_from_glass[:3, 3],
                solid.shape.radius_m,
                solid.index,
                solid.absorption_per_m,
            )
            for solid in self.model.solids
            if isinstance(solid.shape, Ball) and solid.casts_light
        )

    @property
    def backdrop_m(self) -> float:
        """The paper's d_b: how far away the backdrop is, straight; infinite where there is none."""
        straight = self.vergences.background_straight
        return 1 / straight if straight > 0 else np.inf

    def paper_blur_m(self, focus: Focus | None, /) -> float:
        """The paper's D_b, by which it blurs the backdrop; 0 in the other modes."""
        if focus is None or self.model.blur != "paper":
            return 0.0
        focus_m = 1 / focus.dioptres if focus.dioptres > 0 else np.inf
        return blur_metres(self.model.pupil_m, self.backdrop_m, focus_m)

    @cached_property
    def _rays(self) -> ShadowRays:
        still = ((REAL, self.surface.occluder.geometry), (OBJECTS, self.surface.casters))
        return ShadowRays(Casters(still))

    def report(
        self, layered: Layered, focus: Focus | None, lamps: Sequence[Lamp], /
    ) -> GlassReport:
        """What is worth knowing about a frame's glass."""
        layers, is_glass = layered.layers, layered.layers.coverage > 0
        first = self.model.solids[0]
        blurs = {
            name: float(np.median(getattr(layers, f"{name}_px")[is_glass]))
            if is_glass.any()
            else 0.0
            for name in ("surface", "refracted", "reflected")
        }
        return GlassReport(
            first.name,
            focus,
            self.model.pupil_m * 1000,
            np.inf if self.gaze is None else self.gaze.limit_dioptres,
            self.vergences,
            first.interfaces,
            self._other_vergences,
            self._crossing_dioptres,
            layered.counts,
            blurs,
            max(len(self._all_highlights(lamps)) - MAX_HIGHLIGHTS, 0),
        )

    @cached_property
    def _other_vergences(self) -> LayerVergences:
        first, *rest = self.model.solids
        other = replace(first, interfaces=3 - first.interfaces)
        middle = np.mean(self.eyes, axis=0)
        return layer_vergences((other, *rest), middle, self.distances)

    @cached_property
    def _crossing_dioptres(self) -> float | None:
        if len(self.eyes) < 2:
            return None
        return crossing_dioptres(self.model.solids, (self.eyes[0], self.eyes[1]), self.distances)

    def distance_under(self, view: View, column: float, row: float, /) -> float | None:
        """Metres to what a pointer is on: what sticks to the glass, what is seen through it where
        it is clear, or what is beside it; None where there is nothing.
        """
        x, y = (
            int(np.clip(round(v), 0, n - 1))
            for v, n in zip((column, row), view.shape[::-1], strict=True)
        )
        eye, directions = view.rays_world()
        ray = directions[y, x][None]
        seen = trace(self.model.solids, eye[None], ray)
        if seen.solid[0] < 0:
            beside = float(self.distances(eye[None], ray)[0])
            return beside if np.isfinite(beside) else None
        solid, steps = self.model.solids[int(seen.solid[0])], np.zeros((1, 2, 2))
        sticks = np.isfinite(seen.uv).all() and sticker_at(solid, seen.uv, steps)[0, 3] > 0
        return float(seen.distance_m[0]) if sticks else self.backdrop_m

    def focus(self, time_seconds: float, /) -> Focus | None:
        """What is in focus at a time; None: everything."""
        return None if self.gaze is None else self.gaze.focus(time_seconds)

    def highlights(self, lamps: Sequence[Lamp], /) -> tuple[Highlight, ...]:
        """Lamps as the bodies mirror them, the brightest `MAX_HIGHLIGHTS`.

        A lamp counts with the light that it sends to a body's middle; it is mirrored by all of the
        body, or where something that stands still hides it from the middle, by none of it.
        """
        return self._all_highlights(lamps)[:MAX_HIGHLIGHTS]

    def _all_highlights(self, lamps: Sequence[Lamp]) -> tuple[Highlight, ...]:
        """The brightest first."""
        found = [
            one
            for (number, solid), lamp in product(enumerate(self.model.solids), lamps)
            if (one := self._highlight(number, solid, lamp)) is not None
        ]
        return tuple(sorted(found, key=lambda one: -float(photometric(one.light))))

    def _highlight(self, number: int, solid: Solid, lamp: Lamp) -> Highlight | None:
        middle, _ = solid.ball_around
        if isinstance(lamp, SkyLamp | HemisphereLamp):
            return None  # all around, not a highlight
        place = np.zeros(3)
        if distant := isinstance(lamp, DirectionalLamp):
            reach = -lamp.direction
        else:
            place = lamp.position_m if isinstance(lamp, PointLamp) else middle_of_area(lamp)
            reach = place - middle
        distance = float(np.linalg.norm(reach))
        if distance == 0:
            return None
        across = (reach / distance)[None]
        lux = direct.illuminance(lamp, middle[None], across)[0]
        if isinstance(lamp, AreaLamp):
            share = direct.visible_share(lamp, middle[None], across, middle[None], self._rays)[0]
        else:
            share = direct.visibility(lamp, middle[None], self._rays)[0]
        light = lux * share * (1.0 if distant else distance**2)
        if not np.all(light >= 0) or not light.any():
            return None  # light that is taken away, or none
        return Highlight(number, across[0] if distant else place, light, distant)


def glass_of(
    scene: Scene,
    frames: Mapping[str, CameraFrame],
    surface: SurfaceModel,
    ambient: Ambient,
    lamps: Sequence[Lamp],
    probes: SceneProbes | None,
    /,
) -> SceneGlass | None:
    """The glass of a scene, or None. Raises `InputError` for what does not fit."""
    if not scene.glass:
        return None
    solids = solids_of(scene)
    eyes = {name: frame.view.position for name, frame in frames.items()}
    check_eye(solids, np.array(list(eyes.values())))
    left = np.asarray(ambient.dimming) * ambient.mean_lux
    gaze = scene.gaze
    model = GlassModel(
        solids,
        blur="off" if gaze is None else gaze.blur,
        pupil_m=_pupil_mm(scene, frames, np.asarray(ambient.dimming)) / 1000,
        defocus_frame=gaze is not None and gaze.defocus == "frame",
        environment=_environments(solids, left, lamps, probes),
    )
    middle = np.mean(list(eyes.values()), axis=0)
    distances = _distances(solids[0].backdrop, middle, surface)
    vergences = layer_vergences(solids, middle, distances)
    looking = None if gaze is None else gaze_of(scene, gaze, model.blur, vergences)
    # ∫ over a half space of a mean luminance L is π·L; L is L00·Y00.
    mean = np.pi * model.environment[0, 0] * 0.5 / np.sqrt(np.pi)
    standing = left if probes is None else mean
    both = tuple(eyes.values())
    return SceneGlass(model, looking, vergences, both, distances, surface, ambient, standing)


def _pupil_mm(scene: Scene, frames: Mapping[str, CameraFrame], dimming: Float) -> float:
    """As stated, or by what the eyes are adapted to: the dimmed photograph, without lamps."""
    if scene.observer.pupil_mm is None and scene.photometry == "relative":
        return PUPIL_MM
    return pupil_mm(scene.observer, adaptation_cd_m2(scene, frames, dimming))


def _environments(
    solids: Sequence[Solid], ambient_lux: Float, lamps: Sequence[Lamp], probes: SceneProbes | None
) -> Float:
    """(n, 9, 3) what surrounds each body: what probes say of its middle, or E0 and skies."""
    if probes is None:
        return np.broadcast_to(environment_of(ambient_lux, lamps), (len(solids), 9, 3)).copy()
    middles = np.array([solid.ball_around[0] for solid in solids])
    found = np.zeros((len(solids), 9, 3))
    rows = probe_coefficients(probes.dimmed, middles)[:, :9]
    found[:, : rows.shape[1]] = rows
    return found


def _distances(backdrop: Backdrop, eye: Float, surface: SurfaceModel) -> Distances:
    """Metres from points along directions to the backdrop, inf where it is missed."""
    if backdrop.kind == "texture":

        def to_plane(origins: Float, directions: Float) -> Float:
            reach = plane_distance(backdrop, origins, directions)
            return np.where(reach > 0, reach, np.inf)

        return to_plane
    if backdrop.kind == "frame":
        return lambda origins, directions: sphere_distance(
            backdrop.distance_m, eye, origins, directions
        )
    # Thinned triangles: millimetres of backdrop are nothing to a vergence.
    geometry = surface.shadow_casters
    if not len(geometry.triangles):
        return lambda origins, directions: np.full(len(origins), np.inf)
    rays = RayScene(geometry)

    def to_geometry(origins: Float, directions: Float) -> Float:
        """Where a ray falls through a hole: the nearest of what is hit a degree beside it."""
        found = rays.first_hits(origins, directions).distance
        for row in np.flatnonzero(~np.isfinite(found)):
            right, down = perpendicular(directions[row])
            turns = BESIDE_RADIANS * np.exp(2j * np.pi * np.arange(8) / 8)[:, None]
            around = directions[row] + turns.real * right + turns.imag * down
            around /= np.linalg.norm(around, axis=1, keepdims=True)
            starts = np.broadcast_to(origins[row], around.shape)
            found[row] = rays.first_hits(starts, around).distance.min()
        return found

    return to_geometry
