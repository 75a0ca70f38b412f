"""How intensity depends on direction, and what flux that makes.

A spot is glTF's (Khronos, KHR_lights_punctual, "Inner and Outer Cone Angles"): full intensity
within the inner half-angle, none beyond the outer, between them the *square* of a ramp that is
linear in the cosine::

    I(θ)/I₀ = s²,   s = clamp((cos θ − cos θₒ) / max(ε, cos θᵢ − cos θₒ), 0, 1)

               I/I₀
                1 ┤■■■■■■■■■╲
                  │          ╲
                  │           ╲▁
                0 ┼─────────┬───┬──── θ
                            θᵢ  θₒ
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

# ε of the extension's sample code: keeps the ramp finite where both angles are equal.
MINIMUM_COSINE_STEP = 1e-3


def _check_cone(inner_radians: float, outer_radians: float) -> None:
    if not 0 <= inner_radians < outer_radians <= np.pi / 2 + 1e-12:
        raise InputError(
            f"needs 0 ≤ inner < outer ≤ 90°, got {np.degrees(inner_radians):g}° and "
            f"{np.degrees(outer_radians):g}°",
            field="inner_degrees, outer_degrees",
        )


def spot_coefficients(inner_radians: float, outer_radians: float) -> tuple[float, float]:
    """(scale, offset) of the ramp: ``s = clamp(cos θ · scale + offset, 0, 1)``.

    What a shader needs per lamp. Angles are half-angles, 0 ≤ inner < outer ≤ π/2.
    """
    _check_cone(inner_radians, outer_radians)
    step = np.cos(inner_radians) - np.cos(outer_radians)
    scale = 1 / max(MINIMUM_COSINE_STEP, float(step))
    return float(scale), float(-np.cos(outer_radians) * scale)


def spot_attenuation(
    cosine: NDArray[Any] | float, /, *, inner_radians: float, outer_radians: float
) -> Float:
    """I(θ)/I₀ (...) in [0, 1] from cos θ (...), θ off the axis; KHR_lights_punctual."""
    scale, offset = spot_coefficients(inner_radians, outer_radians)
    return np.clip(np.asarray(cosine, np.float64) * scale + offset, 0, 1) ** 2


def spot_solid_angle_sr(inner_radians: float, outer_radians: float) -> float:
    """∫ I(θ)/I₀ dω over the sphere in sr: flux in lm = this × intensity on the axis in cd.

    Closed form. With c = cos θ, dω = 2π dc; the ramp reaches s = 1 at c₁ = cos θₒ + step, and
    ∫ s² dc over a linear ramp is step/3. So Ω = 2π·((1 − c₁) + step/3), step = c₁ − cos θₒ.
    Where ε makes the ramp longer than the cone (c₁ > 1), the ramp ends at c = 1 with
    s₁ = (1 − cos θₒ)/step and Ω = 2π·step·s₁³/3.
    """
    scale, _ = spot_coefficients(inner_radians, outer_radians)
    # 1 − cos θ as 2·sin²(θ/2): the difference would lose digits for narrow cones.
    cap = 2 * np.sin(outer_radians / 2) ** 2
    step = 1 / scale
    if cap <= step:
        return float(2 * np.pi * step * (cap / step) ** 3 / 3)
    return float(2 * np.pi * (cap - step + step / 3))


def flux_lm_from_intensity(intensity_cd: float, /, solid_angle_sr: float) -> float:
    """Luminous flux in lm of an intensity in cd; `solid_angle_sr` of the distribution."""
    return intensity_cd * solid_angle_sr


def intensity_cd_from_flux(flux_lm: float, /, solid_angle_sr: float) -> float:
    """Luminous intensity in cd of a flux in lm; `solid_angle_sr` of the distribution, > 0."""
    return flux_lm / solid_angle_sr
