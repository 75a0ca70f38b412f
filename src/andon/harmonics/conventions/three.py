"""three.js (`LightProbe.sh`, `SphericalHarmonics3.fromArray`) and WebXR's light estimation.

27 numbers, r g b of each coefficient: radiance in the orthonormal basis, no Condon–Shortley sign,
in the scene's axes (right-handed, +Y up): ours. Its shader, `shGetIrradianceAt`, has the cosine;
a material multiplies with albedo/π. WebXR's `sphericalHarmonicsCoefficients` are the same array:
three.js copies it as it is (`XREstimatedLight`).

What is turned round is three.js's `CubeTexture`: `LightProbeGenerator.fromCubeTexture` takes its
images as seen in a world with x mirrored. `fromCubeRenderTarget` of a WebGL renderer has the
layout of `cube_directions`.

Source: three.js r187, src/math/SphericalHarmonics3.js, examples/jsm/lights/LightProbeGenerator.js.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.harmonics.conventions.factors import checked, up_to_band_2

__all__ = ["from_three", "to_three"]

Float = NDArray[np.float64]


def to_three(coefficients: NDArray[Any], /) -> Float:
    """(..., 27) for `sh.fromArray`, of luminance (..., k, 3)."""
    nine = up_to_band_2(coefficients)
    return nine.reshape(*nine.shape[:-2], 27)


def from_three(numbers: NDArray[Any] | list[float], /) -> Float:
    """(..., 9, 3) luminance, of `sh.toArray()` or WebXR's 27 numbers (..., 27)."""
    values = checked(numbers, (27,), "three.js harmonics")
    return values.reshape(*values.shape[:-1], 9, 3)
