"""All numbers of one picture at one point of gaze, each with where it holds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.glare.kernel import Kernel
from andon.glare.numbers.indices import (
    DGP_LEAST_LUX,
    DGP_RANGE,
    TI_MOST_CD_M2,
    UGR_SOLID_ANGLES_SR,
    daylight_glare_probability,
    position_index,
    threshold_increment_percent,
    unified_glare_rating,
)
from andon.glare.numbers.veil import veil_towards, vertical_illuminance
from andon.glare.sources.find import background_luminance, find_sources
from andon.quantities import Photometry, photometric
from andon.spaces import View

__all__ = ["Discomfort", "GlareNumbers", "Validity", "measured"]

Float = NDArray[np.float64]

# evalglare's settings: what is brighter than 2000 cd/m² is a source, those within 0.2 rad are one,
# but peaks of more than 50,000 cd/m² are taken out of them. Of relative pictures bright is 5 times
# the mean, its older setting (Wienold & Christoffersen 2006), and there are no peaks.
SOURCE_CD_M2, PEAK_CD_M2, RELATIVE_CONTRAST = 2000.0, 50000.0, 5.0
MERGE_DEGREES, MOST_SOURCES = float(np.degrees(0.2)), 200
UP = np.array([0.0, -1.0, 0.0])
# Light from beside a picture is missing in the sums; a half-space and some tolerance has it all.
WHOLE_FIELD_SR = 2 * np.pi * 0.9


@dataclass(frozen=True)
class Validity:
    """Where a number holds.

    Attributes
    ----------
    unit : of the number.
    range : of what it was made for, in words.
    holds : whether this picture is within it.
    why : what is not, or empty.
    """

    unit: str
    range: str
    holds: bool
    why: str = ""


@dataclass(frozen=True, eq=False)
class Discomfort:
    """Sources as the indices of discomfort take them.

    Attributes
    ----------
    directions : (n, 3) unit.
    solid_angle_sr, cd_m2, index : (n,) size, mean luminance, position index.
    direct_lux : their light on a plane that faces the gaze.
    threshold_cd_m2 : what counted as bright.
    """

    directions: Float
    solid_angle_sr: Float
    cd_m2: Float
    index: Float
    direct_lux: float
    threshold_cd_m2: float


@dataclass(frozen=True, eq=False)
class GlareNumbers:
    """What was measured.

    Attributes
    ----------
    gaze : (3,) unit, camera frame.
    veil : (3,) cd/m² over what is looked at.
    vertical_lux : at the eye, of all that the picture shows.
    adaptation_cd_m2 : mean luminance without what is 40 times brighter.
    background_cd_m2 : L_b of UGR: light at the eye without the discomfort sources, over π.
    discomfort : the sources of UGR and DGP: one more row for each peak.
    ti_percent, ugr, dgp : None where they cannot be computed.
    validity : by the name of the number.
    """

    gaze: Float
    veil: Float
    vertical_lux: float
    adaptation_cd_m2: float
    background_cd_m2: float
    discomfort: Discomfort
    ti_percent: float | None
    ugr: float | None
    dgp: float | None
    validity: dict[str, Validity]

    @property
    def veil_cd_m2(self) -> float:
        """Photometric value of the veil."""
        return float(photometric(self.veil))


def measured(
    light: Float, view: View, kernel: Kernel, gaze: Float, photometry: Photometry, /
) -> GlareNumbers:
    """The numbers of a picture (H, W, 3) in cd/m², finite and ≥ 0, that is looked at in `gaze`."""
    solid = view.solid_angles()
    before = view.directions() @ gaze > 0
    bright = photometric(light)
    veil = veil_towards(gaze[None], light, view, kernel)[0]
    vertical = float(photometric(vertical_illuminance(light, view, gaze)))
    adaptation = background_luminance(bright[before], solid[before]) if before.any() else 0.0
    mean = float(np.average(bright[before], weights=solid[before])) if before.any() else 0.0
    seen = np.where(before[..., None], light, 0)
    discomfort = _discomfort(seen, view, gaze, photometry, RELATIVE_CONTRAST * mean)
    omega, luminance, index = discomfort.solid_angle_sr, discomfort.cd_m2, discomfort.index
    background = max(vertical - discomfort.direct_lux, 0.0) / np.pi
    veil_value = float(photometric(veil))
    ti = threshold_increment_percent(veil_value, adaptation) if adaptation > 0 else None
    ugr = unified_glare_rating(luminance, omega, index, background) if background > 0 else None
    dgp = daylight_glare_probability(luminance, omega, index, vertical) if vertical > 0 else None
    facts = _Facts(photometry, float(solid[before].sum()), adaptation, omega, vertical, dgp, kernel)
    return GlareNumbers(
        gaze, veil, vertical, adaptation, background, discomfort, ti, ugr, dgp, _validity(facts)
    )


def _discomfort(
    seen: Float, view: View, gaze: Float, photometry: Photometry, relative: float
) -> Discomfort:
    """Sources in `seen` (H, W, 3); `relative` is the threshold of pictures without calibration."""
    absolute = photometry == "absolute"
    threshold = SOURCE_CD_M2 if absolute else relative
    peak = (photometric(seen) > PEAK_CD_M2)[..., None] if absolute else np.zeros((), bool)
    parts = (
        (np.where(peak, 0, seen), threshold, MERGE_DEGREES),
        (np.where(peak, seen, 0), max(threshold, PEAK_CD_M2), 0.0),
    )
    found = [
        find_sources(light, view, threshold_cd_m2=at, merge_degrees=merge, most=MOST_SOURCES)
        for light, at, merge in (parts if np.any(peak) else parts[:1])
    ]
    directions = np.array([s.direction for part in found for s in part.sources]).reshape(-1, 3)
    lux = np.array([s.illuminance_lux for part in found for s in part.sources]).reshape(-1, 3)
    omega = np.concatenate([part.solid_angle_sr for part in found])
    cosine = np.maximum(directions @ gaze, 0)
    return Discomfort(
        directions,
        omega,
        photometric(lux) / omega,
        position_index(directions, gaze, UP),
        float(cosine @ photometric(lux)),
        threshold,
    )


@dataclass(frozen=True, eq=False)
class _Facts:
    photometry: Photometry
    field_sr: float
    adaptation: float
    omega: Float
    vertical: float
    dgp: float | None
    kernel: Kernel


def _validity(facts: _Facts) -> dict[str, Validity]:
    absolute = "" if facts.photometry == "absolute" else "the picture is not calibrated: relative"
    narrow = "" if facts.field_sr >= WHOLE_FIELD_SR else "light beside the picture is missing"
    least, most = facts.kernel.minimum_degrees, facts.kernel.spread.valid_degrees[1]
    small, large = UGR_SOLID_ANGLES_SR
    sizes = facts.omega
    odd = int(np.count_nonzero((sizes < small) | (sizes > large)))
    dark = facts.adaptation > TI_MOST_CD_M2
    dim = facts.vertical < DGP_LEAST_LUX
    beyond = facts.dgp is None or not DGP_RANGE[0] <= facts.dgp <= DGP_RANGE[1]
    return {
        "veil_cd_m2": _of("cd/m²", f"light {least:g}…{most:g}° from the gaze", absolute, narrow),
        "ti_percent": _of(
            "%",
            f"adaptation of 0.05…{TI_MOST_CD_M2:g} cd/m²",
            absolute,
            narrow,
            f"adaptation is {facts.adaptation:.3g} cd/m²" if dark else "",
        ),
        "ugr": _of(
            "1",
            f"sources of {small:g}…{large:g} sr, 10…30",
            absolute,
            narrow,
            f"{odd} of {len(sizes)} sources have other sizes" if odd else "",
            "" if len(sizes) else "there is no source",
        ),
        "dgp": _of(
            "1",
            f"{DGP_RANGE[0]}…{DGP_RANGE[1]}, ≥ {DGP_LEAST_LUX:g} lx at the eye, daylight",
            absolute,
            narrow,
            f"{facts.vertical:.3g} lx at the eye" if dim else "",
            "outside 0.2…0.8" if beyond else "",
        ),
    }


def _of(unit: str, range: str, *reasons: str) -> Validity:
    why = "; ".join(reason for reason in reasons if reason)
    return Validity(unit, range, not why, why)
