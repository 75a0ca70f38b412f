"""How surfaces mirror lamps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

__all__ = ["LEAST_ALPHA", "Finish", "FinishKind", "Waves"]

Float = NDArray[np.float64]

FinishKind = Literal["cook-torrance", "phong", "water"]

# A narrower lobe would fall between pixels, and is below what 2 × 16 bits of a normal resolve.
LEAST_ALPHA = 0.002


@dataclass(frozen=True, eq=False)
class Waves:
    """Ripples as a sum of w sines that run over the plane x, z.

    Attributes
    ----------
    number : (w, 2) wave vectors along x and z, rad/m.
    slope : (w,) amplitude of each one's slope.
    phase : (w,) radians at time 0.
    frequency : (w,) rad/s.
    """

    number: Float
    slope: Float
    phase: Float
    frequency: Float


@dataclass(frozen=True, eq=False)
class Finish:
    """The mirroring part of a material.

    Attributes
    ----------
    kind : ``cook-torrance`` is GGX of one or two roughnesses.
    alpha : (across, along) GGX's α along the two tangents, ≥ `LEAST_ALPHA`; `along` is that of the
        direction that `axis` gives.
    metallic : [0, 1]; the base colour is mirrored to this share, and diffuse to the rest.
    axis : (3,) unit, world: the tangent is its projection onto the surface, or with `around`
        goes round it.
    exponent, reflectance : n and I_s (3,) of ``phong``; None: what GGX has straight ahead.
    index : of ``water``.
    waves : of ``water``.
    takes_lamps : lamps are mirrored.
    """

    kind: FinishKind = "cook-torrance"
    alpha: tuple[float, float] = (0.25, 0.25)
    metallic: float = 1.0
    axis: Float | None = None
    around: bool = False
    exponent: float = 200.0
    reflectance: tuple[float, float, float] | None = None
    index: float = 1.333
    waves: Waves | None = None
    takes_lamps: bool = True
