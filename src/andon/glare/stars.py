"""Halo and needles around the sources of a picture, and what they take from them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.glare.gate import gate
from andon.glare.kernel import Kernel
from andon.glare.model import Source
from andon.glare.needles import NeedleModel, needles_of
from andon.glare.needles.model import Which
from andon.glare.needles.reference import draw
from andon.glare.per_source.halos import halo_table
from andon.glare.per_source.reference import halos_of_sources
from andon.glare.sources.find import FoundSources
from andon.observer.spread.model import Eye
from andon.quantities import photometric
from andon.spaces import View

__all__ = ["MOST_STARS", "Stars", "stars_of"]

Float = NDArray[np.float64]

# So many sources have a halo and needles, from the strongest on: those of the others are faint.
MOST_STARS = 32
# Radii in degrees between which halos fade: every point of a source has its own ring, and the rings
# of one that is as wide as they are (3°) fill each other's middle. A ring at the outline would be
# seen around façades that in truth have none.
RING_SEEN_DEGREES, RING_LOST_DEGREES = 0.75, 1.5


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
    ambient = found.ambient_cd_m2
    shares = np.zeros((len(found.sources) + 1, 3))
    stars = [
        needles_of(source, eye, ambient, seed, which=which, model=model) for source in strongest
    ]
    for number, star in enumerate(stars):
        shares[number + 1] = star.share
    seen = [star for star in stars if len(star)]
    added = draw(seen, view)
    weights = gate(photometric(found.luminance_cd_m2[: len(strongest)]), ambient)
    weights = weights * np.array([_ring_seen(source) for source in strongest])
    has_halo = kernel.spread.halo_per_sr is not None and len(strongest) > 0
    if has_halo:
        added += halos_of_sources(strongest, view, kernel, kernel.spread, weights=weights.tolist())
        shares[1 : len(strongest) + 1] += weights[:, None] * _halo_share(kernel)
    halos = int(np.count_nonzero(weights)) if has_halo else 0
    return Stars(added, shares[found.labels], halos, len(seen))


def _ring_seen(source: Source) -> float:
    """1 for a small source, 0 for a wide one."""
    radius = float(np.degrees(source.outline.radii_radians.max()))
    span = RING_LOST_DEGREES - RING_SEEN_DEGREES
    return float(np.clip((RING_LOST_DEGREES - radius) / span, 0, 1))


def _halo_share(kernel: Kernel) -> Float:
    """(3,) share of a point's light that its ring holds."""
    ring = halo_table(kernel.spread)
    theta = np.linspace(0, ring.end, len(ring.values))
    weight = 2 * np.pi * np.sin(theta) * (theta[1] - theta[0])
    return weight @ ring.values
