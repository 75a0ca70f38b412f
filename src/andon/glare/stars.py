"""Halo and needles around the sources of a picture, and what they take from them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.glare.around import around, needles_within
from andon.glare.gate import HIGHLIGHT_CONTRAST
from andon.glare.kernel import Kernel
from andon.glare.needles import NeedleModel
from andon.glare.needles.model import Which
from andon.glare.needles.reference import draw
from andon.glare.per_source.reference import halos_of_sources
from andon.glare.sources.find import FoundSources
from andon.observer.spread.model import Eye
from andon.quantities import photometric
from andon.spaces import View

__all__ = ["MOST_STARS", "Stars", "stars_of"]

Float = NDArray[np.float64]

# So many sources have a halo and needles, from the strongest on: those of the others are faint.
MOST_STARS = 32


@dataclass(frozen=True, eq=False)
class Stars:
    """Halo and needles drawn alone.

    Attributes
    ----------
    added : (H, W, 3) cd/m².
    taken : (H, W, 3) share of each pixel's light that they are made of.
    halos, needles : sources that have one, and some.
    """

    added: Float
    taken: Float
    halos: int
    needles: int


def stars_of(
    found: FoundSources,
    eye: Eye,
    view: View,
    kernel: Kernel,
    /,
    *,
    seed: int = 0,
    which: Which = "mono",
    model: NeedleModel | None = None,
) -> Stars:
    """What `eye` sees around the strongest sources of a picture, besides their veil."""
    strongest = found.simplified()[:MOST_STARS]
    seen = around(
        strongest,
        photometric(found.luminance_cd_m2[: len(strongest)]),
        found.ambient_cd_m2,
        eye,
        kernel,
        seed=seed,
        which=which,
        needles=needles_within(kernel, NeedleModel() if model is None else model),
        contrast=HIGHLIGHT_CONTRAST,
    )
    stars = [star for star in seen.needles if len(star)]
    added = draw(stars, view)
    if seen.halo_weights.any():
        weights = seen.halo_weights.tolist()
        added += halos_of_sources(strongest, view, kernel, kernel.spread, weights=weights)
    shares = np.zeros((len(found.sources) + 1, 3))
    shares[1 : len(strongest) + 1] = seen.taken
    halos = int(np.count_nonzero(seen.halo_weights))
    return Stars(added, shares[found.labels], halos, len(stars))
