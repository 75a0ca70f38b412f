"""Real lamps that are part of E0: what virtual things hide of them, and what goes when they go.

The photograph holds the light of its own lamps, shadows of the real things included. A virtual
object in the way takes some of it back, so ΔE gets

    dimming · E_source · (V_all − V_real)        a source that stays
    dimming · E_source · (      − V_real)        a source that is switched off

with V_real the visibility among the real surfaces and V_all among these and the virtual ones. Both
are ordinary lamps, one of positive and one of negative light, so that they have every form, every
distribution and every shadow that lamps have, and cancel where nothing virtual stands between.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.lamps.areas import SphereLamp, TubeLamp
from andon.lamps.kinds import Lamp, brightened
from andon.lamps.model import PointLamp
from andon.lamps.resolve import resolve_tables

if TYPE_CHECKING:
    from andon.scene import Scene

__all__ = ["known_sources", "resolve_sources", "scaled"]

# Ends of the names of a source's two lamps.
NOW, BEFORE = ", now", ", before"

Float = NDArray[np.float64]

# Of a real lamp's own body around its samples, and the least of it in metres: glass, housing.
OWN_BODY, LEAST_EXTENT_M = 1.05, 0.02


def resolve_sources(
    scene: Scene, time_seconds: float, virtual: Iterable[str], /
) -> tuple[Lamp, ...]:
    """What the known sources of E0 add to ΔE, and take away, as lamps.

    `virtual` are the caster groups that were not there when the photograph was taken; without any
    a source that stays changes nothing and gives no lamp.
    """
    ambient, groups = scene.ambient, frozenset(virtual)
    if ambient is None or not ambient.source:
        return ()
    if ambient.dimming_mode == "paper":
        raise InputError(
            "sources are light, and 'paper' does not dim light but codes",
            file=scene.file,
            field="ambient.dimming_mode",
            remedy="use 'linear', or state no sources",
        )
    dimming = np.broadcast_to(np.asarray(ambient.dimming, float), 3)
    lamps: list[Lamp] = []
    for lamp in known_sources(scene, time_seconds):
        shadow = getattr(lamp, "shadow", None)
        if lamp.owner not in ambient.removed:
            if shadow is None or not groups:
                continue
            lamps.append(scaled(lamp, dimming, name=lamp.name + NOW, shadow=shadow))
        changes: dict[str, Any] = {"name": lamp.name + BEFORE}
        if shadow is not None:
            changes["shadow"] = replace(shadow, through=shadow.through | groups)
        lamps.append(scaled(lamp, -dimming, **changes))
    return tuple(lamps)


def known_sources(scene: Scene, time_seconds: float, /) -> tuple[Lamp, ...]:
    """The known sources of E0 as lamps of their own light, whose own bodies do not hide them."""
    if scene.ambient is None:
        return ()
    known = scene.model_copy(update={"lamp": scene.ambient.source})
    lamps: list[Lamp] = []
    for lamp in resolve_tables(known, time_seconds, "ambient.source"):
        shadow = getattr(lamp, "shadow", None)
        own = {} if shadow is None else {"shadow": replace(shadow, near_m=_own_extent_m(lamp))}
        lamps.append(replace(lamp, **own))
    return tuple(lamps)


def _own_extent_m(lamp: Lamp) -> float:
    """How far from its samples the real lamp's own body may reach, which does not hide it."""
    thick = 0.0
    if isinstance(lamp, SphereLamp | TubeLamp):
        thick = 2 * lamp.radius_m  # samples lie inside: the far side of the glass is that far
    elif isinstance(lamp, PointLamp):
        thick = lamp.visible_radius_m
    return max(LEAST_EXTENT_M, OWN_BODY * thick)


def scaled(lamp: Lamp, factor: Float, /, **changes: Any) -> Lamp:
    """`lamp` with `factor` (3,) times its light, not drawn, and with other `changes`."""
    for key, unseen in (("visible_radius_m", 0.0), ("drawn", False)):
        if hasattr(lamp, key):
            changes[key] = unseen
    return brightened(lamp, factor, **changes)
