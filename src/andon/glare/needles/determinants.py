"""Number, length and light of the needles of a source: the reconstruction of equations 6 to 8.

The paper's formulas are lost; what is left is the list of their arguments. With g standard normal
variates of the eye::

    number = k·|1 + s·g|·I·G/(S·Bl·Mg)          cut at what the eye has
    length = len0·|g|·(I/(Bl·Mg))^(1/m)·P/P0

    I  = E/I0             E illuminance at the eye
    S  = 1 + Ω/S0         Ω solid angle of the source
    Bl = 1 + L/Bl0        L ambient luminance
    Mg = 1 + mist/Mg0
    G  = 1 + |D|/4 dpt    spectacles against short sight; 1 without, and with contact lenses

Each quotient but I is 1 for a point in the dark in clear air and doubles at its reference, so that
none is ever divided by 0.

*Size.* The paper lets the needles grow with the source's size in one sentence and their number fall
with it in another and in equation 5 (1/S). Here their number falls: a large source is many points,
and their needles, shifted against each other, blur into the bloom. What grows with the source is
the star as a whole, since needles begin at the outline.

*Glasses.* The paper's reason, light that is bent towards the rim of the crystalline lens, needs a
lens at a distance from the eye.

*Age* changes nothing, as in the paper, but through the pupil that it narrows: P scales the length,
and its square, the open area, the light.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.glare.gate import gate
from andon.glare.model import Source
from andon.glare.needles.frame import elongation, eye_axes, lobed, outline_at
from andon.glare.needles.model import NeedleModel, Needles, Which
from andon.glare.needles.pattern import pattern_of
from andon.observer.spread.model import Eye
from andon.quantities import photometric

__all__ = ["needles_of", "number_of", "reach_factor"]

Float = NDArray[np.float64]


def number_of(
    source: Source, eye: Eye, ambient_cd_m2: float, gaussian: float, model: NeedleModel
) -> float:
    """num ≥ 0, not rounded: its fraction is the weight of the last needle.

    `gaussian` is the eye's g. Source: the glare paper, equations 5 and 6, as reconstructed above.
    """
    light = float(photometric(source.illuminance_lux)) / model.illuminance_lux
    size = 1 + source.outline.solid_angle_sr / model.size_sr
    glasses = 1.0
    if eye.glasses == "spectacles":
        glasses += max(0.0, -eye.glasses_dioptres) / model.dioptres
    number = model.number * abs(1 + model.number_spread * gaussian) * light * glasses
    return min(number / (size * _veiled(eye, ambient_cd_m2, model)), float(model.most))


def reach_factor(source: Source, eye: Eye, ambient_cd_m2: float, model: NeedleModel) -> float:
    """Length of a needle of |g| = 1, in len0."""
    light = float(photometric(source.illuminance_lux)) / model.illuminance_lux
    return (light / _veiled(eye, ambient_cd_m2, model)) ** (1 / model.power) * _open(eye, model)


def _veiled(eye: Eye, ambient_cd_m2: float, model: NeedleModel) -> float:
    """Bl·Mg."""
    return (1 + ambient_cd_m2 / model.background_cd_m2) * (1 + eye.mist / model.mist)


def _open(eye: Eye, model: NeedleModel) -> float:
    """P/P0."""
    return eye.pupil_mm / model.pupil_mm


def needles_of(
    source: Source,
    eye: Eye,
    ambient_cd_m2: float,
    seed: int = 0,
    *,
    which: Which = "mono",
    model: NeedleModel | None = None,
) -> Needles:
    """Needles that `eye` sees around `source`; none below the contrast of 40.

    Parameters
    ----------
    ambient_cd_m2 : ≥ 0, what the eye is adapted to.
    seed, which : observer and eye: each eye has its own pattern, the same around every source.

    Source: the glare paper, equations 5 to 8, as reconstructed above.
    """
    if not (np.isfinite(ambient_cd_m2) and ambient_cd_m2 >= 0):
        raise InputError(f"must be ≥ 0 cd/m², got {ambient_cd_m2:g}", field="ambient_cd_m2")
    model = model or NeedleModel()
    pattern = pattern_of(seed, which, model.most)
    seen = gate(photometric(source.luminance_cd_m2), ambient_cd_m2, contrast=model.contrast)
    number = number_of(source, eye, ambient_cd_m2, pattern.number, model)
    weight = np.clip(number - np.arange(model.most), 0, 1) * float(seen)
    kept = weight > 0
    shape = elongation(source)
    azimuth = lobed(pattern.turn[kept], shape, np.radians(model.lobe_degrees))
    right, down = eye_axes(source.direction)
    share = model.share * min(1.0, _open(eye, model)) ** 2 * (pattern.strength * weight)[kept]
    length = model.length_degrees * reach_factor(source, eye, ambient_cd_m2, model)
    return Needles(
        direction=source.direction,
        azimuth_radians=azimuth,
        along=np.cos(azimuth)[:, None] * right + np.sin(azimuth)[:, None] * down,
        start_radians=outline_at(source, azimuth),
        length_radians=np.radians(np.minimum(length * pattern.length[kept], model.longest_degrees)),
        half_width_radians=np.radians(model.width_degrees / 2) * pattern.width[kept],
        illuminance_lux=share[:, None] * source.illuminance_lux,
        share=float(share.sum()),
        model=model,
    )
