"""Glass balls, as direct light needs them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.lamps import DirectionalLamp, Lamp, PointLamp

__all__ = ["GLASS", "GlassBall", "served_balls"]

Float = NDArray[np.float64]

# Caster group of all balls: a lamp that shines `through` it has neither their shadow nor their
# caustic (the photograph's own lamps, before the balls were there).
GLASS = "glass"


@dataclass(frozen=True)
class GlassBall:
    """A solid ball that refracts the light of lamps.

    Attributes
    ----------
    centre_m : (3,) metres, world.
    radius_m : > 0, metres.
    index : refractive index of the three channels, ≥ 1.
    absorption_per_m : Beer–Lambert, three channels, ≥ 0, 1/m.
    """

    centre_m: Float
    radius_m: float
    index: tuple[float, float, float] = (1.51, 1.51, 1.51)
    absorption_per_m: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def changes_light(self) -> bool:
        """It is not of air."""
        return max(self.index) > 1 or max(self.absorption_per_m) > 0

    def lamp_vergence(self, lamp: Lamp, /) -> float:
        """radius/distance of `lamp` from the centre: 0 from afar, 1 at the surface, more inside."""
        if isinstance(lamp, DirectionalLamp):
            return 0.0
        assert isinstance(lamp, PointLamp)
        distance = float(np.linalg.norm(self.centre_m - lamp.position_m))
        return self.radius_m / max(distance, 1e-12)

    def holds(self, lamp: Lamp, /) -> bool:
        """`lamp` is inside: it shines as if the ball were not there."""
        return self.lamp_vergence(lamp) >= 1

    def axis(self, lamp: Lamp, /) -> Float:
        """(3,) unit: from `lamp` to the centre."""
        if isinstance(lamp, DirectionalLamp):
            return lamp.direction
        assert isinstance(lamp, PointLamp)
        reach = self.centre_m - lamp.position_m
        return reach / max(float(np.linalg.norm(reach)), 1e-12)


def is_served(lamp: Lamp, /) -> bool:
    """`lamp` is small, casts shadows, and glass was there when it shone."""
    if not isinstance(lamp, PointLamp | DirectionalLamp) or lamp.shadow is None:
        return False
    return GLASS not in lamp.shadow.through


def served_balls(lamp: Lamp, balls: Sequence[GlassBall], /) -> list[GlassBall]:
    """Which of `balls` bend the light of `lamp`, wherever it is: none of air."""
    return [x for x in balls if x.changes_light] if is_served(lamp) else []
