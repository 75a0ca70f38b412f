"""The veil's kernel: a spread function, cut to the angles at which its light is veil.

::

    K(θ)  │▒▒▒▒▒▒▒▒┐ f(θ_min)         f      the model
          │ core   │╲                 core   what every falling model has at least within θ_min
          │        │  ╲___ f          fade   from 90° to 110° it goes to 0: nothing is seen there
          └────────┴─────────╲──── θ
          0       θ_min     90° 110°

``k = ∫ K dω`` from θ_min on is the share of a point's light that becomes veil; ``1 − k`` stays.
Where pixels are finer than θ_min the *core*, a plateau of f(θ_min), is veil too: otherwise a dark
ring would lie between a point and its veil. Coarser pixels hold it in themselves.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from andon.observer.spread.model import SpreadFunction

__all__ = ["FADE_DEGREES", "MINIMUM_DEGREES", "Kernel"]

Float = NDArray[np.float64]

MINIMUM_DEGREES = 0.1
# The field of view ends at some 100° from the axis; no model is given beyond.
FADE_DEGREES = (90.0, 110.0)
# Trapezoids in log θ; k changes by less than 1e-6 with twice as many.
STEPS = 4000


@dataclass(frozen=True)
class Kernel:
    """Bloom of `spread` beyond `minimum_degrees`.

    Attributes
    ----------
    spread : the model.
    minimum_degrees : θ_min > 0; light that is scattered by less stays where it is.
    """

    spread: SpreadFunction
    minimum_degrees: float = MINIMUM_DEGREES

    def per_sr(self, theta_radians: ArrayLike, /, *, core: bool = False) -> Float:
        """(...) K(θ) in sr⁻¹, θ in radians 0…π; within θ_min 0, or with `core` the plateau."""
        theta = np.degrees(np.asarray(theta_radians, np.float64))
        value = self.spread.bloom_per_sr(np.maximum(theta, self.minimum_degrees)) * _fade(theta)
        return value if core else np.where(theta < self.minimum_degrees, 0.0, value)

    @cached_property
    def share(self) -> float:
        """k, of θ ≥ θ_min."""
        first, last = (math.log(math.radians(d)) for d in (self.minimum_degrees, FADE_DEGREES[1]))
        theta = np.exp(np.linspace(first, last, STEPS + 1))
        # Multiplying by θ makes it an integral over log θ.
        ring = self.per_sr(theta, core=True) * 2 * np.pi * np.sin(theta) * theta
        return float(np.sum((ring[1:] + ring[:-1]) / 2 * np.diff(np.log(theta))))

    @cached_property
    def core_share(self) -> float:
        """Share of the plateau within θ_min."""
        cap = 2 * np.pi * (1 - np.cos(np.radians(self.minimum_degrees)))
        return float(self.spread.bloom_per_sr(self.minimum_degrees)) * cap


def _fade(theta_degrees: Float) -> Float:
    first, last = FADE_DEGREES
    along = np.clip((theta_degrees - first) / (last - first), 0, 1)
    return 0.5 * (1 + np.cos(np.pi * along))
