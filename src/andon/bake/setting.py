"""What a bake begins with: what probes see, and which passes over them there are."""

from __future__ import annotations

from andon.engines.cubes import CubeSetting, cube_setting
from andon.engines.prepared import prepare
from andon.errors import InputError
from andon.scene import Scene
from andon.scene.probes import Probes
from andon.transport.probes.placement import Placed

__all__ = ["passes_of", "seen_setting", "unscaled_of"]


def unscaled_of(probes: Probes) -> tuple[str, ...]:
    """Panoramas of which nobody says how bright their 1 is."""
    own = [p for p in probes.place if p.panorama and "luminance_per_unit" not in p.model_fields_set]
    return tuple(dict.fromkeys(str(place.panorama) for place in own))


def passes_of(setting: CubeSetting | None, bounces: int) -> range:
    """Bounces for which probes light surfaces: from 1 where something emits, else from 2."""
    if setting is None or not (setting.emits or setting.lamps):
        return range(0)
    return range(1 if setting.emits else 2, bounces + 1)


def seen_setting(scene: Scene, placed: Placed) -> CubeSetting | None:
    """What is seen; None where there is nothing, and all probes are panoramas."""
    nothing = scene.surface is None and not scene.object
    if nothing and all(panorama is not None for panorama in placed.panoramas):
        return None
    if scene.has_photograph and scene.ambient is not None and scene.ambient.probes:
        raise InputError(
            "is the light that a bake is to find",
            file=scene.file,
            field="ambient.probes",
            remedy="bake a scene without [capture] source, with a surface.mesh and the lamps of "
            "the photograph as [[lamp]]",
        )
    return cube_setting(scene, prepare(scene, drawn=False))
