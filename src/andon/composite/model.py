"""Settings of the composite."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from andon.responses import SurfaceCurve

__all__ = ["Ambient", "MeasuredSurface"]


@dataclass(frozen=True)
class Ambient:
    """The light that the real scene was captured under.

    Attributes
    ----------
    illuminance_lux : E0, (3,) or (H, W, 3), > 0.
    views : view name → (H, W, 3) E0 of its pixels, where views differ; `illuminance_lux` is then
        (3,), the mean of all.
    dimming : (3,) ≥ 0, share of E0 that is left.
    dimming_mode : ``linear`` (physics), or ``paper``: the paper scales the *encoded* RGB, which
        darkens more than its number says and shifts colours.
    """

    illuminance_lux: NDArray[np.float64] = field(default_factory=lambda: np.ones(3))
    dimming: tuple[float, float, float] = (1.0, 1.0, 1.0)
    dimming_mode: Literal["linear", "paper"] = "linear"
    views: Mapping[str, NDArray[np.float64]] = field(default_factory=dict[str, NDArray[np.float64]])

    def lux_of(self, view_name: str, /) -> NDArray[np.float64]:
        """E0 of the pixels of a view, (3,) or (H, W, 3)."""
        return self.views.get(view_name, self.illuminance_lux)

    @property
    def mean_lux(self) -> NDArray[np.float64]:
        """(3,) what virtual objects stand in: E0, or the mean of its image."""
        if self.illuminance_lux.ndim == 1:
            return self.illuminance_lux
        return np.nanmean(self.illuminance_lux, axis=(0, 1))

    @property
    def standing_lux(self) -> NDArray[np.float64]:
        """(3,) what is left of `mean_lux` after dimming."""
        return np.asarray(self.dimming) * self.mean_lux


@dataclass(frozen=True)
class MeasuredSurface:
    """What is known of the real surface in one view, beside its photograph.

    Attributes
    ----------
    reflectance : (H, W, 3) ρ ≥ 0, linear Rec.709, in the scale that the photograph shows it in
        (`map_scale`): π·luminance_per_unit·captured/E0; None where only the photograph tells it.
    curves : f of each surface that has one.
    curve_of : (H, W) int16, which of `curves` a pixel has, −1: none; None without curves.
    """

    reflectance: NDArray[np.float64] | None = None
    curves: tuple[SurfaceCurve, ...] = ()
    curve_of: NDArray[np.int16] | None = None
