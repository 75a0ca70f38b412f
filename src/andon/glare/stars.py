"""Needles around the sources of a picture, and what they take from them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.glare.needles import NeedleModel, needles_of
from andon.glare.needles.model import Which
from andon.glare.needles.reference import draw
from andon.glare.sources.find import FoundSources
from andon.observer.spread.model import Eye
from andon.spaces import View

__all__ = ["Stars", "stars_of"]

Float = NDArray[np.float64]

# Stars are drawn for so many sources, from the strongest on: the others' needles are short.
MOST_STARS = 32


@dataclass(frozen=True, eq=False)
class Stars:
    """Needles drawn alone.

    Attributes
    ----------
    added : (H, W, 3) cd/m².
    taken : (H, W) share of each pixel's light that became needles.
    count : sources that have some.
    """

    added: Float
    taken: Float
    count: int


def stars_of(
    found: FoundSources,
    eye: Eye,
    view: View,
    /,
    *,
    seed: int = 0,
    which: Which = "mono",
    model: NeedleModel | None = None,
) -> Stars:
    """The needles that `eye` sees around the strongest of the sources found in a picture."""
    stars = [
        needles_of(source, eye, found.ambient_cd_m2, seed, which=which, model=model)
        for source in found.sources[:MOST_STARS]
    ]
    shares = np.zeros(len(found.sources) + 1)
    for number, star in enumerate(stars):
        shares[number + 1] = star.share
    seen = [star for star in stars if len(star)]
    return Stars(draw(seen, view), shares[found.labels], len(seen))
