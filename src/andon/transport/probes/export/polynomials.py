"""Unity's and Filament's numbers: a polynomial of the normal with everything folded in.

Both evaluate

    c0 + c1·y + c2·z + c3·x + c4·xy + c5·yz + c6·(3z² − 1) + c7·xz + c8·(x² − y²)

and take the result for E/π: what a white diffuse surface sends back. So c = K·A_l/π·L_lm, with K
the constant of the basis. The Condon–Shortley sign that Filament's own basis has is in K twice and
cancels. Unity's world is left-handed; its glTF importers negate x, and so do we.

Sources: Sloan 2008; Filament's `CubemapSH::computeIrradianceSH3Bands` and
`renderPreScaledSH3Bands`; Unity's `SphericalHarmonicsL2` with `unity_SHAr` … `unity_SHC`.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from math import pi, sqrt

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.harmonics import convolved, to_order
from andon.transport.probes.export.model import ExportUnit, ProbeLight

__all__ = ["filament_text", "polynomial", "unity_json"]

Float = NDArray[np.float64]

# K: what the monomials above are multiplied by in the basis.
_BASIS = np.array(
    [
        sqrt(1 / (4 * pi)),
        *[sqrt(3 / (4 * pi))] * 3,
        *[sqrt(15 / (4 * pi))] * 2,
        sqrt(5 / (16 * pi)),
        sqrt(15 / (4 * pi)),
        sqrt(15 / (16 * pi)),
    ]
)
# Of c0…c8 under x → −x.
_MIRROR_X = np.array([1, 1, 1, -1, -1, 1, 1, -1, 1])
BANDS = ("L00", "L1-1", "L10", "L11", "L2-2", "L2-1", "L20", "L21", "L22")


def polynomial(coefficients: Float, /) -> Float:
    """(..., 9, 3) of the polynomial for E/π, in cd/m², from coefficients (..., k, 3) in cd/m²."""
    return convolved(to_order(coefficients, 2)) * (_BASIS / pi)[:, None]


def filament_text(lights: Sequence[ProbeLight], unit: ExportUnit) -> bytes:
    """One probe as ``cmgen --sh`` writes it: nine lines for `IndirectLight.irradiance(3, sh)`.

    In world axes, right-handed. With `unit.white_cd_m2` set, give that luminance, in cd/m², times
    what the camera's exposure asks for as the light's intensity; else an intensity of 1.
    """
    if len(lights) != 1:
        raise InputError(
            "the Filament format holds one probe", field="format", remedy="choose a probe"
        )
    values = unit.scale * polynomial(lights[0].coefficients)
    lines = [
        "({}); // {}, irradiance, pre-scaled base".format(
            ", ".join(f"{value:18.15g}" for value in row), band
        )
        for row, band in zip(values, BANDS, strict=True)
    ]
    return ("\n".join(lines) + "\n").encode()


def unity_json(lights: Sequence[ProbeLight], unit: ExportUnit) -> bytes:
    """JSON that Unity's `JsonUtility` reads into plain classes.

    ``probes[i].sh`` has 27 numbers: nine of red, nine of green, nine of blue, which is the order of
    `SphericalHarmonicsL2` (``sh[channel, i] = numbers[9 * channel + i]``).
    """
    probes = [
        {
            "name": light.name,
            "position": dict(zip("xyz", (light.position_m * [-1, 1, 1]).tolist(), strict=True)),
            "sh": (unit.scale * polynomial(light.coefficients) * _MIRROR_X[:, None])
            .T.ravel()
            .tolist(),
        }
        for light in lights
    ]
    document = {
        "format": "andon-unity-light-probes",
        "version": 1,
        "axes": "left-handed, +Y up: x of glTF is negated",
        "length": "m",
        "unit": unit.words,
        "order": "SphericalHarmonicsL2: nine of red, of green, of blue; E/pi",
        "probes": probes,
    }
    return (json.dumps(document, ensure_ascii=False, indent=1) + "\n").encode()
