"""What a spread function is, and the eye that it is of."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from andon.errors import InputError

__all__ = ["Adaptation", "Eye", "Glasses", "SpreadFunction"]

Float = NDArray[np.float64]
Glasses = Literal["none", "spectacles", "contact-lenses"]
Adaptation = Literal["photopic", "mesopic", "scotopic"]


@dataclass(frozen=True)
class Eye:
    """What of the observer and of the air decides how light is scattered.

    Attributes
    ----------
    age_years : 0…120.
    pigment : of CIE: 0 black, 0.5 brown, 1.0 light, 1.2 very light eyes.
    pupil_mm : diameter, > 0.
    glasses, glasses_dioptres : what is worn and its power, negative for short sight.
    mist : relative mist in the air, ≥ 0; 0: clear.
    adaptation : weights of Spencer's model, and whether there is a lenticular halo.
    """

    age_years: float = 25.0
    pigment: float = 0.5
    pupil_mm: float = 5.0
    glasses: Glasses = "none"
    glasses_dioptres: float = 0.0
    mist: float = 0.0
    adaptation: Adaptation = "mesopic"

    def __post_init__(self) -> None:
        for key, least, most in (
            ("age_years", 0, 120),
            ("pigment", 0, 1.2),
            ("pupil_mm", 1, 10),
            ("glasses_dioptres", -30, 30),
            ("mist", 0, float("inf")),
        ):
            value = getattr(self, key)
            if not least <= value <= most or not np.isfinite(value):
                raise InputError(f"must be {least}…{most}, got {value:g}", field=f"eye.{key}")


@dataclass(frozen=True)
class SpreadFunction:
    """One model for one eye.

    Attributes
    ----------
    name : as in a scene file, ``cie135``.
    bloom_per_sr : θ in degrees (...) → sr⁻¹ (...), the same in all channels.
    halo_per_sr : θ in degrees (...) → sr⁻¹ (..., 3); None: no ring.
    valid_degrees : the angles that the model's authors give it for.
    """

    name: str
    bloom_per_sr: Callable[[ArrayLike], Float]
    halo_per_sr: Callable[[ArrayLike], Float] | None
    valid_degrees: tuple[float, float]

    def per_sr(self, theta_degrees: ArrayLike, /) -> Float:
        """(..., 3) bloom and halo together, sr⁻¹."""
        bloom = self.bloom_per_sr(theta_degrees)[..., None] * np.ones(3)
        return bloom if self.halo_per_sr is None else bloom + self.halo_per_sr(theta_degrees)
