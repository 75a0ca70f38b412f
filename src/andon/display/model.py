"""Settings of the display."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from andon.quantities import DisplayImage, Luminance

__all__ = ["Exposure", "SeeThrough", "Seen"]


@dataclass(frozen=True)
class SeeThrough:
    """An optical see-through display: it adds light to what passes through it.

    Attributes
    ----------
    peak_luminance_cd_m2 : luminance of value 1, as the eye sees it, > 0.
    transmittance : τ, share of the real light that passes, 0…1.
    compensation : the real light that passes is taken off what is shown; see `ost`.
    has_real_light : there is a photograph; without one the room is black.
    """

    peak_luminance_cd_m2: float
    transmittance: float = 1.0
    compensation: bool = True
    has_real_light: bool = True


@dataclass(frozen=True)
class Exposure:
    """How luminance becomes a display value.

    Attributes
    ----------
    units_per_cd_m2 : display-linear units per cd/m², > 0; None repeats the camera
        (1/luminance_per_unit), under which unchanged light keeps its bytes.
    tone : ``none`` clips each channel at white, as a camera does; ``hue`` lets what is brighter
        than white fade to white without changing its hue; ``reinhard`` bends what is above 0.6 of
        white towards white (leaves identity below that); ``fusion`` fuses simulated exposures
        (see `fusion`; leaves identity everywhere).
    see_through : what is sent is for an optical see-through display, whose codes are its own;
        exposure and tone are then those of the simulated view. None: for a video see-through one.
    """

    units_per_cd_m2: float | None = None
    tone: Literal["none", "hue", "reinhard", "fusion"] = "none"
    see_through: SeeThrough | None = None


@dataclass(frozen=True)
class Seen:
    """What the eye gets through an optical see-through display, simulated.

    Attributes
    ----------
    luminance : display + τ·real, cd/m²; the display's light is that of its 8-bit codes.
    image : the same as 8-bit codes of the camera, at the exposure and with the tone of the scene.
    dark_share : share of pixels that should be darker than the real light that passes.
    bright_share : share of pixels that should be brighter than the display can add.
    mean_error_cd_m2 : mean over all pixels of |seen − wanted|, photometric values.
    mean_wanted_cd_m2 : mean of what was wanted, to compare.
    """

    luminance: Luminance
    image: DisplayImage
    dark_share: float
    bright_share: float
    mean_error_cd_m2: float
    mean_wanted_cd_m2: float
