"""Unity's and Filament's numbers: a polynomial of the normal with everything folded in.

Both evaluate

    c0 + c1·y + c2·z + c3·x + c4·xy + c5·yz + c6·(3z² − 1) + c7·xz + c8·(x² − y²)

and take the result for E/π: what a white diffuse surface sends back. The factors, and where they
come from, are in `andon.harmonics.conventions`. Unity's world is left-handed; its glTF importers
negate x, and so do we.
"""

from __future__ import annotations

import json
from collections.abc import Sequence

from andon.errors import InputError
from andon.harmonics.conventions import cmgen_text, to_unity
from andon.transport.probes.export.model import ExportUnit, ProbeLight

__all__ = ["filament_text", "unity_json"]


def filament_text(lights: Sequence[ProbeLight], unit: ExportUnit) -> bytes:
    """One probe as ``cmgen --sh`` writes it: nine lines for `IndirectLight.irradiance(3, sh)`.

    In world axes, right-handed. With `unit.white_cd_m2` set, give that luminance, in cd/m², times
    what the camera's exposure asks for as the light's intensity; else an intensity of 1.
    """
    if len(lights) != 1:
        raise InputError(
            "the Filament format holds one probe", field="format", remedy="choose a probe"
        )
    return cmgen_text(unit.scale * lights[0].coefficients).encode()


def unity_json(lights: Sequence[ProbeLight], unit: ExportUnit) -> bytes:
    """JSON that Unity's `JsonUtility` reads into plain classes.

    ``probes[i].sh`` has 27 numbers: nine of red, nine of green, nine of blue, which is the order of
    `SphericalHarmonicsL2` (``sh[channel, i] = numbers[9 * channel + i]``).
    """
    probes = [
        {
            "name": light.name,
            "position": dict(zip("xyz", (light.position_m * [-1, 1, 1]).tolist(), strict=True)),
            "sh": to_unity(unit.scale * light.coefficients, mirror="x").ravel().tolist(),
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
