"""Settings of the estimate, and what it gives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["AmbientEstimate", "AmbientSettings"]


@dataclass(frozen=True)
class AmbientSettings:
    """How light is told from reflectance.

    The result depends little on them: half or twice of any changes the errors of the synthetic
    rooms by less than a tenth of what one E0 everywhere errs by.

    Attributes
    ----------
    longest_px : the photograph is averaged to this many pixels along its longer side.
    inducing : points that the field is drawn from.
    near_pairs, far_pairs : how many are looked at: up to a fifth of the picture apart, and
        anywhere. Pairs say the same over and over, so together they count as `independent` ones.
    same_chromaticity : log ratio of channels within which two pixels may be one material.
    widest, narrowest : of the loss, log light, in the first round and the last of `rounds`.
    noise : standard deviation of the log light of one material, texture and shading included.
    chroma_amplitude : of the field of log ratios of channels, beside 1 of log light.
    seed : of the choice of pairs.
    """

    longest_px: int = 240
    inducing: int = 80
    near_pairs: int = 20_000
    far_pairs: int = 16_000
    independent: int = 1800
    same_chromaticity: float = 0.1
    widest: float = 0.6
    narrowest: float = 0.15
    rounds: int = 8
    noise: float = 0.1
    chroma_amplitude: float = 0.15
    seed: int = 1


@dataclass(frozen=True, eq=False)
class AmbientEstimate:
    """E0 but for its scale, and how well it is known.

    Attributes
    ----------
    relative : (H, W, 3) > 0, the mean of each channel over the surface is 1; 1 in holes.
    log_error : (H, W) standard deviation of log E0 that the field states; NaN in holes.
    used_share : of the pixels with a surface, those neither clipped, black nor on an edge.
    source_shares : of the light on the surface, what each known source gives directly, 0…1. Too
        rough for a scale: in the rooms of `verify` 1.4 to 1.8 times the true share, since light
        that walls reflect looks like their own.
    """

    relative: NDArray[np.float64]
    log_error: NDArray[np.float64]
    used_share: float
    source_shares: tuple[float, ...] = ()

    @property
    def stated_error(self) -> float:
        """Median of |E0 / true E0 − 1| that is to be expected, after the best scale."""
        # The median of |x| of a normal distribution is 0.6745 σ.
        return float(np.expm1(0.6745 * np.nanmedian(self.log_error)))
