"""Luminous bodies as things: what is seen of a lamp, and what it hides."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from andon.quantities import Geometry

__all__ = ["Body"]

Float = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Body:
    """A shell, or the emitting area of a lamp, at one moment.

    Attributes
    ----------
    name : of the lamp that it belongs to; also the caster group of its triangles.
    geometry : triangles in the world, counter-clockwise from outside.
    outside_cd_m2, inside_cd_m2 : (n, 3) luminance of each vertex by the lamp's own light, seen
        from outside and from inside.
    reflectance : (3,) diffuse reflectance for the light of other lamps, both sides.
    real : the shell is in the photograph and in its geometry, unlit: its light is added to the
        real surface that is there, which hides no light of its own lamp; the body itself is not
        drawn, and hides its own lamp's bulb alone.
    margin_m : of a real shell: how near a real surface is to it that is the shell; None: what the
        geometry's own uncertainty asks for.
    covers : (k, 3, 3) triangles that close it, wound like it; of shells only.
    """

    name: str
    geometry: Geometry
    outside_cd_m2: Float
    inside_cd_m2: Float
    reflectance: tuple[float, float, float] = (0.0, 0.0, 0.0)
    real: bool = False
    margin_m: float | None = None
    covers: Float = field(default_factory=lambda: np.empty((0, 3, 3)))

    def brightened(self, factor: Float | float) -> Body:
        """The body with `factor` (3,) or a number times its own light."""
        if np.all(factor == 1):
            return self
        outside, inside = factor * self.outside_cd_m2, factor * self.inside_cd_m2
        return replace(self, outside_cd_m2=outside, inside_cd_m2=inside)
