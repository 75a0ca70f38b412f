"""glTF's EXT_lights_image_based: `irradianceCoefficients`, nine rows of r g b.

The extension says: coefficients of *irradiance*, l ≤ 2, and points to Ramamoorthi & Hanrahan 2001,
where E_lm = A_l·L_lm and the basis has no Condon–Shortley sign. It states neither sign nor factors
itself. Read so, they are `convolved` coefficients in glTF's axes, which are ours.

The one reader that the extension names, Babylon.js, divides by π and draws with a basis that has
the Condon–Shortley sign: files made for it, or from Filament's cmgen, want `condon_shortley`. The
two readings differ where m is odd: light from the left comes from the right, light from above from
below, so one look tells. Babylon's axes are left-handed unless told otherwise; how it turns its
environment is its own matter. `intensity` of the extension is a factor on top of all coefficients,
`rotation` turns them (`rotated`).

Source: KhronosGroup/glTF, extensions/2.0/Vendor/EXT_lights_image_based; Babylon.js,
sphericalPolynomial.ts (`preScaleForRendering`) and EXT_lights_image_based.ts.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.harmonics.conventions.factors import CONDON_SHORTLEY, checked, up_to_band_2
from andon.harmonics.irradiance import convolved, cosine_factors

__all__ = ["from_gltf", "to_gltf"]

Float = NDArray[np.float64]


def to_gltf(coefficients: NDArray[Any], /, *, condon_shortley: bool = False) -> Float:
    """(..., 9, 3) `irradianceCoefficients` in lx, of luminance (..., k, 3) in cd/m²."""
    return convolved(up_to_band_2(coefficients)) * _sign(condon_shortley)


def from_gltf(
    irradiance_coefficients: NDArray[Any] | list[list[float]], /, *, condon_shortley: bool = False
) -> Float:
    """(..., 9, 3) luminance, of `irradianceCoefficients` (..., 9, 3)."""
    values = checked(irradiance_coefficients, (9, 3), "irradianceCoefficients")
    return values * _sign(condon_shortley) / cosine_factors(2)[:, None]


def _sign(condon_shortley: bool) -> Float:
    return CONDON_SHORTLEY[:, None] if condon_shortley else np.ones((9, 1))
