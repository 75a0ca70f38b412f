"""Filament: nine lines as its tool cmgen writes them, for `IndirectLight.irradiance(3, sh)`.

E/π in world axes, right-handed, +Y up, with the constants of the basis folded in. Filament
multiplies with the light's `intensity`: with a white of `ExportUnit`, that white in cd/m²; else 1.
"""

from __future__ import annotations

from collections.abc import Sequence

from andon.errors import InputError
from andon.harmonics.conventions import cmgen_text
from andon.transport.probes.export.model import ExportUnit, PlacedLight

__all__ = ["filament_text"]


def filament_text(lights: Sequence[PlacedLight], unit: ExportUnit) -> bytes:
    """The text of one probe. Raises `InputError` for several: the format has no place for them."""
    if len(lights) != 1:
        raise InputError(
            "the Filament format holds one probe",
            field="format",
            remedy="choose one with --probe, or a point with --at",
        )
    return cmgen_text(unit.scale * lights[0].coefficients).encode()
