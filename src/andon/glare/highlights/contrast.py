"""Which highlights glare: their luminance against that of what surrounds them.

The paper's gate: where ``I_ps/I_a`` is 40 or more a highlight has a halo and needles; below, it is
white on the display and no more. I_a is the luminance that the eye is adapted to: π⁻¹ of the
illuminance of light probes at the thing, if it stands in their light; else the mean of the picture
over solid angle, without what is 40 times brighter than that mean.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from andon.glare.gate import HIGHLIGHT_CONTRAST
from andon.quantities import photometric

__all__ = ["AmbientLevel", "ambient_luminance", "contrast", "glares"]

Float = NDArray[np.float64]

# Lights out: what an eye adapted to darkness still tells from nothing.
LEAST_CD_M2 = 1e-6
ROUNDS = 20


@dataclass(frozen=True)
class AmbientLevel:
    """I_a in cd/m², > 0, and where it was taken from."""

    cd_m2: float
    origin: Literal["probes", "picture"]


def ambient_luminance(
    luminance_cd_m2: Float,
    solid_angle_sr: Float,
    /,
    *,
    probe_lux: Float | None = None,
    gate: float = HIGHLIGHT_CONTRAST,
) -> AmbientLevel:
    """The ambient level.

    Parameters
    ----------
    luminance_cd_m2, solid_angle_sr : (n,) photometric, of parts of the picture.
    probe_lux : (m, 3) that mirroring things have of probes; None or empty: the picture is taken.
    gate : what is so many times the mean is no surround.
    """
    if probe_lux is not None and len(probe_lux):
        mean = float(photometric(np.asarray(probe_lux, np.float64)).mean()) / np.pi
        return AmbientLevel(max(mean, LEAST_CD_M2), "probes")
    kept = np.ones(len(luminance_cd_m2), bool)
    mean = 0.0
    for _ in range(ROUNDS):
        weight = solid_angle_sr * kept
        mean = float(luminance_cd_m2 @ weight) / max(float(weight.sum()), 1e-30)
        left = luminance_cd_m2 < gate * max(mean, LEAST_CD_M2)
        if (left == kept).all():
            break
        kept = left
    return AmbientLevel(max(mean, LEAST_CD_M2), "picture")


def contrast(luminance_cd_m2: ArrayLike, ambient_cd_m2: float, /) -> Float:
    """(...) I_ps/I_a of photometric luminances."""
    return np.asarray(luminance_cd_m2, np.float64) / max(ambient_cd_m2, LEAST_CD_M2)


def glares(
    luminance_cd_m2: ArrayLike, ambient_cd_m2: float, gate: float = HIGHLIGHT_CONTRAST, /
) -> NDArray[np.bool_]:
    """(...) bool, a highlight of this luminance has a halo and needles."""
    return contrast(luminance_cd_m2, ambient_cd_m2) >= gate
