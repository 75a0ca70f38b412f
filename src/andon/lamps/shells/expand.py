"""One lamp in a shell becomes several ordinary lamps and a body."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from andon.lamps.areas import SOFT_SHADOW, MeshLamp, PolygonLamp, SphereLamp
from andon.lamps.bodies import Body
from andon.lamps.kinds import Lamp
from andon.lamps.model import PointLamp, Shadow
from andon.lamps.shells.beams import beam_of
from andon.lamps.shells.exact import Solution, solve_shell
from andon.lamps.shells.form import Form, form_of
from andon.lamps.shells.inside import inside_illuminance
from andon.lamps.shells.model import Shell

__all__ = ["expand"]

# An opening is smaller than its shell, and its light comes on top of the bulb's.
LID_SAMPLES = 8

Float = NDArray[np.float64]


def expand(
    lamp: PointLamp, shell: Shell, /, *, groups: Iterable[str] = ()
) -> tuple[tuple[Lamp, ...], Body]:
    """The lamps that together light a room as `lamp` in `shell` does, and the body that is seen.

    The body has the lamp's name, and so has the caster group of its triangles.

    ======= ==================================== ============================================
    mode    through the shell                    through its openings
    ======= ==================================== ============================================
    exact   ``name``: the outside, an area lamp  ``name: bulb`` I, hidden by the shell, and a
                                                 lid ``name: opening 1``… each (of a shell of
                                                 several parts: ``name: gaps``) for what is
                                                 reflected inside
    paper   ``name``: t·I that the shell does    ``name: direct`` (1 − t)·I, hidden by the
            not hide                             shell
    ======= ==================================== ============================================

    Parameters
    ----------
    lamp : in the middle of what the shell calls its origin.
    shell : moves with the lamp; what is computed from it is kept.
    groups : all other caster groups. A lamp without a shadow shines through these, but never
        through its own shell.

    Raises
    ------
    InputError
        if the mesh is no shell around the lamp.
    """
    form = form_of(shell)
    if shell.mode == "paper":
        return _paper(lamp, shell, form, groups)
    solution = solve_shell(shell, beam_of(lamp))
    lamps: list[Lamp] = []
    if shell.transmittance.any():
        lamps.append(_outside(lamp, shell, form, solution))
    if form.is_open:
        lamps.append(_bulb(lamp, groups))
        if (shell.transmittance + shell.absorptance).min() < 1:
            lamps += _openings(lamp, form, solution, groups)
    body = _body(lamp, shell, form, solution.outside_cd_m2, solution.inside_cd_m2)
    return tuple(lamps), body


def _paper(
    lamp: PointLamp, shell: Shell, form: Form, groups: Iterable[str]
) -> tuple[tuple[Lamp, ...], Body]:
    lamps: list[Lamp] = []
    t = shell.transmittance
    if t.any():
        through = replace(lamp, intensity_cd=t * lamp.intensity_cd, visible_radius_m=0.0)
        lamps.append(replace(through, shadow=_through(lamp.shadow, {lamp.name})))
    if form.is_open and (t < 1).any():
        lamps.append(_hidden(lamp, "direct", (1 - t) * lamp.intensity_cd, groups))
    luminance = inside_illuminance(form.drawn, beam_of(lamp))[:, None] * t / np.pi
    # The paper says nothing about the inside: thin paper scatters as much back as through.
    return tuple(lamps), _body(lamp, shell, form, luminance, luminance)


def _body(lamp: PointLamp, shell: Shell, form: Form, outside: Float, inside: Float) -> Body:
    return Body(
        lamp.name,
        replace(form.drawn, positions=form.drawn.positions + lamp.position_m),
        outside * lamp.intensity_cd,
        inside * lamp.intensity_cd,
        shell.reflectance,
        shell.real,
        shell.margin_m,
        form.covers + lamp.position_m,
    )


def _through(shadow: Shadow | None, groups: Iterable[str]) -> Shadow | None:
    return None if shadow is None else replace(shadow, through=shadow.through | set(groups))


def _soft(lamp: PointLamp, samples: int = SOFT_SHADOW.samples) -> Shadow | None:
    """The shadow of an area that stands for `lamp` and that its own shell does not hide."""
    if lamp.shadow is None:
        return None
    kind = "linear" if lamp.shadow.filter == "exact" else lamp.shadow.filter
    through = lamp.shadow.through | {lamp.name}
    return replace(SOFT_SHADOW, filter=kind, samples=samples, through=through)


def _outside(lamp: PointLamp, shell: Shell, form: Form, solution: Solution) -> Lamp:
    if shell.radius_m is not None and type(lamp) is PointLamp:
        luminance = shell.transmittance * lamp.intensity_cd / (np.pi * shell.radius_m**2)
        return SphereLamp(
            lamp.name, luminance, lamp.position_m, shell.radius_m, shadow=_soft(lamp), drawn=False
        )
    luminance = solution.facet_cd_m2 * lamp.intensity_cd
    return MeshLamp(
        lamp.name,
        luminance.mean(axis=0),
        form.facets.reshape(-1, 3) + lamp.position_m,
        np.arange(3 * len(form.facets), dtype=np.int32).reshape(-1, 3),
        luminance,
        form.facet_groups,
        shadow=_soft(lamp),
        drawn=False,
    )


def _bulb(lamp: PointLamp, groups: Iterable[str]) -> Lamp:
    """What shines through the openings; a bulb of a stated size that shines to all sides is a ball,
    and the rim of its shell casts a soft shadow."""
    hidden = _hidden(lamp, "bulb", lamp.intensity_cd, groups)
    radius = lamp.visible_radius_m
    if type(lamp) is not PointLamp or radius <= 0 or hidden.shadow is None:
        return hidden
    kind = "linear" if hidden.shadow.filter == "exact" else hidden.shadow.filter
    shadow = replace(SOFT_SHADOW, filter=kind, through=hidden.shadow.through)
    luminance = lamp.intensity_cd / (np.pi * radius**2)
    return SphereLamp(hidden.name, luminance, lamp.position_m, radius, shadow=shadow)


def _hidden(lamp: PointLamp, what: str, intensity_cd: Float, groups: Iterable[str]) -> PointLamp:
    """The lamp itself: whatever else it shines through, its own shell hides it."""
    shadow = lamp.shadow
    if shadow is None:
        shadow = Shadow(through=frozenset({"real", "objects", *groups}) - {lamp.name})
    return replace(lamp, name=f"{lamp.name}: {what}", intensity_cd=intensity_cd, shadow=shadow)


def _openings(lamp: PointLamp, form: Form, solution: Solution, groups: Iterable[str]) -> list[Lamp]:
    if form.has_gaps:
        everywhere = PointLamp(lamp.name, lamp.position_m, lamp.intensity_cd, lamp.shadow)
        gap_cd = solution.gap_cd * lamp.intensity_cd
        return [_hidden(everywhere, "gaps", gap_cd, groups)]
    return [
        PolygonLamp(
            f"{lamp.name}: opening {number}",
            luminance * lamp.intensity_cd,
            lid + lamp.position_m,
            shadow=_soft(lamp, LID_SAMPLES),
            drawn=False,
        )
        for number, (lid, luminance) in enumerate(
            zip(form.lids, solution.lid_cd_m2, strict=True), start=1
        )
    ]
