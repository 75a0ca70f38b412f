"""Colour of lamps: chromaticity and colour temperature to linear Rec.709 factors.

One rule for colour temperature: **Planck's law at every temperature**, integrated with the CIE
1931 2° observer. Flames and incandescent lamps are near-Planckian, most white lamps are sold by the
nearest Planckian temperature, and one rule has no seam where two families would meet (Planck and
daylight differ by 0.005 in y). Light that *is* daylight says so: ``daylight = true`` takes the
CIE D series (CIE 15:2004, eqs. 3.1 to 3.4) at that temperature, 4000…25000 K; 6504 K is D65.

Lamps below about 1900 K (a candle's colour and redder) lie outside Rec.709: their blue factor is
0, see `factors_from_rgb`.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.lamps.observer_1931 import MATCHING, WAVELENGTHS_NM
from andon.quantities import LUMINANCE_WEIGHTS

__all__ = [
    "NEUTRAL",
    "chromaticity_of_daylight",
    "chromaticity_of_temperature",
    "factors_from_chromaticity",
    "factors_from_rgb",
    "factors_from_temperature",
    "rgb_factors",
]

Float = NDArray[np.float64]

TEMPERATURE_RANGE_K = (1000.0, 40000.0)
DAYLIGHT_RANGE_K = (4000.0, 25000.0)

# c₂ = h·c/k_B in m·K, from the exact SI constants of 2019. (Illuminant A was defined with an
# older c₂: its 2856 K is 2855.5 K here; the chromaticity moves by 4e-5.)
SECOND_RADIATION_CONSTANT = 6.62607015e-34 * 299792458 / 1.380649e-23

# x, y of the primaries and of D65: ITU-R BT.709-6, table 1.
_PRIMARIES = np.array([[0.640, 0.330], [0.300, 0.600], [0.150, 0.060]])
_WHITE = np.array([0.3127, 0.3290])

NEUTRAL: Float = np.ones(3)
NEUTRAL.flags.writeable = False


def _xyz(chromaticity: NDArray[Any]) -> Float:
    """X, Y, Z (..., 3) with Y = 1 of chromaticities (..., 2)."""
    x, y = chromaticity[..., 0], chromaticity[..., 1]
    return np.stack([x / y, np.ones_like(y), (1 - x - y) / y], axis=-1)


def _rgb_from_xyz() -> Float:
    """(3, 3), from the primaries and the white (SMPTE RP 177, section 3.3)."""
    primaries = _xyz(_PRIMARIES).T
    scaled = primaries * np.linalg.solve(primaries, _xyz(_WHITE))
    return np.linalg.inv(scaled).astype(np.float64)


_RGB_FROM_XYZ = _rgb_from_xyz()


def factors_from_rgb(rgb: NDArray[Any], /) -> Float:
    """Factors (3,) with 0.2126 R + 0.7152 G + 0.0722 B = 1 in the ratio of `rgb` (3,).

    Negative channels (a colour outside Rec.709) become 0 *before* the normalisation: the
    photometric value is kept, the chromaticity moves to the edge of the gamut.
    """
    clipped = np.maximum(np.asarray(rgb, np.float64), 0)
    largest = clipped.max()
    if not (np.isfinite(largest) and largest > 0):
        raise InputError(f"must be finite with a channel > 0, got {list(rgb)}", field="rgb")
    clipped = clipped / largest  # so that the sum neither overflows nor underflows
    return clipped / (clipped @ LUMINANCE_WEIGHTS)


def factors_from_chromaticity(chromaticity_xy: NDArray[Any] | tuple[float, float], /) -> Float:
    """Rec.709 factors (3,) of photometric value 1 of a CIE 1931 chromaticity (x, y), y > 0."""
    x, y = chromaticity_xy
    if not (np.isfinite(x) and np.isfinite(y) and x >= 0 and y > 0 and x + y <= 1):
        raise InputError(
            f"needs x ≥ 0, y > 0, x + y ≤ 1, got ({x:g}, {y:g})", field="chromaticity_xy"
        )
    if np.allclose((x, y), _WHITE, rtol=0, atol=1e-12):
        return NEUTRAL.copy()  # D65 is neutral exactly, not up to rounding
    return factors_from_rgb(_RGB_FROM_XYZ @ _xyz(np.array([x, y], dtype=np.float64)))


@lru_cache(maxsize=256)
def chromaticity_of_temperature(temperature_k: float, /) -> tuple[float, float]:
    """CIE 1931 (x, y) of a Planckian radiator; 1000…40000 K.

    Planck's law per wavelength, λ⁻⁵/(exp(c₂/(λT)) − 1), summed over the observer's table; within
    1e-4 of the 1 nm sum. Raises `InputError` outside the range.
    """
    _check_temperature(temperature_k, TEMPERATURE_RANGE_K)
    exponent = SECOND_RADIATION_CONSTANT / (WAVELENGTHS_NM * 1e-9 * temperature_k)
    x, y, z = (WAVELENGTHS_NM**-5 / np.expm1(exponent)) @ MATCHING
    return float(x / (x + y + z)), float(y / (x + y + z))


def chromaticity_of_daylight(temperature_k: float, /) -> tuple[float, float]:
    """CIE 1931 (x, y) of a CIE D illuminant; 4000…25000 K (CIE 15:2004, eqs. 3.2 to 3.4)."""
    _check_temperature(temperature_k, DAYLIGHT_RANGE_K)
    cool = temperature_k > 7000
    cubic = (0.237040, 0.24748e3, 1.9018e6, -2.0064e9) if cool else _WARM_DAYLIGHT
    x = sum(c / temperature_k**power for power, c in enumerate(cubic))
    return x, -3.000 * x**2 + 2.870 * x - 0.275


_WARM_DAYLIGHT = (0.244063, 0.09911e3, 2.9678e6, -4.6070e9)


def _check_temperature(temperature_k: float, limits: tuple[float, float]) -> None:
    if not limits[0] <= temperature_k <= limits[1]:
        raise InputError(
            f"must be {limits[0]:g}…{limits[1]:g} K, got {temperature_k:g}", field="temperature_k"
        )


def factors_from_temperature(temperature_k: float, /, *, daylight: bool = False) -> Float:
    """Rec.709 factors (3,) of photometric value 1 of a Planckian radiator, 1000…40000 K, or of
    CIE daylight, 4000…25000 K.
    """
    locus = chromaticity_of_daylight if daylight else chromaticity_of_temperature
    return factors_from_chromaticity(locus(float(temperature_k)))


def rgb_factors(
    *,
    chromaticity_xy: tuple[float, float] | None = None,
    temperature_k: float | None = None,
    daylight: bool = False,
    rgb: tuple[float, float, float] | None = None,
) -> Float:
    """Factors (3,) that turn a photometric value into a triple of channels; neutral by default.

    0.2126 R + 0.7152 G + 0.0722 B of the factors is 1, so the triple has the photometric value.
    """
    given = [value for value in (chromaticity_xy, temperature_k, rgb) if value is not None]
    if len(given) > 1:
        raise InputError("at most one of chromaticity_xy, temperature_k, rgb is allowed")
    if chromaticity_xy is not None:
        return factors_from_chromaticity(chromaticity_xy)
    if temperature_k is not None:
        return factors_from_temperature(temperature_k, daylight=daylight)
    return factors_from_rgb(np.array(rgb)) if rgb is not None else NEUTRAL.copy()
