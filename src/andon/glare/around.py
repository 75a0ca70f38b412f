"""What is seen around single sources besides their veil: halo and needles, and what they take."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from andon.glare.gate import gate
from andon.glare.kernel import Kernel
from andon.glare.model import Source
from andon.glare.needles import NeedleModel, needles_of
from andon.glare.needles.model import Needles, Which
from andon.glare.per_source.halos import halo_table
from andon.observer.spread.model import Eye

__all__ = ["Around", "around", "needles_within"]

Float = NDArray[np.float64]

# Radii in degrees between which halos fade: every point of a source has its own ring, and the rings
# of one that is as wide as they are (3°) fill each other's middle. A ring at the outline would be
# seen around façades that in truth have none.
RING_SEEN_DEGREES, RING_LOST_DEGREES = 0.75, 1.5


# Share of its light that a source keeps: the veil's sums of Gaussians may take so much more.
LEAST_LEFT = 0.01


@dataclass(frozen=True, eq=False)
class Around:
    """Of n sources.

    Attributes
    ----------
    needles : of each, maybe none.
    halo_weights : (n,) of its ring, 0…1; 0 where the eye has no ring.
    taken : (n, 3) share of a source's light that both are made of.
    """

    needles: tuple[Needles, ...]
    halo_weights: Float
    taken: Float


def around(
    sources: Sequence[Source],
    luminance_cd_m2: Float,
    ambient_cd_m2: float,
    eye: Eye,
    kernel: Kernel,
    /,
    *,
    seed: int = 0,
    which: Which = "mono",
    needles: NeedleModel | None = None,
    contrast: float,
) -> Around:
    """Halo and needles of `sources` for `eye`.

    Parameters
    ----------
    luminance_cd_m2 : (n,) photometric, of each source; held against `contrast` times the ambient.
    needles : constants; None: no needles are seen.
    """
    weights = np.zeros(len(sources))
    taken = np.zeros((len(sources), 3))
    if kernel.spread.halo_per_sr is not None and len(sources):
        weights = gate(luminance_cd_m2, ambient_cd_m2, contrast=contrast)
        weights = weights * np.array([_ring_seen(source) for source in sources])
        taken += weights[:, None] * _halo_share(kernel)
    stars: list[Needles] = []
    if needles is not None:
        stars = [
            needles_of(source, eye, ambient_cd_m2, seed, which=which, model=needles)
            for source in sources
        ]
        taken += np.array([star.share for star in stars]).reshape(-1, 1)
    return Around(tuple(stars), weights, taken)


def needles_within(kernel: Kernel, model: NeedleModel, /) -> NeedleModel:
    """`model` with no more light than the veil and the ring of `kernel` leave in a source.

    In thick mist they leave little, and a source cannot be darker than black.
    """
    ring = _halo_share(kernel).max() if kernel.spread.halo_per_sr is not None else 0.0
    left = 1 - LEAST_LEFT - kernel.share - kernel.core_share - float(ring)
    return model if model.share <= left else replace(model, share=max(left, 0.0))


def _ring_seen(source: Source) -> float:
    """1 for a small source, 0 for a wide one."""
    radius = float(np.degrees(source.outline.radii_radians.max()))
    span = RING_LOST_DEGREES - RING_SEEN_DEGREES
    return float(np.clip((RING_LOST_DEGREES - radius) / span, 0, 1))


def _halo_share(kernel: Kernel, /) -> Float:
    """(3,) share of a point's light that its ring holds."""
    ring = halo_table(kernel.spread)
    theta = np.linspace(0, ring.end, len(ring.values))
    weight = 2 * np.pi * np.sin(theta) * (theta[1] - theta[0])
    return weight @ ring.values
