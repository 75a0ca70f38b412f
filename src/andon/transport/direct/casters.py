"""What casts shadows, in groups, since some lamps shine through some of it.

=============  ===========================================================================
group          is
=============  ===========================================================================
``real``       the real surface: the photograph's own light already has its shadows
``objects``    virtual objects that stand still
``movers``     virtual objects that move
a body's name  the shell of a luminous body, or the area of a lamp: its own light passes it
=============  ===========================================================================
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from andon.quantities import Geometry, merged
from andon.rays import RayScene

__all__ = ["MOVERS", "OBJECTS", "REAL", "Casters", "ShadowRays"]

REAL, OBJECTS, MOVERS = "real", "objects", "movers"


@dataclass(frozen=True)
class Casters:
    """Groups of triangles at one moment: pairs of name and `Geometry`, names unique."""

    groups: tuple[tuple[str, Geometry], ...]

    @cached_property
    def geometry(self) -> Geometry:
        """All groups as one."""
        return merged(*(geometry for _, geometry in self.groups))

    @cached_property
    def group_of_triangle(self) -> NDArray[np.int32]:
        """(m,) number of the group of each triangle of `geometry`."""
        counts = [len(geometry.triangles) for _, geometry in self.groups]
        return np.repeat(np.arange(len(counts), dtype=np.int32), counts)

    def hiding(self, through: Iterable[str], /) -> NDArray[np.bool_] | None:
        """(m,) triangles that hide a lamp that shines `through` some groups; None: all do."""
        passed = [i for i, (name, _) in enumerate(self.groups) if name in set(through)]
        return ~np.isin(self.group_of_triangle, passed) if passed else None

    @cached_property
    def _places(self) -> dict[str, int]:
        # The real surface and the objects stand still; what moves has few vertices.
        moving = [(name, part) for name, part in self.groups if name not in (REAL, OBJECTS)]
        return {name: hash(part.positions.tobytes()) for name, part in moving}

    def version(self, through: Iterable[str], /) -> tuple[int, ...]:
        """Changes when something moved that hides a lamp that shines `through` some groups."""
        names = set(through)
        return tuple(place for name, place in self._places.items() if name not in names)


class ShadowRays:
    """Rays against `casters`; one Embree scene for each set of groups that lamps shine through."""

    def __init__(self, casters: Casters) -> None:
        self.casters = casters
        self._scenes: dict[frozenset[str], RayScene] = {}

    def through(self, names: Iterable[str], /) -> RayScene:
        """What hides a lamp that shines through the groups `names`."""
        passed = frozenset(names) & {name for name, _ in self.casters.groups}
        if passed not in self._scenes:
            kept = [geometry for name, geometry in self.casters.groups if name not in passed]
            self._scenes[passed] = RayScene(merged(*kept))
        return self._scenes[passed]
