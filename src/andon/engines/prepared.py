"""What both engines work on: a scene with its files read."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from andon.capture.dither import dithered
from andon.capture.still import frame_from_picture
from andon.composite.model import Ambient, MeasuredSurface
from andon.display.model import Exposure
from andon.engines.ambient_light import ambient_of
from andon.engines.baked_light import SceneBaked, baked_of, check_counted_once, undirected
from andon.engines.checks import check_lamps
from andon.engines.glare import SceneGlare, glare_of, with_clipped_light
from andon.engines.glass import SceneGlass, glass_of
from andon.engines.highlights import SceneHighlights, highlights_of
from andon.engines.measured import measured_of, refuse_without_photograph
from andon.engines.moment import Moment
from andon.engines.photographless import (
    ambient_without_photograph,
    sky_frames,
    white_cd_m2,
)
from andon.engines.probes import SceneProbes, changed_since_bake, probes_of
from andon.engines.reading import (
    exposure_of,
    glow_of,
    luminance_per_unit_of,
    read_pictures,
    response_of,
    source_of,
    view_of,
)
from andon.engines.real_shells import RealShells, real_shells
from andon.errors import InputError
from andon.glow.model import Glow
from andon.lamps import Body, Lamp, resolve_bodies, resolve_lamps
from andon.lamps.sources import resolve_sources
from andon.quantities import CameraFrame, Photometry, merged
from andon.scene import Scene
from andon.surface.load import load_surface
from andon.surface.model import SurfaceModel
from andon.surface.virtual import virtual_surface
from andon.transport.direct.balls import GLASS, GlassBall
from andon.transport.direct.casters import MOVERS, OBJECTS, REAL, Casters

__all__ = ["Prepared", "prepare"]

# Tables and keys that the schema has and this version does not draw; a frame says so.
LATER_TABLES: tuple[str, ...] = ()

LATER_KEYS = {
    "capture": ("depth", "pose", "noise"),
}

# Keys that only glass that somebody looks at and glare ask for, and those that only glare does.
PUPIL_KEYS = ("pupil_mm", "pupil_model")
GLARE_KEYS = {
    "capture": ("clipped_luminance_cd_m2",),
    "atmosphere": ("mist",),
    "observer": ("glasses", "glasses_dioptres"),
    "glare": ("renderer", "highlights", "halo", "needles", "adaptation"),
}


def nobody(time_seconds: float, /) -> tuple[Body, ...]:
    """No luminous bodies at any time."""
    return ()


@dataclass(frozen=True)
class Prepared:
    """A scene with its files read, or arrays in their place: ready to be drawn.

    Attributes
    ----------
    frames : view name → the light that is relit; one or two views.
    surface : geometry of the scene.
    ambient : the light of the photograph.
    lamps : time in seconds → the lamps of that moment; always the same names and kinds.
    bodies : time in seconds → the luminous bodies of that moment; always the same names and
        triangles.
    exposure : settings of the display.
    glow : of luminous bodies, or None.
    glare : in the observer's eye, of all light; never with a glow, which stands for it; or None.
    photometry : the word that every number carries.
    ignored : tables of the scene that this version does not draw.
    sources : names of the known lamps of E0, which `lamps` has with positive and negative light.
    probes : light that virtual objects stand in instead of E0, or None.
    glass : transparent bodies and what the eyes are focused on, or None.
    balls : those of them in whose shadow and caustic surfaces stand.
    highlights : how virtual objects mirror, or None: nothing does.
    baked : illuminance maps, or None: there are none, or nobody asks for them.
    undirected : lamps of the scene whose direct light is not computed, since it is in the maps.
    measured : view name → what is measured of the real surface there; without a view: nothing.
    shells : those of the bodies that stand in the photograph, or None.
    undithered : view name → what was captured, where `frames` are dithered.
    """

    frames: Mapping[str, CameraFrame]
    surface: SurfaceModel
    ambient: Ambient
    lamps: Callable[[float], tuple[Lamp, ...]]
    bodies: Callable[[float], tuple[Body, ...]] = nobody
    exposure: Exposure = field(default_factory=Exposure)
    glow: Glow | None = None
    photometry: Photometry = "absolute"
    ignored: tuple[str, ...] = ()
    sources: tuple[str, ...] = ()
    probes: SceneProbes | None = None
    glass: SceneGlass | None = None
    balls: tuple[GlassBall, ...] = ()
    glare: SceneGlare | None = None
    highlights: SceneHighlights | None = None
    baked: SceneBaked | None = None
    undirected: frozenset[str] = frozenset()
    measured: Mapping[str, MeasuredSurface] = field(default_factory=dict[str, MeasuredSurface])
    shells: RealShells | None = None
    undithered: Mapping[str, CameraFrame] = field(default_factory=dict[str, CameraFrame])

    def captured(self, view_name: str) -> CameraFrame:
        """What the camera of a view delivered."""
        return self.undithered.get(view_name, self.frames[view_name])

    def at(self, time_seconds: float) -> Moment:
        """All that moves, at a time."""
        movers = tuple(mover.at(time_seconds) for mover in self.surface.movers)
        moving = np.array([mover.middle for mover in self.surface.movers])
        lamps = self.lamps(time_seconds)
        return Moment(
            time_seconds,
            lamps,
            self.bodies(time_seconds),
            movers,
            np.concatenate([self.surface.still_middles, moving.reshape(-1, 3)]),
            None if self.glass is None else self.glass.focus(time_seconds),
            tuple(lamp for lamp in lamps if lamp.owner not in self.undirected),
        )

    def casters(self, moment: Moment) -> Casters:
        """What casts shadows at a moment."""
        surface = self.surface
        moving = [
            part
            for part, mover in zip(moment.movers, surface.movers, strict=True)
            if mover.casts_shadow
        ]
        real = [(REAL, surface.occluder.geometry)] if self.shells is None else self.shells.groups
        groups = [*real, (OBJECTS, surface.casters)]
        groups += [(MOVERS, merged(*moving))] if moving else []
        groups += [(body.name, body.geometry) for body in moment.bodies]
        return Casters(tuple(groups))


def prepare(scene: Scene, /, *, drawn: bool = True) -> Prepared:
    """Reads all that `scene` names. Raises `InputError` for whatever does not fit.

    With `drawn` False there are no frames where there is no photograph, and neither rig, white, a
    volume of probes nor illuminance maps are needed: for whoever makes light, as bakes do. Then no
    lamp flickers.
    """
    scene = scene if drawn else scene.steady()
    probes, notes = probes_of(scene) if drawn else (None, ())
    seen = _photographed if scene.has_photograph else _all_virtual
    frames, ambient, surface, measured = seen(scene, probes, drawn)
    virtual = _virtual_groups(scene, surface)
    lamps = (*resolve_lamps(scene.steady(), 0.0), *resolve_sources(scene, 0.0, virtual))
    if frames:
        eye = next(iter(frames.values())).view.position
        check_lamps(scene, lamps, surface, eye)
    baked, about_maps = (
        baked_of(scene, surface, lamps, frames, ambient, measured, has_probes=probes is not None)
        if drawn
        else (None, ())
    )
    check_counted_once(scene, probes, surface)
    shells = real_shells(surface, frames, resolve_bodies(scene.steady(), 0.0))
    notes = (*notes, *changed_since_bake(scene, probes, surface, ambient, lamps), *about_maps)
    glass = glass_of(scene, frames, surface, ambient, lamps, probes) if frames else None
    drawn_frames, about_steps = _with_noise(scene, frames)
    notes = (*notes, *about_steps)
    return Prepared(
        frames=drawn_frames,
        surface=replace(surface, notes=(*surface.notes, *notes)),
        ambient=ambient,
        lamps=_lamps_of(scene, virtual, shells),
        bodies=lambda time_seconds: resolve_bodies(scene, time_seconds),
        exposure=exposure_of(scene),
        glow=glow_of(scene),
        photometry=scene.photometry,
        ignored=_ignored(scene),
        sources=tuple(table.name for table in scene.ambient.source) if scene.ambient else (),
        probes=probes,
        glass=glass,
        balls=() if glass is None else glass.balls,
        glare=glare_of(scene, frames, np.asarray(ambient.dimming)) if frames else None,
        highlights=highlights_of(scene, surface),
        baked=baked,
        undirected=undirected(scene),
        measured=measured,
        shells=shells,
        undithered=frames if scene.display.dither else {},
    )


def _lamps_of(
    scene: Scene, virtual: frozenset[str], shells: RealShells | None
) -> Callable[[float], tuple[Lamp, ...]]:
    def lamps(time_seconds: float) -> tuple[Lamp, ...]:
        own = resolve_lamps(scene, time_seconds)
        all_ = (*own, *resolve_sources(scene, time_seconds, virtual))
        return all_ if shells is None else shells.shining(all_)

    return lamps


_Seen = tuple[dict[str, CameraFrame], Ambient, SurfaceModel, dict[str, MeasuredSurface]]


def _all_virtual(scene: Scene, probes: SceneProbes | None, drawn: bool) -> _Seen:
    """Frames, light and surface of a scene without a photograph."""
    refuse_without_photograph(scene)
    ambient = ambient_without_photograph(scene)
    lamps = resolve_lamps(scene.steady(), 0.0)
    frames = sky_frames(scene, lamps, white_cd_m2(scene, ambient, lamps)) if drawn else {}
    return frames, ambient, virtual_surface(scene), {}


def _photographed(scene: Scene, probes: SceneProbes | None, drawn: bool) -> _Seen:
    """Frames, light and surface of a photograph."""
    pictures = read_pictures(scene)
    views = {name: view_of(scene, name, picture.shape) for name, picture in pictures.items()}
    surface = load_surface(scene, views)
    if not drawn and scene.ambient is not None and scene.ambient.probes:
        raise InputError(
            "is light that a bake does not have yet",
            file=scene.file,
            field="ambient.probes",
            remedy="state ambient.illuminance_lux for the bake",
        )
    ambient, notes = ambient_of(scene, views, surface, probes)
    per_unit = luminance_per_unit_of(scene, ambient)
    frames = {
        name: frame_from_picture(
            picture,
            views[name],
            response_of(scene, picture),
            luminance_per_unit=per_unit,
            file=source_of(scene, name)[0],
        )
        for name, picture in pictures.items()
    }
    frames = {name: with_clipped_light(scene, frame) for name, frame in frames.items()}
    measured, on_maps = measured_of(scene, views, frames, ambient, surface)
    surface = replace(surface, notes=(*surface.notes, *notes, *on_maps))
    return frames, ambient, surface, measured


def _with_noise(
    scene: Scene, frames: dict[str, CameraFrame]
) -> tuple[dict[str, CameraFrame], tuple[str, ...]]:
    """The frames, dithered where the scene asks for it, and what to say of it."""
    if not scene.display.dither:
        return frames, ()
    notes: tuple[str, ...] = ()
    if not any(frame.code_step for frame in frames.values()):
        notes = ("display.dither changes nothing: light in floats has no steps",)
    return {name: dithered(frame) for name, frame in frames.items()}, notes


def _virtual_groups(scene: Scene, surface: SurfaceModel) -> frozenset[str]:
    """Caster groups that the photograph did not have: virtual objects, and bodies of lamps."""
    bodies = [body.name for body in resolve_bodies(scene, 0.0) if not body.real]
    still = [OBJECTS] if len(surface.casters.triangles) else []
    moving = [MOVERS] if any(mover.casts_shadow for mover in surface.movers) else []
    glass = [GLASS] if any(table.shape == "sphere" for table in scene.glass) else []
    return frozenset([*bodies, *still, *moving, *glass])


def _ignored(scene: Scene) -> tuple[str, ...]:
    """Tables and keys that the scene states and this version does not draw."""
    tables = [name for name in LATER_TABLES if getattr(scene, name)]
    has_glass = bool(scene.glass)
    tables += ["gaze"] if scene.gaze is not None and not has_glass else []
    has_glare = scene.glare is not None and scene.glare.model != "glow"
    later: dict[str, tuple[str, ...]] = dict(LATER_KEYS)
    for table, names in () if has_glare else GLARE_KEYS.items():
        later[table] = (*later.get(table, ()), *names)
    of_eye = () if has_glass or has_glare else PUPIL_KEYS
    of_eye += () if has_glass or scene.glare is not None else ("age", "pigment")
    later["observer"] = (*later.get("observer", ()), *of_eye)
    keys: list[str] = []
    for table, names in later.items():
        stated = getattr(scene, table)
        keys += [f"{table}.{n}" for n in names if stated and n in stated.model_fields_set]
    return (*tables, *keys)
