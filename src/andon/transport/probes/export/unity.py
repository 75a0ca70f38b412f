"""Unity: JSON that its `JsonUtility` reads into plain classes.

Unity's world is left-handed. Its importers of glTF (glTFast, UnityGLTF) negate x, and so do places
and light here, or the light would not fit the geometry.
"""

from __future__ import annotations

import json
from collections.abc import Sequence

from andon.harmonics.conventions import to_unity
from andon.transport.probes.export.model import ExportUnit, PlacedLight

__all__ = ["unity_json"]


def unity_json(lights: Sequence[PlacedLight], unit: ExportUnit) -> bytes:
    """The file: what its numbers mean, and `probes`.

    ``probes[i].sh`` has 27 numbers, nine of red, nine of green, nine of blue, as
    `SphericalHarmonicsL2` is indexed: ``sh[channel, k] = numbers[9 * channel + k]``.
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
