"""Gaps of a canopy at any moment: how far open, how bright, as sources."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.glare.komorebi.canopy import Canopy
from andon.glare.model import Outline, Source
from andon.lamps.colour import rgb_factors
from andon.lamps.flicker import Flicker

__all__ = ["SUN_LUX", "Komorebi", "Sun"]

Float = NDArray[np.float64]

# On a plane that faces a high sun in clear air, a round number.
SUN_LUX = 100_000.0
SUN_DEGREES = 0.53
SUN_TEMPERATURE_K = 5500.0
# An outline must have a size; a closed gap has no light.
LEAST_RADIANS = 1e-6


@dataclass(frozen=True)
class Sun:
    """What shines through the gaps.

    Attributes
    ----------
    illuminance_lux : of the whole sun, on a plane that faces it.
    transmitted : share of that light that comes through all gaps together in the mean over time,
        0…1. Leaves over leaves let exp(−0.5·LAI) of direct light through (Monsi & Saeki 1953 with
        spherical angles of leaves); 1 % is that of a dense wood, LAI 9, at whose sun one can look.
    diameter_degrees : of its disc.
    temperature_k : of daylight of that colour, 4000…25000.
    """

    illuminance_lux: float = SUN_LUX
    transmitted: float = 0.01
    diameter_degrees: float = SUN_DEGREES
    temperature_k: float = SUN_TEMPERATURE_K

    def __post_init__(self) -> None:
        if not 0 <= self.illuminance_lux < np.inf:
            raise InputError(f"must be ≥ 0, got {self.illuminance_lux:g}", field="sun.lux")
        if not 0 <= self.transmitted <= 1:
            raise InputError(f"must be in 0…1, got {self.transmitted:g}", field="sun.transmitted")
        if not 0 < self.diameter_degrees <= 90:
            raise InputError(f"must be in (0, 90], got {self.diameter_degrees:g}", field="sun.size")

    @property
    def solid_angle_sr(self) -> float:
        """Of the disc."""
        return float(2 * np.pi * (1 - np.cos(np.radians(self.diameter_degrees) / 2)))

    @property
    def colour(self) -> Float:
        """(3,) of photometric value 1."""
        return rgb_factors(temperature_k=self.temperature_k, daylight=True)


@dataclass(frozen=True, eq=False)
class Komorebi:
    """The sun through a canopy.

    Attributes
    ----------
    canopy : leaves and gaps.
    sun : behind them.
    flicker : with as many streams as there are gaps.
    exposure_seconds : of a picture; see `Flicker.at`.
    """

    canopy: Canopy
    sun: Sun = field(default_factory=Sun)
    flicker: Flicker = field(default_factory=Flicker)
    exposure_seconds: float = 0.0

    def __post_init__(self) -> None:
        if self.flicker.streams != len(self.canopy):
            raise InputError(
                f"must have a stream for each of {len(self.canopy)} gaps, has "
                f"{self.flicker.streams}",
                field="flicker.streams",
            )

    @cached_property
    def luminance_cd_m2(self) -> Float:
        """(3,) of what is open: t·I/(⟨S⟩·ΣΩ), and at most the sun's own, I/Ω_sun."""
        open_sr = self.flicker.mean * float(self.canopy.solid_angles_sr.sum())
        lux = self.sun.illuminance_lux * self.sun.colour
        return lux * min(self.sun.transmitted / open_sr, 1 / self.sun.solid_angle_sr)

    def open_shares(self, time_seconds: float, /) -> Float:
        """(n,) S of each gap, 0 closed … 1 wholly open."""
        return self.flicker.open_share(time_seconds, exposure_seconds=self.exposure_seconds)

    def sources(self, time_seconds: float, /) -> tuple[Source, ...]:
        """All n gaps, in their order: discs of the open area in the middle of each."""
        solid = self.open_shares(time_seconds) * self.canopy.solid_angles_sr
        radii = np.maximum(np.arccos(np.clip(1 - solid / (2 * np.pi), -1, 1)), LEAST_RADIANS)
        lux = solid[:, None] * self.luminance_cd_m2
        return tuple(
            Source(direction, light, Outline(np.array([radius])), name=f"gap[{number}]")
            for number, (direction, light, radius) in enumerate(
                zip(self.canopy.directions, lux, radii, strict=True)
            )
        )

    def picture(self, time_seconds: float, /) -> Float:
        """(H, W, 3) cd/m² of leaves and sun, before the eye."""
        return self.canopy.picture(self.open_shares(time_seconds), self.luminance_cd_m2)
