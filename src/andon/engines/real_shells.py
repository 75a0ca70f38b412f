"""Real shells of a scene: who shines through what, and what of them each view sees."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from andon.lamps import Body, Lamp
from andon.quantities import CameraFrame, Geometry, Surface
from andon.spaces import View
from andon.surface import reference
from andon.surface.cutting import parted
from andon.surface.model import SurfaceModel
from andon.surface.shells import ShellsInView, find_shells
from andon.transport.direct.casters import REAL

__all__ = ["RealShells", "real_shells"]

# A shell that somebody measured with a ruler is where they say within this, in metres. What hides
# the lamp's light is looked for within more: a piece of its shade that is left is a shadow on the
# whole room, a piece of something else that goes casts none, for this lamp, so near to its shade.
LEAST_MARGIN_M = 0.04
MARGINS_CUT = 2.0


@dataclass(frozen=True, eq=False)
class RealShells:
    """The shells that stand in the photograph.

    Attributes
    ----------
    names : of their bodies.
    rest : what casts shadows of the real surface and is no shell.
    parts : names of shells → what of the real surface belongs to these.
    views : view name → what it sees of them.
    margins_m : name → how near the real surface is to a shell where it is the shell.
    """

    names: frozenset[str]
    rest: Geometry
    parts: Mapping[frozenset[str], Geometry]
    views: Mapping[str, ShellsInView]
    margins_m: Mapping[str, float]

    @property
    def groups(self) -> list[tuple[str, Geometry]]:
        """Caster groups of the real surface."""
        return [(REAL, self.rest), *((_group(names), part) for names, part in self.parts.items())]

    def shining(self, lamps: Sequence[Lamp], /) -> tuple[Lamp, ...]:
        """Lamps that know what they shine through.

        A lamp in a real shell shines through the real surface at its shell's place; other lamps
        through the shell as it is stated, since the real one hides them already.
        """
        return tuple(self._passing(lamp) for lamp in lamps)

    def _passing(self, lamp: Any) -> Any:
        shadow = getattr(lamp, "shadow", None)
        if shadow is None:
            return lamp
        passed = {name for name in self.names if name != lamp.owner}
        for names in self.parts:
            if lamp.owner in names or REAL in shadow.through:
                passed.add(_group(names))
        lit = replace(lamp, shadow=replace(shadow, through=shadow.through | passed))
        radius_m = getattr(lamp, "visible_radius_m", getattr(lamp, "radius_m", 0.0))
        if lamp.owner not in self.names or not hasattr(lamp, "glass_m"):
            return lit
        return replace(lit, glass_m=radius_m + self.margins_m[lamp.owner])


def _group(names: frozenset[str]) -> str:
    return f"{REAL} at {', '.join(sorted(names))}"


def real_shells(
    surface: SurfaceModel, frames: Mapping[str, CameraFrame], bodies: Sequence[Body], /
) -> RealShells | None:
    """The real shells among `bodies`; None where there are none."""
    real = [body for body in bodies if body.real]
    if not real:
        return None
    least = max(LEAST_MARGIN_M, surface.bias.real_m)
    margins = {body.name: body.margin_m or least for body in bodies}
    own = [MARGINS_CUT * margins[body.name] for body in real]
    rest, parts = parted(surface.occluder.geometry, real, own)
    views = {
        name: find_shells(
            _measured(surface, frame.view), bodies, [margins[body.name] for body in bodies]
        )
        for name, frame in frames.items()
    }
    return RealShells(frozenset(body.name for body in real), rest, parts, views, margins)


def _measured(surface: SurfaceModel, view: View) -> Surface:
    """The real surface without what was filled: a hole may be the shell, and not what is behind."""
    seen = reference.see_real(surface, view)
    guessed = surface.filled.get(view.name)
    return seen if guessed is None else replace(seen, valid=seen.valid & ~guessed)
