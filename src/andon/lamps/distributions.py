"""How intensity depends on direction, and what flux that makes.

A spot is glTF's (Khronos, KHR_lights_punctual, "Inner and Outer Cone Angles"): full intensity
within the inner half-angle, none beyond the outer, between them the *square* of a ramp that is
linear in the cosine::

    I(θ)/I₀ = s²,   s = clamp((cos θ − cos θₒ) / (cos θᵢ − cos θₒ), 0, 1)

               I/I₀
                1 ┤■■■■■■■■■╲
                  │          ╲
                  │           ╲▁
                0 ┼─────────┬───┬──── θ
                            θᵢ  θₒ

The extension's sample code keeps the denominator above 0.001, which dims every cone narrower than
2.6° even on its axis. Here intensity *is* on the axis, so the floor only guards a division.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError

__all__ = [
    "POINT_SOLID_ANGLE_SR",
    "flux_lm_from_intensity",
    "intensity_cd_from_flux",
    "spot_attenuation",
    "spot_coefficients",
    "spot_solid_angle_sr",
]

Float = NDArray[np.float64]

POINT_SOLID_ANGLE_SR = 4 * np.pi

# Narrower cones are lasers: in single precision 1 − cos θ has two digits left at this angle.
MINIMUM_OUTER_RADIANS = np.radians(0.1)
# Angles closer than this make a hard edge; far below 1 − cos 0.1° = 1.5e-6, so s = 1 on the axis.
MINIMUM_COSINE_STEP = 1e-9


def _check_cone(inner_radians: float, outer_radians: float) -> None:
    narrowest, widest = MINIMUM_OUTER_RADIANS - 1e-12, np.pi / 2 + 1e-12
    if not (0 <= inner_radians < outer_radians <= widest and outer_radians >= narrowest):
        raise InputError(
            "needs 0 ≤ inner < outer and 0.1 ≤ outer ≤ 90°, got "
            f"{np.degrees(inner_radians):g}° and {np.degrees(outer_radians):g}°",
            field="inner_degrees, outer_degrees",
        )


def spot_coefficients(inner_radians: float, outer_radians: float) -> tuple[float, float]:
    """(scale, offset) of the ramp: ``s = clamp(cos θ · scale + offset, 0, 1)``.

    What a shader needs per lamp. Half-angles: 0 ≤ inner < outer, 0.1° ≤ outer ≤ π/2.
    """
    _check_cone(inner_radians, outer_radians)
    # cos a − cos b as a product: the difference would lose digits for narrow cones.
    middle, half = (outer_radians + inner_radians) / 2, (outer_radians - inner_radians) / 2
    scale = 1 / max(MINIMUM_COSINE_STEP, float(2 * np.sin(middle) * np.sin(half)))
    return float(scale), float(-np.cos(outer_radians) * scale)


def spot_attenuation(
    cosine: NDArray[Any] | float, /, *, inner_radians: float, outer_radians: float
) -> Float:
    """I(θ)/I₀ (...) in [0, 1] from cos θ (...), θ off the axis; KHR_lights_punctual."""
    scale, offset = spot_coefficients(inner_radians, outer_radians)
    return np.clip(np.asarray(cosine, np.float64) * scale + offset, 0, 1) ** 2


def spot_solid_angle_sr(inner_radians: float, outer_radians: float) -> float:
    """∫ I(θ)/I₀ dω over the sphere in sr: flux in lm = this × intensity on the axis in cd.

    Closed form. With c = cos θ, dω = 2π dc; s rises from 0 at cos θₒ to 1 over `step` and stays.
    ∫ s² over a linear ramp is step/3, so Ω = 2π·((1 − cos θₒ) − step + step/3).
    """
    scale, _ = spot_coefficients(inner_radians, outer_radians)
    cap = 2 * np.sin(outer_radians / 2) ** 2  # 1 − cos θₒ, without losing digits
    return float(2 * np.pi * (cap - 2 / 3 / scale))


def flux_lm_from_intensity(intensity_cd: float, /, solid_angle_sr: float) -> float:
    """Luminous flux in lm of an intensity in cd; `solid_angle_sr` of the distribution."""
    return intensity_cd * solid_angle_sr


def intensity_cd_from_flux(flux_lm: float, /, solid_angle_sr: float) -> float:
    """Luminous intensity in cd of a flux in lm; `solid_angle_sr` of the distribution, > 0."""
    return flux_lm / solid_angle_sr
