"""Unity's `SphericalHarmonicsL2`: what `sh[channel, coefficient]` holds.

Irradiance over π, with the constants of the basis folded in: a number stands before 1, y, z, x, xy,
yz, 3z² − 1, xz, x² − y². `AddAmbientLight(white)` adds 1 to the first: a white sky of radiance 1,
E/π = 1. The shader's `ShadeSH9` gets these as unity_SHAr = (sh3, sh1, sh2, sh0 − sh6), unity_SHBr =
(sh4, sh5, 3·sh6, sh7) and unity_SHC = sh8 of each channel, and returns E/π.

Unity's world is left-handed, +Y up, +Z forward: of a right-handed scene z is turned round, so
coefficients odd in z (L10, L2−1, L21) change their sign. Importers that mirror x instead (glTFast,
UnityGLTF) need the light mirrored in x: `mirror="x"`.

Source: Unity, Scripting API, SphericalHarmonicsL2; UnityCG.cginc, `ShadeSH9`.
"""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.harmonics.conventions.factors import FOLDED, checked, up_to_band_2

__all__ = ["from_unity", "to_unity"]

Float = NDArray[np.float64]

_ODD = {"z": (2, 5, 7), "x": (3, 4, 7)}


def to_unity(coefficients: NDArray[Any], /, *, mirror: Literal["x", "z"] = "z") -> Float:
    """(..., 3, 9) `sh[channel, coefficient]`, of luminance (..., k, 3)."""
    nine = up_to_band_2(coefficients) * (FOLDED * _sign(mirror))[:, None]
    return np.swapaxes(nine, -1, -2)


def from_unity(
    sh: NDArray[Any] | list[list[float]], /, *, mirror: Literal["x", "z"] = "z"
) -> Float:
    """(..., 9, 3) luminance, of `sh[channel, coefficient]` (..., 3, 9)."""
    values = np.swapaxes(checked(sh, (3, 9), "SphericalHarmonicsL2"), -1, -2)
    return values * _sign(mirror)[:, None] / FOLDED[:, None]


def _sign(mirror: str) -> Float:
    if mirror not in _ODD:
        raise InputError(f"must be x or z, got {mirror!r}", field="mirror")
    sign = np.ones(9)
    sign[list(_ODD[mirror])] = -1
    return sign
