"""What glass is made of: indices of the three channels, absorption, and glTF's words for both.

glTF (extensions of Khronos)        here
=================================== ============================================================
KHR_materials_ior ``ior``           index, 1.5 if the extension is missing
KHR_materials_volume                absorption −ln(attenuationColor)/attenuationDistance, 1/m
KHR_materials_dispersion            20/V: B = (n − 1)/V / (1/λ_F² − 1/λ_C²), V Abbe's number
KHR_materials_transmission          which materials are glass
=================================== ============================================================

``thicknessFactor`` is for renderers that do not trace rays: the mesh itself says how thick it is.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from andon.errors import InputError
from andon.files.tree import Tree
from andon.quantities import Material

__all__ = ["CHANNELS_UM", "INDEX_UM", "Medium", "indices", "medium_of_material", "transmits"]

# The dominant wavelengths of the Rec.709 primaries as seen from D65 (611, 549 and 464 nm on the
# CIE 1931 locus), rounded to 5 nm: each channel is refracted like the one spectral colour that
# has its hue.
CHANNELS_UM = (0.610, 0.550, 0.465)
# Fraunhofer's lines: the index is stated at helium's d, dispersion between hydrogen's F and C.
INDEX_UM, LINE_F_UM, LINE_C_UM = 0.5876, 0.4861, 0.6563
# A channel of attenuationColor that is 0 would absorb without bound.
LEAST_TRANSMITTANCE = 1e-6
GLTF_INDEX = 1.5


@dataclass(frozen=True)
class Medium:
    """A material as glass: `index` at 587.6 nm, Cauchy's B in µm², absorption in 1/m."""

    index: float
    cauchy_b_um2: float
    absorption_per_m: tuple[float, float, float]


def indices(index: float, cauchy_b_um2: float, /) -> tuple[float, float, float]:
    """Refractive indices of the red, green and blue channel, ≥ 1.

    n(λ) = index + B·(1/λ² − 1/0.5876²), λ and B in µm and µm² (Cauchy's first two terms).
    """
    red, green, blue = (
        max(1.0, index + cauchy_b_um2 * (1 / wave**2 - 1 / INDEX_UM**2)) for wave in CHANNELS_UM
    )
    return red, green, blue


def transmits(material: Material, file: str, /) -> bool:
    """KHR_materials_transmission lets light through this material."""
    found = _extension(material, "KHR_materials_transmission", file)
    factor = None if found is None else found.get("transmissionFactor")
    return factor is not None and factor.number(0, 1) > 0


def medium_of_material(material: Material, file: str, /) -> Medium:
    """A material's extensions as a medium; raises `InputError` for values out of range."""
    ior = _extension(material, "KHR_materials_ior", file)
    stated = None if ior is None else ior.get("ior")
    index = GLTF_INDEX if stated is None else stated.number(1, 5)
    dispersion = _extension(material, "KHR_materials_dispersion", file)
    strength = None if dispersion is None else dispersion.get("dispersion")
    spread = 0.0 if strength is None else strength.number(0, 1000) / 20
    between = 1 / LINE_F_UM**2 - 1 / LINE_C_UM**2
    return Medium(index, (index - 1) * spread / between, _absorption(material, file))


def _absorption(material: Material, file: str) -> tuple[float, float, float]:
    volume = _extension(material, "KHR_materials_volume", file)
    distance = None if volume is None else volume.get("attenuationDistance")
    if volume is None or distance is None:
        return 0.0, 0.0, 0.0
    metres = distance.number(0)
    if not metres > 0:
        raise InputError("must be > 0 m", file=file, field=distance.place)
    colour = volume.get("attenuationColor")
    shares = (1.0, 1.0, 1.0) if colour is None else colour.numbers(3)
    if colour is not None and not all(0 <= share <= 1 for share in shares):
        raise colour.error(f"must be three numbers in 0…1, got {shares}")
    red, green, blue = (-float(np.log(max(x, LEAST_TRANSMITTANCE))) / metres for x in shares)
    return red, green, blue


def _extension(material: Material, name: str, file: str) -> Tree | None:
    return Tree(material.extensions, f"material {material.name!r}", file).get(name)
