"""Luminous bodies as Radiance is told them, and lamps in shells put together again.

===================== ==================================================================
body of               stands in the scene as
===================== ==================================================================
a lamp of another     diffuse on both sides, with `Body.reflectance`
an area lamp          the lamp's own tiles
a shell, exact        the tiles of its outside, lined with the shell itself, black and opaque:
                      all that is reflected *in* it is in its lamps already
an opaque shell       diffuse outside, black inside, for the same reason
a shell, the paper's  a filter of transmittance t, through which the whole lamp is seen:
                      t·I + (1 − t)·I·V is t·I behind it and I beside it
===================== ==================================================================

What this leaves out: light of a room that returns to a lamp's own shell is absorbed there instead
of reflected with 1 − t − a.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from andon.lamps import AnyAreaLamp, Body, Lamp, MeshLamp, PointLamp, SphereLamp
from andon.lamps.solids import quarters
from andon.rays import RayScene
from andon.transport.baked.radiance.lamps import is_distant_glow
from andon.transport.baked.radiance.materials import MIX_FILE, Finish, material_text
from andon.transport.baked.radiance.text import joined, polygons_text

__all__ = ["SIDE_CAL", "Standing", "standing", "unsaid"]

Float = NDArray[np.float64]

# A shell is made smaller by this at least, and by no more than the other, to be within its facets.
SMALLER, LEAST_SHARE = 0.997, 0.8
# 1 where a ray meets the side on which a triangle runs counter-clockwise.
SIDE_CAL = "mix_side = if(Rdot, 1, 0);\n"


@dataclass(frozen=True)
class Standing:
    """Lamps as they shine in Radiance, and what stands there of their bodies.

    Attributes
    ----------
    lamps : with the two of the paper's shells joined.
    opaque : names of the lamps that are also what is seen of a body.
    text : of the bodies that are no lamp's own tiles.
    """

    lamps: tuple[Lamp, ...]
    opaque: frozenset[str]
    text: str


def standing(lamps: Sequence[Lamp], bodies: Sequence[Body], /, *, black: bool) -> Standing:
    """What stands in the scene for `bodies` while `lamps` shine; `black` bodies reflect nothing."""
    own = {lamp.owner or lamp.name for lamp in lamps}
    named = {lamp.name: lamp for lamp in lamps}
    text, joined_lamps, opaque = "", dict(named), set[str]()
    for number, body in enumerate(bodies):
        name, lamp = f"body{number}", named.get(body.name)
        if isinstance(lamp, AnyAreaLamp):
            lining = "" if lamp.drawn else _lining(body, lamp, lamps, name)
            text += lining
            if not lining:
                opaque.add(body.name)
        elif isinstance(lamp, PointLamp):
            text += _filter(body, lamp, joined_lamps, name)
        else:
            text += _solid(body, name, body.name in own, black)
    return Standing(tuple(joined_lamps.values()), frozenset(opaque), text)


def _filter(body: Body, through: PointLamp, lamps: dict[str, Lamp], name: str) -> str:
    """The paper's shell, and its two lamps as one in `lamps`."""
    hidden = lamps.pop(f"{body.name}: direct", None)
    if not isinstance(hidden, PointLamp):
        return ""  # closed: all light is what it lets through
    whole = through.intensity_cd + hidden.intensity_cd
    lamps[body.name] = replace(through, intensity_cd=whole)
    share = np.divide(through.intensity_cd, whole, out=np.zeros(3), where=whole > 0)
    text = f"void trans {name} 0 0 7 {joined(share)} 0 0 1 1\n"
    return text + _triangles(body, name)


def _solid(body: Body, name: str, is_own: bool, black: bool) -> str:
    reflectance = np.zeros(3) if black else np.asarray(body.reflectance, np.float64)
    text = material_text(name, Finish(reflectance, np.zeros(3)))
    if is_own and reflectance.any():
        text += material_text(f"{name}.in", Finish(np.zeros(3), np.zeros(3)))
        text += f"void mixfunc {name}.both 4 {name} {name}.in mix_side {MIX_FILE} 0 0\n"
        name = f"{name}.both"
    return text + _triangles(body, name)


def _lining(body: Body, outside: AnyAreaLamp, lamps: Sequence[Lamp], name: str) -> str:
    """The shell itself, black, just within the few facets that emit its light.

    Facets stand for many triangles, and leave other gaps than these do; so they are *illum*, which
    the bulb's light passes, and this hides it. It is made smaller about the bulb, which sees the
    same of it. "" for a shell out of which no bulb shines.
    """
    bulbs = [x for x in lamps if x.owner == outside.owner and isinstance(x, PointLamp | SphereLamp)]
    if not bulbs or not isinstance(outside, MeshLamp):
        return ""
    place, geometry = bulbs[0].position_m, body.geometry
    facets = outside.positions_m[outside.triangles]
    # Wherever the middle of a tile may be: at 64 points of each facet.
    middles = quarters(quarters(quarters(facets))).mean(axis=1) - place
    away = np.linalg.norm(middles, axis=1)
    hits = RayScene(geometry).first_hits(np.tile(place, (len(away), 1)), middles / away[:, None])
    share = away / hits.distance  # 0 where it leaves a gap
    scale = SMALLER * float(share[share > LEAST_SHARE].min(initial=1.0))
    inner = place + scale * (geometry.positions - place)
    text = material_text(name, Finish(np.zeros(3), np.zeros(3)))
    return text + polygons_text(inner[geometry.triangles], name)


def _triangles(body: Body, name: str) -> str:
    return polygons_text(body.geometry.positions[body.geometry.triangles], name)


def unsaid(lamps: Sequence[Lamp], bodies: Sequence[Body] = (), /) -> tuple[str, ...]:
    """What frames compute otherwise than Radiance does, one sentence for each lamp; maybe none.

    In Radiance everything casts a shadow: a lamp that frames let shine through something cannot
    be said, and a sky is hidden by what stands before it.
    """
    own = {body.name for body in bodies}
    found: dict[str, str] = {}
    for lamp in lamps:
        name = lamp.owner or lamp.name
        if is_distant_glow(lamp):
            found[name] = f"{name}: surfaces hide this sky in its maps, and nothing does in frames"
            continue
        shadow = getattr(lamp, "shadow", None)
        passed = set[str]() if shadow is None else shadow.through - own - {name}
        if shadow is None:
            found[name] = f"{name}: casts no shadow in frames, but does in its maps"
        elif passed:
            names = ", ".join(sorted(passed))
            found[name] = f"{name}: shines through {names} in frames, but not in its maps"
    return tuple(found.values())
