"""Ripples of water: sines whose slopes turn the normal (float64).

The surface stays flat; its normal does not. Waves run with the wind and up to 60° beside it, their
lengths in even steps of the logarithm, with one slope each, so that the mean square slope is the
stated one; short ones are as steep as long ones, as the sea's are (Cox and Munk 1954 for its mean
square slope). Their speed is that of gravity and surface tension on deep water,
ω² = g·k + (γ/ρ)·k³ (Lamb, Hydrodynamics, 267).

What a pixel covers does not move with the wave but blurs it: a wave of phase variance v within the
pixel keeps exp(−v/2) of its slope, and the variance of slope that is lost widens the lobe (as
Bruneton, Neyret and Holzschuch 2010 do it). So far water is a broad path of light and no noise.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.glare.highlights.model import Waves

__all__ = ["make_waves", "slopes_at"]

Float = NDArray[np.float64]

GRAVITY_M_S2 = 9.81
# Surface tension over density of water at 20 °C, m³/s².
TENSION_M3_S2 = 7.28e-5
SPREAD_RADIANS = np.radians(60.0)


def make_waves(
    *, slope: float, wavelength_m: tuple[float, float], wind_degrees: float, count: int, seed: int
) -> Waves:
    """`count` ripples of a mean square slope of `slope`², the same for the same `seed`."""
    random = np.random.default_rng(seed)
    steps = (np.arange(count) + random.uniform(0, 1, count)) / count
    low, high = np.log(wavelength_m)
    k = 2 * np.pi / np.exp(low + (high - low) * steps)
    turn = np.radians(wind_degrees) + SPREAD_RADIANS * random.uniform(-1, 1, count)
    return Waves(
        number=k[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=1),
        slope=np.full(count, slope * np.sqrt(2 / count)),
        phase=random.uniform(0, 2 * np.pi, count),
        frequency=np.sqrt(GRAVITY_M_S2 * k + TENSION_M3_S2 * k**3),
    )


def slopes_at(
    waves: Waves, position: Float, across: Float, down: Float, time_seconds: float, /
) -> tuple[Float, Float]:
    """Slopes (n, 2) along x and z, and the variance (n,) of slope that a pixel blurs.

    Parameters
    ----------
    position : (n, 3) metres, world.
    across, down : (n, 3) what a step of one pixel moves it by, metres.
    """
    slopes, lost = np.zeros((len(position), 2)), np.zeros(len(position))
    rows = zip(waves.number, waves.slope, waves.phase, waves.frequency, strict=True)
    for number, slope, phase, frequency in rows:
        angle = position[:, [0, 2]] @ number - frequency * time_seconds + phase
        # A pixel is a box: a step of s is a variance of s²/12.
        variance = ((across[:, [0, 2]] @ number) ** 2 + (down[:, [0, 2]] @ number) ** 2) / 12
        kept = np.exp(-variance / 2)
        unit = number / np.linalg.norm(number)
        slopes += (slope * kept * np.cos(angle))[:, None] * unit
        lost += slope**2 / 2 * (1 - kept**2)
    return slopes, lost
