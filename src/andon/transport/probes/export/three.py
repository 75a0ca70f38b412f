"""three.js: `LightProbe`, as its own ``toJSON`` writes and its ``ObjectLoader`` reads it.

Its basis, order, sign and axes are ours, and it holds luminance, too (it says radiance): the
numbers pass through, bands above 2 are left out. A `LightProbe` has no place: it lights the whole
scene, and several add up. So of a volume a hidden group is written, from which the program takes
the probe that it wants.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any
from uuid import NAMESPACE_OID, uuid5

from andon.harmonics.conventions import to_three
from andon.transport.probes.export.model import ExportUnit, PlacedLight

__all__ = ["three_json"]

# Of the "JSON Object format 4", which ObjectLoader has read since r70.
FORMAT_VERSION = 4.6


def three_json(lights: Sequence[PlacedLight], unit: ExportUnit) -> bytes:
    """The file for ``ObjectLoader``: a `LightProbe`, or of several a `Group` that is not visible.

    Its shader gives π·L for luminance L from all sides, and a white Lambert material then L: with
    `unit.white_cd_m2` the white is 1.
    """
    probes = [_probe(number, light, unit) for number, light in enumerate(lights)]
    top = probes[0] if len(probes) == 1 else _group(probes)
    metadata = {"version": FORMAT_VERSION, "type": "Object", "generator": "Andon"}
    return (json.dumps({"metadata": metadata, "object": top}, ensure_ascii=False) + "\n").encode()


def _probe(number: int, light: PlacedLight, unit: ExportUnit) -> dict[str, Any]:
    x, y, z = light.position_m.tolist()
    return {
        "uuid": _uuid(f"probe {number} {light.name}"),
        "type": "LightProbe",
        "name": light.name,
        "userData": {"andonUnit": unit.words},
        "layers": 1,
        "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, y, z, 1],
        "color": 0xFFFFFF,
        "intensity": 1,
        "sh": to_three(unit.scale * light.coefficients).tolist(),
    }


def _group(probes: list[dict[str, Any]]) -> dict[str, Any]:
    return {
        "uuid": _uuid("light probes"),
        "type": "Group",
        "name": "light probes",
        "visible": False,
        "layers": 1,
        "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1],
        "children": probes,
    }


def _uuid(words: str) -> str:
    """The same for the same words, so that files can be compared."""
    return str(uuid5(NAMESPACE_OID, f"andon {words}"))
