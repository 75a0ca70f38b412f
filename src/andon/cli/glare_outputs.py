"""What ``andon glare`` writes: pictures at one exposure, light, veils, sheets, reports."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from andon.glare.calibration import Calibrated
    from andon.glare.picture import GlareResult

    Tone = Literal["none", "hue", "reinhard", "fusion"]

__all__ = [
    "auto_exposure",
    "caption",
    "exposed",
    "sheet",
    "write_light",
    "write_report",
    "write_veil",
]

Float = NDArray[np.float64]
Rgb = NDArray[np.uint8]

# Screen value of the mean of the logarithm: middle grey, of photographic practice.
MIDDLE_GREY = 0.18
# Darker than this share of the mean is as good as black, and would pull the logarithm down.
BLACK = 1e-4
# Sheets are not wider than this.
SHEET_PX = 3200


def auto_exposure(seen: Calibrated) -> float:
    """Screen value per cd/m²: as photographed, or the log mean of HDR at middle grey and below.

    Below where most of a picture is dark beside its lights, so that a night stays one: the key is
    then 0.18·4^f, f the place of the log mean between the 1st (−1) and the 99th percentile (+1)
    (Reinhard 2002, "Parameter estimation for photographic tone reproduction"). A high key is left
    out: it would take the sky of a day to white.
    """
    if seen.clipped is not None:
        return 1 / seen.cd_m2_per_unit
    from andon.quantities import photometric

    light = photometric(np.nan_to_num(seen.luminance_cd_m2.astype(np.float64), posinf=0, neginf=0))
    weights = seen.view.solid_angles()
    if seen.shows is not None:
        weights = np.where(seen.shows, weights, 0)
    lit = light > BLACK * max(float(np.average(light.clip(0), weights=weights)), 1e-30)
    if not (lit & (weights > 0)).any():
        return 1.0
    logs = np.log(light[lit])
    mean = float(np.average(logs, weights=weights[lit]))
    low, high = np.quantile(logs, (0.01, 0.99))
    place = (2 * mean - low - high) / max(high - low, 1e-9)
    return MIDDLE_GREY * 4.0 ** min(float(place), 0.0) / float(np.exp(mean))


def exposed(light: Float, units_per_cd_m2: float, tone: Tone = "hue") -> Rgb:
    """(H, W, 3) sRGB codes; with the tone ``hue`` what is brighter than white keeps its hue."""
    from andon.display.model import Exposure
    from andon.display.reference import encode
    from andon.responses import SRGB

    return encode(light, Exposure(units_per_cd_m2, tone), SRGB, 1.0)


def caption(result: GlareResult) -> str:
    """What stands above a picture of a sheet."""
    eye, veil = result.eye, result.numbers.veil_cd_m2
    # Pillow's own font has no superscripts.
    unit = "cd/m2" if result.photometry == "absolute" else "(relative)"
    return (
        f"{eye.age_years:g} years, pigment {eye.pigment:g}, pupil {eye.pupil_mm:.1f} mm, "
        f"{result.model.name}: veil at the gaze {veil:.3g} {unit}"
    )


def sheet(tiles: Sequence[tuple[str, Rgb]]) -> Rgb:
    """Captioned pictures side by side, or one below the other where they are wide."""
    from andon.display.false_colour import GAP_PX, contact_sheet

    most = max(1, SHEET_PX // tiles[0][1].shape[1])
    # As many rows as that takes, evenly filled.
    rows = -(-len(tiles) // most)
    return contact_sheet(list(tiles), columns=-(-len(tiles) // rows), gap_px=GAP_PX)


def write_light(
    path: Path, light: Float, result: GlareResult, seen: Calibrated, additive: bool
) -> None:
    """EXR in cd/m², or Radiance's picture; additive light has alpha 0."""
    from andon.files.pictures import write_exr, write_hdr
    from andon.files.pictures.radiance_view import line_of_view
    from andon.glare.calibration import LUMENS_PER_WATT

    values = light.astype(np.float32)
    if path.suffix.lower() == ".exr":
        cover = np.zeros(values.shape[:2], np.float32) if additive else None
        write_exr(path, values, unit="cd/m2", photometry=result.photometry, alpha=cover)
        return
    per_unit = LUMENS_PER_WATT if result.photometry == "absolute" else seen.cd_m2_per_unit
    write_hdr(path, values / np.float32(per_unit), view_line=line_of_view(result.view))


def write_veil(path: Path, result: GlareResult) -> None:
    """The veil towards every direction: EXR in cd/m², PNG in false colours."""
    from andon.display.false_colour import false_colour
    from andon.files.pictures import write_exr, write_png
    from andon.quantities import photometric

    if path.suffix.lower() == ".exr":
        write_exr(path, result.veil.astype(np.float32), unit="cd/m2", photometry=result.photometry)
        return
    unit = "cd/m2" if result.photometry == "absolute" else "relative"
    write_png(path, false_colour(photometric(result.veil), unit))


def write_report(path: Path, reports: Sequence[Any]) -> None:
    """One report, or a list of one for each eye."""
    from andon.files.atomic import write_bytes

    value = reports[0] if len(reports) == 1 else list(reports)
    write_bytes(path, (json.dumps(value, indent=2, ensure_ascii=False) + "\n").encode())
