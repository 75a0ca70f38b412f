"""Settings of the glow, and what its angle is in pixels."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from andon.errors import InputError
from andon.spaces import View

__all__ = ["Glow", "pixels_per_radian"]


@dataclass(frozen=True)
class Glow:
    """How far and how much of the light of luminous bodies is scattered.

    Attributes
    ----------
    sigma_radians : standard deviation of the Gaussian as an angle, 0 < σ ≤ π.
    fraction : share of the bodies' light that is scattered, 0…1; 1 is the paper's filter.
    """

    sigma_radians: float
    fraction: float = 1.0

    def __post_init__(self) -> None:
        if not 0 < self.sigma_radians <= math.pi:
            raise InputError(
                f"must be in (0, π], got {self.sigma_radians}", field="glow.sigma_radians"
            )
        if not 0 <= self.fraction <= 1:
            raise InputError(f"must be 0…1, got {self.fraction}", field="glow.fraction")

    def sigma_pixels(self, view: View, /) -> tuple[float, float]:
        """σ in columns and in rows of a picture of this view."""
        across, down = pixels_per_radian(view)
        return self.sigma_radians * across, self.sigma_radians * down


def pixels_per_radian(view: View, /) -> tuple[float, float]:
    """Columns and rows per radian.

    Pinhole: on the optical axis; at an angle θ to it a picture has 1/cos²θ times as many (1.33 at
    30°), so the glow is too narrow there. Fisheye and latlong: of the mean pixel, √(mean solid
    angle); too narrow towards the rim and the poles, where a glow would have to be stretched.
    """
    if view.projection == "pinhole":
        return view.fx, view.fy
    mean = 1 / math.sqrt(float(np.mean(view.solid_angles())))
    if view.projection == "latlong":
        return mean, mean
    return mean * math.sqrt(view.fx / view.fy), mean * math.sqrt(view.fy / view.fx)
