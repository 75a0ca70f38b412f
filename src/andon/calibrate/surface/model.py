"""What goes into a fit of surfaces, and what comes out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.responses import SurfaceCurve

__all__ = ["KnownLight", "Samples", "SurfaceFit"]

Float = NDArray[np.float64]


@dataclass(frozen=True)
class KnownLight:
    """A photograph in known light.

    Attributes
    ----------
    name : for messages.
    linear : (H, W, 3) linear camera values.
    clipped : (H, W, 3), values of which only a bound is known.
    illuminance_lux : (3,), or (H, W, 3) where it varies; NaN where it is not known.
    """

    name: str
    linear: NDArray[np.float32]
    clipped: NDArray[np.bool_]
    illuminance_lux: Float


@dataclass(frozen=True)
class Samples:
    """Pixels of a surface in all photographs.

    Attributes
    ----------
    linear, lux : (pixels, photographs, 3).
    known : (pixels, photographs, 3), neither clipped nor without illuminance.
    """

    linear: Float
    lux: Float
    known: NDArray[np.bool_]


@dataclass(frozen=True)
class SurfaceFit:
    """The curve of one surface, and how well it describes the photographs.

    Attributes
    ----------
    name : of the surface.
    curve : f, per channel.
    photographs : names, in their order.
    samples : what was fitted.
    texture : (pixels, 3), a; its mean is 1.
    relative : (pixels, photographs, 3), residual as a share of what is predicted, whose floor is
        5 % of the brightest; NaN where nothing is known.
    rms_relative : (3,) root mean square, corrected for what the texture takes up.
    photograph_rms : (photographs,) the same of each photograph.
    outlier_share : residuals that the fit gave no weight.
    clipped_share : of the surface's values that were left out.
    fall_share : deepest fall, of the range, that was within noise and was levelled; 0 for none.
    zero_assumed : no photograph was dark, and f(0) = 0 is taken for granted.
    exponent : (3,) slope of ln f over ln E, from a twentieth of the largest E on; 1 is linear.
    straightness : (3,) largest distance of f from the straight line through 0 that fits best, as a
        share of the range.
    """

    name: str
    curve: SurfaceCurve
    photographs: tuple[str, ...]
    samples: Samples
    texture: Float
    relative: Float
    rms_relative: Float
    photograph_rms: Float
    outlier_share: float
    clipped_share: float
    fall_share: float
    zero_assumed: bool
    exponent: Float
    straightness: Float
