"""Settings of flare needles, and the needles of one source."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.glare.gate import HIGHLIGHT_CONTRAST

__all__ = ["WAVELENGTHS_NM", "NeedleModel", "Needles", "Which"]

Float = NDArray[np.float64]
Which = Literal["mono", "left", "right"]

# Of the channels, as for the halo (Spencer et al. 1995), and the one that lengths are stated for.
WAVELENGTHS_NM = np.array([611.0, 549.0, 467.0])
REFERENCE_NM = 568.0


@dataclass(frozen=True)
class NeedleModel:
    """Constants of the reconstruction; the defaults are ours, chosen by eye.

    Attributes
    ----------
    number : k, needles of a point of I0 in the dark and in clear air.
    number_spread : s, standard deviation of the number from eye to eye, relative.
    most : needles that an eye has, a power of two; a number above it is cut.
    illuminance_lux : I0.
    size_sr : S0; the default is a disc of half a degree, as the sun and the moon are.
    background_cd_m2 : Bl0, a lit street at night.
    mist : Mg0.
    dioptres : of spectacles against short sight that double the number.
    length_degrees : len0, for |g| = 1 and I0.
    longest_degrees : no needle is longer.
    power : m, with which luminance falls along a needle and length grows with light, > 1.
    knee : where the fall sets in, in lengths of the needle, > 0.
    width_degrees : of the foot of the tent, at the outline; median of the needles.
    taper : width at the tip in widths at the outline, in (0, 1].
    lobe_degrees : standard deviation of the two lobes around a line; wider around less elongated
        outlines.
    pupil_mm : P0, of an eye adapted to the night: needles are as long as stated.
    share : of the source's light that becomes needles where all `most` are seen with P0, in [0, 1).
    contrast : of the gate.
    """

    number: float = 80.0
    number_spread: float = 0.25
    most: int = 256
    illuminance_lux: float = 1.0
    size_sr: float = 5.98e-5
    background_cd_m2: float = 1.0
    mist: float = 1.0
    dioptres: float = 4.0
    length_degrees: float = 1.2
    longest_degrees: float = 15.0
    power: float = 2.8
    knee: float = 0.3
    width_degrees: float = 0.03
    taper: float = 0.3
    lobe_degrees: float = 25.0
    pupil_mm: float = 6.0
    share: float = 0.06
    contrast: float = HIGHLIGHT_CONTRAST

    def __post_init__(self) -> None:
        if self.most < 1 or self.most & (self.most - 1):
            raise InputError(f"must be a power of two, got {self.most}", field="needles.most")
        if not self.power > 1:
            raise InputError(f"must be > 1, got {self.power:g}", field="needles.power")
        if not 0 <= self.share < 1:
            raise InputError(f"must be in [0, 1), got {self.share:g}", field="needles.share")
        if not 0 < self.taper <= 1:
            raise InputError(f"must be in (0, 1], got {self.taper:g}", field="needles.taper")


@dataclass(frozen=True, eq=False)
class Needles:
    """Needles of one source, n ≥ 0 of them, in the camera's frame.

    Attributes
    ----------
    direction : (3,) unit, to the source.
    azimuth_radians : (n,) in the eye's frame (`frame.eye_axes`).
    along : (n, 3) unit, perpendicular to `direction`: where each needle points.
    start_radians : (n,) θ of the outline, where it begins.
    length_radians : (n,) of light of 568 nm; of other light in proportion to the wavelength.
    half_width_radians : (n,) of the tent at the outline, before it is widened to pixels.
    illuminance_lux : (n, 3) of each needle at the eye, fading included.
    share : of the source's light, all of them together: what is to be taken from the source.
    model : constants.
    """

    direction: Float
    azimuth_radians: Float
    along: Float
    start_radians: Float
    length_radians: Float
    half_width_radians: Float
    illuminance_lux: Float
    share: float
    model: NeedleModel

    def __len__(self) -> int:
        return len(self.azimuth_radians)

    @property
    def reach_radians(self) -> float:
        """θ that no light of the needles lies beyond, but for the half of a pixel."""
        if not len(self):
            return 0.0
        longest = self.length_radians * float(WAVELENGTHS_NM.max() / REFERENCE_NM)
        return float(np.max(self.start_radians + longest))
