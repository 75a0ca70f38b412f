"""Baked light of a scene: its illuminance maps found, checked against the scene, and read late.

Who takes it
    The real surface, and every virtual object that lamps light. An object that probes light has
    what surfaces reflect from them; of lamps that the probes have captured it takes no maps of
    reflected light, which would count twice.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from shlex import quote

import numpy as np
from numpy.typing import NDArray

from andon.composite.model import Ambient, MeasuredSurface
from andon.engines.digest import digest
from andon.engines.probes import SceneProbes, lampless_pixels, lit_pixels
from andon.errors import InputError
from andon.files.illuminance_maps import MANIFEST, Manifest, Part, read_manifest, read_moment
from andon.lamps import Lamp, resolve_lamps
from andon.lamps.flickering import flicker_factor
from andon.quantities import CameraFrame, Surface
from andon.scene import Scene
from andon.surface.model import SurfaceModel, states_reflectance
from andon.transport.baked.model import BakedLight, BakedMoment, BakedSeen
from andon.transport.baked.reference import illuminance_at
from andon.transport.baked.rims import with_rims

__all__ = [
    "SceneBaked",
    "baked_of",
    "check_counted_once",
    "map_facts",
    "part_of",
    "undirected",
]

Float = NDArray[np.float64]

# Moments whose maps are kept: those around now, and those of a frame before.
KEPT_MOMENTS = 4
# Digits of a digest that are kept: nobody makes two scenes alike on purpose.
DIGITS = 16
# Of the moments of a film so many are compared.
LOOKED_AT = 24
# What is said of facts; of others their name.
WORDS = {
    "geometry": "what stands in it",
    "movement": "how things move in it",
    "reflectance": "the photograph, or E0",
}


@dataclass(frozen=True, eq=False)
class SceneBaked:
    """Baked light, and which things take it.

    Attributes
    ----------
    light : the maps.
    in_probes : objects that probes light take none of it: they have it from the probes.
    """

    light: BakedLight
    in_probes: bool = False

    def asked(self, surface: Surface, model: SurfaceModel, /) -> NDArray[np.bool_]:
        """(H, W) which pixels take baked light."""
        asked = surface.valid & ~lampless_pixels(surface, model)
        if surface.body_id is not None:
            asked &= surface.body_id < 0
        return asked & ~lit_pixels(surface, model) if self.in_probes else asked

    def seen(self, surface: Surface, model: SurfaceModel, time_seconds: float, /) -> BakedSeen:
        """What the maps give to a view's surface at one time."""
        asked = self.asked(surface, model)
        lux, covered = np.zeros((*surface.view.shape, 3)), np.zeros(surface.view.shape, bool)
        there = surface.valid
        lux[there], covered[there] = illuminance_at(
            self.light, time_seconds, surface.position[there], surface.normal[there]
        )
        lux = with_rims(lux, covered, surface, self.light.depth_tolerance_m)
        return BakedSeen(np.where(asked[..., None], lux, 0.0), covered & asked, asked)


def undirected(scene: Scene, /) -> frozenset[str]:
    """Lamps whose light is baked as a whole."""
    return frozenset(table.name for table in scene.lamp if table.transport == "baked")


def part_of(transport: str, /) -> Part | None:
    """What of a lamp's light the maps hold; None: it is in none."""
    parts: dict[str, Part | None] = {"direct": None, "baked": "all", "direct+bounce": "bounce"}
    return parts[transport]


def check_counted_once(scene: Scene, probes: SceneProbes | None, model: SurfaceModel, /) -> None:
    """Raises `InputError` where an object would get the same light from probes and from maps."""
    if probes is None or not any(info.lit_by_probes for info in model.objects_table):
        return
    own = [table for table in scene.lamp if table.transport != "direct"]
    twice = [table.name for table in own if table.in_probes]
    whole = next((t.name for t in own if t.transport == "baked" and t.in_probes), None)
    if whole is None and (not twice or len(twice) == len(own)):
        return
    raise InputError(
        f"the reflected light of {whole or twice[0]!r} is in the maps and in the probes, and "
        "objects that probes light would get it twice",
        file=scene.file,
        field="lamp.in_probes",
        remedy="state in_probes = false for baked lamps, or lit_by_probes = false for objects",
    )


def baked_of(
    scene: Scene,
    surface: SurfaceModel,
    lamps: Sequence[Lamp],
    frames: Mapping[str, CameraFrame],
    ambient: Ambient,
    measured: Mapping[str, MeasuredSurface],
    /,
    *,
    has_probes: bool,
) -> tuple[SceneBaked | None, tuple[str, ...]]:
    """The maps that [baked] names, or None; and what is to be said of them.

    `lamps` are all of the scene, at its start; `frames`, `ambient` and `measured` those of
    `Prepared`; `has_probes`: objects may be lit by probes. Raises `InputError` where there are none
    yet, where one lacks a lamp of the scene, and where they hold other light than the scene asks
    for.
    """
    table = scene.baked
    if table is None or not table.lamps:
        return None, ()
    folder = scene.path(table.folder, "baked.folder")
    if not (folder / MANIFEST).exists():
        raise InputError(
            f"there are no illuminance maps in {table.folder} yet",
            file=scene.file,
            field="baked.folder",
            remedy=f"andon bake {quote(str(scene.file))} makes them",
        )
    manifest = read_manifest(folder)
    parts = _parts(scene, manifest)
    light = BakedLight(
        moments=tuple(manifest.moments),
        load=_loader(folder, manifest, tuple(parts)),
        shares=lambda time_seconds: _shares(scene, time_seconds),
        parts=parts,
        mode=table.mode,
        depth_tolerance_m=table.depth_tolerance_m,
        photometry=scene.photometry,
    )
    in_probes = has_probes and any(lamp.in_probes for lamp in scene.lamp if lamp.name in parts)
    now = map_facts(
        scene,
        surface,
        lamps,
        moments=manifest.moments,
        frames=frames,
        ambient=ambient,
        measured=measured,
    )
    return SceneBaked(light, in_probes), _changes(scene, manifest, now)


def _parts(scene: Scene, manifest: Manifest) -> dict[str, Part]:
    """What of each lamp is asked of the maps; they must hold that."""
    if manifest.photometry != scene.photometry:
        raise InputError(
            f"holds {manifest.photometry} light, and the scene is {scene.photometry}",
            file=scene.file,
            field="baked.folder",
            remedy="state scene.photometry as it was baked, or bake again",
        )
    held = {lamp.name: lamp.part for lamp in manifest.lamps}
    parts: dict[str, Part] = {}
    again = f"bake again: andon bake {quote(str(scene.file))}"
    for index, lamp in enumerate(scene.lamp):
        part = part_of(lamp.transport)
        if part is None:
            continue
        field = f"lamp[{index}].transport"
        if lamp.name not in held:
            raise InputError(
                f"the maps do not have the lamp {lamp.name!r}",
                file=scene.file,
                field=field,
                remedy=again,
            )
        if held[lamp.name] != part:
            words = {"all": "all light", "bounce": "the reflected light alone"}
            raise InputError(
                f"{lamp.transport!r} asks for {words[part]} of {lamp.name!r}, and the maps hold "
                f"{words[held[lamp.name]]}",
                file=scene.file,
                field=field,
                remedy=again,
            )
        parts[lamp.name] = part
    return parts


def _loader(
    folder: Path, manifest: Manifest, names: tuple[str, ...]
) -> Callable[[int], BakedMoment]:
    """Number of a moment → its maps, of which a few are kept."""

    @lru_cache(maxsize=KEPT_MOMENTS)
    def load(index: int) -> BakedMoment:
        maps = read_moment(folder, manifest, index, lamps=names)
        return BakedMoment(manifest.moments[index], maps)

    return load


def _shares(scene: Scene, time_seconds: float) -> Mapping[str, float]:
    """Flicker of each baked lamp at a time, which maps do not have."""
    return {
        table.name: flicker_factor(scene, f"lamp[{index}]", table, time_seconds)
        for index, table in enumerate(scene.lamp)
        if table.transport != "direct"
    }


def map_facts(
    scene: Scene,
    surface: SurfaceModel,
    lamps: Sequence[Lamp],
    /,
    *,
    moments: Sequence[float] = (0.0,),
    frames: Mapping[str, CameraFrame] | None = None,
    ambient: Ambient | None = None,
    measured: Mapping[str, MeasuredSurface] | None = None,
) -> dict[str, str]:
    """What illuminance maps depend on, as texts; how a shadow map is drawn does not count.

    =============== ==============================================================================
    ``geometry``    what stands there, and what moves at the start
    ``movement``    where what moves is at some of the moments; only where something does
    ``reflectance`` what a photograph shows of a surface that states none: its light less E0
    ``lamp <name>`` each lamp, at the same moments
    =============== ==============================================================================

    Parameters
    ----------
    lamps : all of the steady scene, at its start.
    moments : of the maps.
    frames, ambient, measured : the photograph, the light that it was taken in, and what else is
        known of its surface.
    """
    parts = [part for part in (surface.real, surface.objects) if len(part.triangles)]
    times = _some(moments)
    later = [mover.at(time) for mover in surface.movers for time in times[1:]]
    movement = digest([[part.positions, part.normals] for part in later], single=True)
    # Last: what is asked of movers later is where they are now.
    moving = [mover.at(times[0]) for mover in surface.movers]
    facts = {"geometry": digest(parts, moving, single=True)[:DIGITS]}
    if later:
        facts["movement"] = movement[:DIGITS]
    if frames and ambient is not None and _is_photographed(surface):
        facts["reflectance"] = _reflectance(frames, ambient, measured or {})
    every = [*lamps, *_lamps_later(scene, times[1:])]
    for table in scene.lamp:
        if table.transport != "direct":
            own = [_unshadowed(lamp) for lamp in every if lamp.owner == table.name]
            facts[f"lamp {table.name}"] = digest(own, single=True)[:DIGITS]
    return facts


def _some(moments: Sequence[float]) -> list[float]:
    """The first and last moment and some between: a film has thousands."""
    count = min(len(moments), LOOKED_AT)
    return [moments[round(n)] for n in np.linspace(0, len(moments) - 1, count).tolist()]


def _is_photographed(surface: SurfaceModel) -> bool:
    """Whether the real surface has its reflectance from the photograph."""
    return len(surface.real.triangles) > 0 and not states_reflectance(surface.real)


def _reflectance(
    frames: Mapping[str, CameraFrame],
    ambient: Ambient,
    measured: Mapping[str, MeasuredSurface],
) -> str:
    """The name of what the photograph shows of surfaces; E0 and exposure may go up together."""
    known = [part.reflectance for part in measured.values() if part.reflectance is not None]
    shown = [
        [
            name,
            frame.view,
            np.pi * frame.luminance_per_unit * frame.linear / ambient.lux_of(name),
        ]
        for name, frame in frames.items()
    ]
    return digest(shown, *known, single=True)[:DIGITS]


def _lamps_later(scene: Scene, times: Sequence[float]) -> list[Lamp]:
    """Those of moving tables, at later times."""
    moving = {table.name for table in scene.lamp if table.key or table.path is not None}
    if not moving:
        return []
    steady = scene.steady()
    return [lamp for time in times for lamp in resolve_lamps(steady, time) if lamp.owner in moving]


def _unshadowed(lamp: Lamp) -> Lamp:
    """The lamp without the settings of its shadow maps."""
    shadow = getattr(lamp, "shadow", None)
    if shadow is None:
        return lamp
    plain = type(shadow)(through=shadow.through, near_m=shadow.near_m)
    return replace(lamp, shadow=plain)  # type: ignore[call-arg]


def _changes(scene: Scene, manifest: Manifest, now: Mapping[str, str]) -> tuple[str, ...]:
    """What is otherwise than when the maps were made."""
    then = manifest.facts
    changed = [fact for fact, value in now.items() if fact in then and then[fact] != value]
    if not changed:
        return ()
    words = [WORDS.get(fact, f"the {fact}") for fact in changed]
    return (
        f"changed since the maps were baked: {', '.join(words)}; "
        f"andon bake {quote(str(scene.file))}",
    )
