"""Surfaces as Radiance is told them: diffuse, and what emits as a mixture with *glow*.

::

    L = ρ·E/π + L_emitted          plastic, specularity 0      glow of radius 0: no lamp that is
                                                               aimed at, rays find it

A glow reflects nothing, so a surface that does both is a mixture: share c of *plastic* with the
reflectance ρ/c, share 1 − c of *glow* with the luminance L/(1 − c).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.quantities import Material
from andon.transport.baked.radiance.text import LUMENS_PER_WATT, joined, triple

__all__ = ["MIX_CAL", "MIX_FILE", "Finish", "finish_of", "material_text"]

Float = NDArray[np.float64]

# Share of plastic in what reflects and emits: enough for all real reflectances.
PLASTIC_SHARE = 0.95
# A surface that emits reflects no more than this.
MOST_PLASTIC = 0.999

# The share of a mixture's first material.
MIX_CAL = "mix_share = A1;\n"
MIX_FILE = "mix.cal"


@dataclass(frozen=True)
class Finish:
    """What a surface does with light: `reflectance` (3,) 0…1, `emitted_cd_m2` (3,) cd/m²."""

    reflectance: Float
    emitted_cd_m2: Float


def finish_of(material: Material, field: str, /, *, emission: bool, black: bool) -> Finish:
    """The part of a material that Radiance is told. Raises `InputError` for impossible ones.

    Parameters
    ----------
    emission : whether it emits.
    black : it reflects nothing.
    """
    reflectance = triple(np.asarray(material.reflectance), f"{field}.reflectance")
    if reflectance.max() > 1:
        raise InputError(f"must be 0…1, got {reflectance.tolist()}", field=f"{field}.reflectance")
    emitted = triple(np.asarray(material.emissive_cd_m2), f"{field}.emissive_cd_m2")
    return Finish(
        np.zeros(3) if black else reflectance,
        emitted if emission else np.zeros(3),
    )


def material_text(name: str, finish: Finish, *, pattern: str = "void") -> str:
    """Definition of the material `name`; `pattern` multiplies its reflectance."""
    if not finish.emitted_cd_m2.any():
        return _plastic(name, finish.reflectance, pattern)
    if not finish.reflectance.any():
        return _glow(name, finish.emitted_cd_m2)
    share = max(PLASTIC_SHARE, min((1 + float(finish.reflectance.max())) / 2, MOST_PLASTIC))
    return (
        _plastic(f"{name}.r", np.minimum(finish.reflectance / share, 1), pattern)
        + _glow(f"{name}.e", finish.emitted_cd_m2 / (1 - share))
        + f"void mixfunc {name} 4 {name}.r {name}.e mix_share {MIX_FILE} 0 1 {share!r}\n"
    )


def _plastic(name: str, reflectance: Float, pattern: str) -> str:
    return f"{pattern} plastic {name} 0 0 5 {joined(reflectance)} 0 0\n"


def _glow(name: str, luminance_cd_m2: Float) -> str:
    return f"void glow {name} 0 0 4 {joined(luminance_cd_m2 / LUMENS_PER_WATT)} 0\n"
