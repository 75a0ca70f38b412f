"""Light of probes for other programs.

========== ==================================== ============================ =================
format     holds                                for                          probes
========== ==================================== ============================ =================
three      luminance, our own numbers           three.js `ObjectLoader`      one, or a group
gltf       irradiance, and a cube map of it     `EXT_lights_image_based`     one, or scenes
unity      E/π as a polynomial, x negated       `SphericalHarmonicsL2`       one or all
filament   E/π as a polynomial                  `IndirectLight`              one
csv        luminance, all bands                 tables                       one or all
========== ==================================== ============================ =================

Everything but CSV has bands 0 to 2 and leaves the others out, as those programs do. Nothing is
windowed: who wants no dark rings derings first (`andon.harmonics`). Numbers are in cd/m², or
relative to a white that the caller names.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from andon.transport.probes.export.filament import filament_text
from andon.transport.probes.export.image_based import image_based_glb
from andon.transport.probes.export.model import (
    ExportUnit,
    ProbeLight,
    chosen_probe,
    probe_lights,
)
from andon.transport.probes.export.table import csv_text
from andon.transport.probes.export.three import three_json
from andon.transport.probes.export.unity import unity_json

__all__ = [
    "EXPORTS",
    "Export",
    "ExportUnit",
    "ProbeLight",
    "chosen_probe",
    "csv_text",
    "filament_text",
    "image_based_glb",
    "probe_lights",
    "three_json",
    "unity_json",
]


@dataclass(frozen=True)
class Export:
    """A format: the `suffix` of its files, and the function that gives their bytes."""

    suffix: str
    write: Callable[[Sequence[ProbeLight], ExportUnit], bytes]


EXPORTS = {
    "three": Export(".json", three_json),
    "gltf": Export(".glb", image_based_glb),
    "unity": Export(".json", unity_json),
    "filament": Export(".txt", filament_text),
    "csv": Export(".csv", csv_text),
}
