"""Light probes of a scene: its volume read, its light chosen, and E0 by them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from shlex import quote
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from andon.composite.model import Ambient
from andon.engines.baked import BakeFacts, changes, dimming_of, facts_of, facts_of_notes
from andon.errors import InputError
from andon.files.volumes import ProbeVolume, read_volume
from andon.harmonics import irradiance
from andon.lamps import Lamp
from andon.quantities import Surface
from andon.scene import Scene
from andon.scene.probes import Probes
from andon.surface.model import SurfaceModel
from andon.transport.probes.light import (
    ProbeLight,
    probe_coefficients,
    probe_illuminance,
    probe_light,
)

__all__ = [
    "NO_LAMPS",
    "PROBES",
    "SceneProbes",
    "changed_since_bake",
    "lampless_pixels",
    "light_of_volume",
    "lit_pixels",
    "probes_of",
    "taking",
]

Float = NDArray[np.float64]

# Of taking.wgsl.
NO_LAMPS, PROBES = 1, 2


@dataclass(frozen=True, eq=False)
class SceneProbes:
    """Light of probes, ready for both engines.

    Attributes
    ----------
    light : the volume's, in the state that is seen.
    lookup : where light is looked up: at each pixel, or once for each object.
    captured : names of sky and hemisphere lamps whose light is in the probes.
    dimming : (3,) share of their light that is left; 1 where it was baked with the dimming of E0.
    baked : what the states that are seen were baked from, as far as the volume says it.
    """

    light: ProbeLight
    lookup: Literal["pixel", "object"] = "pixel"
    captured: frozenset[str] = frozenset()
    dimming: tuple[float, float, float] = (1.0, 1.0, 1.0)
    baked: tuple[BakeFacts, ...] = ()

    @property
    def dimmed(self) -> ProbeLight:
        """The light that is left."""
        return replace(self.light, coefficients=self.light.coefficients * np.array(self.dimming))

    def standing_lux(self, seen: Surface, model: SurfaceModel, middles: Float) -> Float | None:
        """(H, W, 3) lux that objects lit by probes stand in, dimmed; NaN elsewhere.

        `middles` (objects, 3) are theirs, metres. None: there is no such pixel.
        """
        lit = lit_pixels(seen, model)
        if not lit.any():
            return None
        lux, light = np.full((*seen.view.shape, 3), np.nan), self.dimmed
        normals = seen.normal[lit]
        if self.lookup == "pixel":
            lux[lit] = probe_illuminance(light, seen.position[lit], normals)
        else:
            owners = model.object_of_slot[seen.material_id[lit]]
            rows = probe_coefficients(light, middles)
            for owner in np.unique(owners):
                own = owners == owner
                at = np.flatnonzero(lit.ravel())[own]
                lux.reshape(-1, 3)[at] = np.maximum(irradiance(rows[owner], normals[own]), 0)
        return lux


def lit_pixels(seen: Surface, model: SurfaceModel, /) -> NDArray[np.bool_]:
    """(H, W): a virtual object that probes light; luminous bodies are none."""
    return _pixels_of(seen, model, [info.lit_by_probes for info in model.objects_table])


def lampless_pixels(seen: Surface, model: SurfaceModel, /) -> NDArray[np.bool_]:
    """(H, W): a virtual object that lamps do not light."""
    return _pixels_of(seen, model, [not info.lit_by_lamps for info in model.objects_table])


def _pixels_of(seen: Surface, model: SurfaceModel, chosen: list[bool]) -> NDArray[np.bool_]:
    own = seen.is_object & seen.valid
    if seen.body_id is not None:
        own = own & (seen.body_id < 0)
    result = np.zeros(own.shape, bool)
    if any(chosen):
        result[own] = np.array(chosen)[model.object_of_slot[seen.material_id[own]]]
    return result


def taking(model: SurfaceModel, *, has_probes: bool) -> NDArray[np.uint8]:
    """(slots,) what light the materials of virtual objects take, as taking.wgsl has it."""
    rows = [
        NO_LAMPS * (not info.lit_by_lamps) + PROBES * (has_probes and info.lit_by_probes)
        for info in model.objects_table
    ]
    return np.array(rows, np.uint8)[model.object_of_slot]


def probes_of(scene: Scene, /) -> tuple[SceneProbes | None, tuple[str, ...]]:
    """The probes that a frame of `scene` needs, or None; and what is to be said of them."""
    table = scene.probes
    wanted = any(entry.lit_by_probes for entry in scene.object) or not scene.has_photograph
    wanted |= scene.ambient is not None and scene.ambient.probes
    if table is None or not wanted:
        return None, ()
    path = scene.path(table.volume, "probes.volume")
    if not path.exists():
        raise InputError(
            f"there is no file {table.volume} yet",
            file=scene.file,
            field="probes.volume",
            remedy=f"andon probes bake {scene.file} writes it; or leave [probes] out",
        )
    volume = read_volume(path)
    _check_photometry(scene, volume)
    try:
        light = light_of_volume(volume, table)
    except InputError as error:
        field = error.field or "volume"
        field = field if field.startswith("probes.") else f"probes.{field}"
        remedy = _adding(error, scene, table)
        raise InputError(error.rule, file=scene.file, field=field, remedy=remedy) from error
    notes: tuple[str, ...] = ()
    if table.visibility and light.walls is None:
        notes = (f"{path.name} holds no distances: walls hide no probes; bake it with visibility",)
    baked = _baked(volume, table)
    captured = _captured(scene, baked)
    return SceneProbes(light, table.lookup, captured, _left(scene, baked), baked), notes


def _check_photometry(scene: Scene, volume: ProbeVolume) -> None:
    if volume.photometry != scene.photometry:
        raise InputError(
            f"holds {volume.photometry} light, and the scene is {scene.photometry}",
            file=scene.file,
            field="probes.volume",
            remedy="state scene.photometry as it was baked, or bake it again",
        )


def _baked(volume: ProbeVolume, table: Probes) -> tuple[BakeFacts, ...]:
    """Of the states that are seen, as far as the volume says it."""
    states = [table.state or next(iter(volume.states))]
    if table.blend_state is not None and table.blend > 0:
        states.append(table.blend_state)
    found = (facts_of_notes(volume.notes, state) for state in states)
    return tuple(facts for facts in found if facts is not None)


def _captured(scene: Scene, baked: Sequence[BakeFacts]) -> frozenset[str]:
    """Lamps of the scene that are in the probes; what the volume does not say, the lamps do.

    With E0 by probes the volume is another scene's, and all lamps of this one are added.
    """
    if scene.ambient is not None and scene.ambient.probes:
        return frozenset()
    skies = [lamp for lamp in scene.lamp if lamp.kind in ("sky", "hemisphere")]
    if baked:
        names = frozenset(name for facts in baked for name in facts.sky)
        return names & {lamp.name for lamp in skies}
    return frozenset(lamp.name for lamp in skies if lamp.in_probes)


def _left(scene: Scene, baked: Sequence[BakeFacts]) -> tuple[float, float, float]:
    """The share of the volume's light that is left.

    What is known to be baked has the dimming of its scene in it, and lamps' light, which none dims.
    Other volumes hold real light, as do those that E0 is taken from.
    """
    by_probes = scene.ambient is not None and scene.ambient.probes
    return dimming_of(scene) if by_probes or not baked else (1.0, 1.0, 1.0)


def changed_since_bake(
    scene: Scene,
    probes: SceneProbes | None,
    surface: SurfaceModel,
    ambient: Ambient,
    lamps: Sequence[Lamp],
    /,
) -> tuple[str, ...]:
    """What is to be said if `scene` is not the one that its probes were baked from.

    `lamps` are all, at the start of the session. A volume for E0 is of another scene anyway.
    """
    by_probes = scene.ambient is not None and scene.ambient.probes
    if probes is None or not probes.baked or by_probes:
        return ()
    found = changes(facts_of(scene, surface, ambient, lamps), probes.baked)
    if not found:
        return ()
    return (
        f"the scene has changed since its probes were baked: {', '.join(found)}; andon probes bake "
        f"{scene.file} renews them",
    )


def _adding(error: InputError, scene: Scene, table: Probes) -> str | None:
    """How a state comes into the volume that it does not have."""
    name = {"state": table.state, "blend_state": table.blend_state}.get(error.field or "")
    if name is None:
        return error.remedy
    adds = f"andon probes bake {scene.file} --state {quote(name)} adds it"
    return f"{error.remedy} Or {adds}" if error.remedy else adds


def light_of_volume(volume: ProbeVolume, table: Probes, /) -> ProbeLight:
    """A volume as the table wants it seen: state, zones, smoothing, walls."""
    return probe_light(
        volume,
        state=table.state,
        blend_state=table.blend_state,
        blend=table.blend,
        zones=table.zones,
        dering=table.dering,
        visibility=table.visibility,
    )
