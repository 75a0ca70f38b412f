"""What both photometric readers return."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

__all__ = ["Distribution", "PhotometricType", "Tilt"]

Float = NDArray[np.float64]
PhotometricType = Literal["A", "B", "C"]


@dataclass(frozen=True)
class Tilt:
    """How the light of the lamps changes when the luminaire is tilted (discharge lamps).

    Attributes
    ----------
    lamp_geometry : 1 the lamp stands upright while the luminaire looks down, 2 it lies and stays
        lying when the luminaire is tilted, 3 it lies and tilts along.
    angles_degrees : (n,) rising, 0…180, tilt from the position of the measurement.
    factors : (n,) ≥ 0, on all candela.
    """

    lamp_geometry: int
    angles_degrees: Float
    factors: Float


@dataclass(frozen=True, eq=False)
class Distribution:
    """Candela on a grid of angles, as measured; one is equal to itself only.

    What the angles mean depends on the photometric type; see `andon.lamps.goniometry`. Symmetric
    files are unfolded: nothing is left to mirror. Directions outside the grid are dark.

    Attributes
    ----------
    photometry : ``C`` nearly all luminaires, ``B`` floodlights, ``A`` car headlights.
    horizontal_degrees : (c,) rising. C: 0…360, both included; A: within ±180; B: within ±90.
    vertical_degrees : (g,) rising. C: within 0…180 (0 is down); A: within ±90; B: within ±180.
    candela : (c, g) cd ≥ 0 with ballast factor and multiplier; at least one > 0.
    name, manufacturer : as the file says, or "".
    stated_lumens : what the luminaire is said to emit, in lm, or None.
    lamp_lumens : what its bare lamps are said to emit, in lm; None for absolute photometry.
    watts : electrical power, ballast included, or None.
    opening_m : luminous opening along C = 0°, along C = 90°, and its height; metres ≥ 0.
    is_round : the opening is a disk or an ellipse, not a rectangle.
    tilt : None where the light does not depend on the luminaire's tilt.
    keywords : (key, value) of the file's own labels, in their order.
    """

    photometry: PhotometricType
    horizontal_degrees: Float
    vertical_degrees: Float
    candela: Float
    name: str = ""
    manufacturer: str = ""
    stated_lumens: float | None = None
    lamp_lumens: float | None = None
    watts: float | None = None
    opening_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    is_round: bool = False
    tilt: Tilt | None = None
    keywords: tuple[tuple[str, str], ...] = ()
