"""A canopy as an eye sees it: leaves and sun, with bloom and needles.

There is no halo: the ring of the lens shows to wide pupils, and in daylight there are none (Spencer
et al. 1995 give it no light in photopic adaptation).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from andon.glare.kernel import Kernel
from andon.glare.komorebi.canopy import Canopy
from andon.glare.komorebi.model import Komorebi
from andon.glare.needles import needles_of
from andon.glare.needles.model import Needles
from andon.glare.needles.reference import draw
from andon.glare.sources.find import background_luminance
from andon.glare.whole_picture.plan import WholePlan, plan_whole
from andon.glare.whole_picture.reference import scattered
from andon.observer.spread.family import spread_function
from andon.observer.spread.model import Eye
from andon.quantities import photometric

__all__ = ["Seen", "ambient_of"]

Float = NDArray[np.float64]


def ambient_of(canopy: Canopy, /) -> float:
    """What the eye is adapted to, cd/m²: the mean of the leaves, without what is very bright."""
    light = np.asarray(photometric(canopy.leaves_cd_m2))
    return background_luminance(light, canopy.view.solid_angles())


@dataclass(frozen=True, eq=False)
class Seen:
    """Frames of a komorebi, each as `eye` sees it.

    Attributes
    ----------
    komorebi : what is seen.
    eye : whose.
    model : name of the spread function.
    seed : of the eye's needles.
    """

    komorebi: Komorebi
    eye: Eye = field(default_factory=Eye)
    model: str = "cie135"
    seed: int = 0

    @cached_property
    def ambient_cd_m2(self) -> float:
        """See `ambient_of`."""
        return ambient_of(self.komorebi.canopy)

    @cached_property
    def plan(self) -> WholePlan:
        """Of the bloom, for both engines."""
        spread = spread_function(self.model, self.eye)
        return plan_whole(self.komorebi.canopy.view, Kernel(spread))

    def parts(self, time_seconds: float, /) -> tuple[Float, list[Needles]]:
        """(H, W, 3) cd/m² of what blooms, and the needles, whose light it has not."""
        light = self.komorebi.picture(time_seconds)
        sources, canopy = self.komorebi.sources(time_seconds), self.komorebi.canopy
        stars = [needles_of(each, self.eye, self.ambient_cd_m2, self.seed) for each in sources]
        lost = np.array([star.share for star in stars])[canopy.gap][:, None]
        light.reshape(-1, 3)[canopy.pixels] *= 1 - lost
        return light, stars

    def picture(self, time_seconds: float, /) -> Float:
        """(H, W, 3) cd/m²; light of bloom and needles is taken from where it came from."""
        light, stars = self.parts(time_seconds)
        return scattered(light, self.plan).picture + draw(stars, self.komorebi.canopy.view)
