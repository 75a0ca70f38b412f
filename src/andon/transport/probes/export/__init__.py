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

Everything but CSV has bands 0 to 2 and leaves the others out, as those programs do; the pictures of
gltf show all. `exported_lights` gives what frames show: each probe smoothed as little as keeps its
irradiance from going negative, with all bands and with those that the format has; between probes,
those that walls hide from the point left out. The writers take any light as it is. Numbers are in
cd/m², or relative to a white that the caller names.
"""

from __future__ import annotations

from andon.transport.probes.export.chosen import exported_lights
from andon.transport.probes.export.filament import filament_text
from andon.transport.probes.export.image_based import image_based_glb
from andon.transport.probes.export.model import (
    Export,
    ExportUnit,
    PlacedLight,
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
    "PlacedLight",
    "chosen_probe",
    "csv_text",
    "exported_lights",
    "filament_text",
    "image_based_glb",
    "probe_lights",
    "three_json",
    "unity_json",
]


EXPORTS = {
    "three": Export(".json", three_json),
    "gltf": Export(".glb", image_based_glb),
    "unity": Export(".json", unity_json),
    "filament": Export(".txt", filament_text),
    "csv": Export(".csv", csv_text, cuts_bands=False),
}
