"""Radiance's scene text: numbers, polygons, and the units of light.

Numbers are written so that reading them gives the same double again.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError

__all__ = ["LUMENS_PER_WATT", "joined", "light_text", "polygons_text", "triple", "unit"]

Float = NDArray[np.float64]

# Radiance's own luminous efficacy, lm/W, applied channel by channel.
LUMENS_PER_WATT = 179.0


def joined(values: NDArray[Any], /) -> str:
    """Numbers in their order, shortest text that reads back exactly; zeros without a sign."""
    return " ".join(repr(value + 0.0) for value in np.asarray(values, np.float64).ravel().tolist())


def triple(values: NDArray[Any], field: str, /) -> Float:
    """(3,) finite numbers ≥ 0. Raises `InputError` for anything else."""
    found = np.asarray(values, np.float64)
    if found.shape != (3,) or not np.isfinite(found).all() or (found < 0).any():
        raise InputError(f"must be three numbers ≥ 0, got {found.tolist()}", field=field)
    return found


def unit(direction: NDArray[Any], field: str, /) -> Float:
    """(3,) of length 1. Raises `InputError` for what has no direction."""
    found = np.asarray(direction, np.float64)
    length = float(np.linalg.norm(found))
    if not (np.isfinite(length) and length > 0):
        raise InputError("must have a direction that is not zero", field=field)
    return found / length


def polygons_text(corners: Float, modifier: str, name: str = "") -> str:
    """Polygons of `corners` (m, k, 3) metres; those without area are left out.

    `name` begins theirs; the modifier's own without one.
    """
    relative = corners - corners[:, :1]
    area = np.linalg.norm(np.cross(relative[:, 1:-1], relative[:, 2:]).sum(axis=1), axis=1)
    count = 3 * corners.shape[1]
    rows = (corners[area > 0].reshape(-1, count) + 0.0).tolist()
    begin = f"{modifier} polygon {name or modifier}."
    return "".join(
        f"{begin}{number} 0 0 {count} {' '.join(map(repr, row))}\n"
        for number, row in enumerate(rows)
    )


def light_text(name: str, luminance_cd_m2: Float, *, modifier: str = "void", hides: bool) -> str:
    """What emits `luminance_cd_m2` (3,), and is opaque and black if it `hides`.

    What does not is an *illum*: light of lamps passes it.
    """
    kind = "light" if hides else "illum"
    return f"{modifier} {kind} {name} 0 0 3 {joined(luminance_cd_m2 / LUMENS_PER_WATT)}\n"
