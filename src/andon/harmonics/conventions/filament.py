"""Filament: `IndirectLight::Builder::irradiance(3, …)` and the text of its tool cmgen.

Pre-scaled
    What the shader and `cmgen --deploy`, `--sh-shader` have: E/π, with the constants of the basis
    folded in, before 1, y, z, x, xy, yz, 3z² − 1, xz, x² − y². Its lines end in “irradiance,
    pre-scaled base”.
Plain
    `cmgen --sh` has radiance, with `--sh-irradiance` times A_l (old releases: A_l/π), in the
    orthonormal basis *with* the Condon–Shortley sign.

Axes are ours: right-handed, +Y up. cmgen mirrors its input by default, as cube maps want it; what
it writes is then unmirrored light. The middle of a panorama is +Z there, −Z here: half a turn
about +Y lies between light of the same picture. By default it also windows; that stays.

Source: Filament, libs/ibl/src/CubemapSH.cpp (`computeSH`, `preprocessSHForShader`),
tools/cmgen/src/cmgen.cpp (`outputSh`), shaders/src/light_indirect.fs (`irradianceSH`).
"""

from __future__ import annotations

import re
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.harmonics.conventions.factors import CONDON_SHORTLEY, FOLDED, checked, up_to_band_2
from andon.harmonics.irradiance import cosine_factors

__all__ = ["cmgen_text", "from_cmgen_text", "from_filament", "to_filament"]

Float = NDArray[np.float64]

_NAMES = ("L00", "L1-1", "L10", "L11", "L2-2", "L2-1", "L20", "L21", "L22")
_NUMBER = r"\s*([-+.\deE]+)\s*"
_LINE = re.compile(rf"^\s*\({_NUMBER},{_NUMBER},{_NUMBER}\);?\s*//\s*(L\d-?\d)(.*)$")


def to_filament(coefficients: NDArray[Any], /) -> Float:
    """(..., 9, 3) for `Builder::irradiance`, of luminance (..., k, 3)."""
    return up_to_band_2(coefficients) * FOLDED[:, None]


def from_filament(sh: NDArray[Any] | list[list[float]], /) -> Float:
    """(..., 9, 3) luminance, of the shader's nine coefficients (..., 9, 3)."""
    return checked(sh, (9, 3), "Filament's harmonics") / FOLDED[:, None]


def cmgen_text(coefficients: NDArray[Any], /) -> str:
    """The text that cmgen writes as ``sh.txt``, pre-scaled, of luminance (k, 3)."""
    nine = to_filament(coefficients)
    return "".join(
        f"({r:18.15g}, {g:18.15g}, {b:18.15g}); // {name}, irradiance, pre-scaled base\n"
        for name, (r, g, b) in zip(_NAMES, nine.tolist(), strict=True)
    )


def from_cmgen_text(text: str, /, *, file: str | None = None) -> Float:
    """(9, 3) luminance, of cmgen's text of three bands in any of its three kinds."""
    lines = [line for line in text.splitlines() if line.strip()]
    found = [_LINE.match(line) for line in lines]
    for number, match in enumerate(found):
        if match is None:
            raise InputError(
                "must be (r, g, b); // L00 …", file=file, field=f"line {number + 1} of cmgen's text"
            )
    matches = [match for match in found if match is not None]
    if tuple(match[4] for match in matches) != _NAMES:
        raise InputError(
            "must have the nine lines L00 … L22 in order", file=file, field="cmgen's text"
        )
    kinds = {match[5].strip() for match in matches}
    if len(kinds) != 1:
        raise InputError("its lines are of several kinds", file=file, field="cmgen's text")
    rows = checked(
        [[_number(match[i], file) for i in (1, 2, 3)] for match in matches],
        (9, 3),
        "cmgen's text",
    )
    return rows / _factors(kinds.pop(), file)[:, None]


def _number(text: str, file: str | None) -> float:
    try:
        return float(text)
    except ValueError as error:
        raise InputError(
            f"must be a number, got {text!r}", file=file, field="cmgen's text"
        ) from error


def _factors(kind: str, file: str | None) -> Float:
    """(9,) what luminance was multiplied with, by what a line says after its name."""
    if kind == "":
        return CONDON_SHORTLEY
    if kind == ", irradiance":
        return CONDON_SHORTLEY * cosine_factors(2)
    if kind == ", irradiance, pre-scaled base":
        return FOLDED
    raise InputError(f"an unknown kind, {kind!r}", file=file, field="cmgen's text")
