"""The report of ``andon glare``: numbers with their units and where they hold, as JSON."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from andon.quantities import photometric

if TYPE_CHECKING:
    from andon.glare.model import Source
    from andon.glare.picture import GlareResult

__all__ = ["report", "warnings_of"]

DIGITS = 6


def report(
    result: GlareResult, /, *, map_file: str | None = None, warnings: tuple[str, ...] = ()
) -> dict[str, Any]:
    """What a `GlareResult` says in numbers.

    Parameters
    ----------
    map_file : where the veil towards every direction was written.
    warnings : of who prepared the picture; those of the pixels are added.

    Returns
    -------
    dict
        of numbers, text, lists and None only: ``photometry, pixels, view, observer, model,
        sources, veil_cd_m2, ti_percent, ugr, dgp, levels, validity, warnings``. Directions are
        unit vectors of the camera frame (x right, y down, z forward); `validity` has unit, range
        and whether it holds for each of the four numbers.
    """
    numbers, found = result.numbers, result.found
    luminances = photometric(found.luminance_cd_m2)
    sources = [
        _source(source, float(solid), float(luminance))
        for source, solid, luminance in zip(
            found.sources, found.solid_angle_sr, luminances, strict=True
        )
    ]
    return {
        "photometry": result.photometry,
        "pixels": {
            "width": result.view.width,
            "height": result.view.height,
            "nan": result.pixels.nan,
            "infinite": result.pixels.infinite,
            "negative": result.pixels.negative,
            "outside": result.pixels.outside,
        },
        "view": _view(result),
        "observer": asdict(result.eye) | {"pupil_mm": rounded(result.eye.pupil_mm)},
        "model": _model(result),
        "sources": sources,
        "veil_cd_m2": {
            "gaze": rounded(numbers.veil_cd_m2),
            "gaze_rgb": rounded(numbers.veil),
            "gaze_direction": rounded(numbers.gaze),
            "map_file": map_file,
        },
        "ti_percent": rounded(numbers.ti_percent),
        "ugr": rounded(numbers.ugr),
        "dgp": rounded(numbers.dgp),
        "levels": {
            "adaptation_cd_m2": rounded(numbers.adaptation_cd_m2),
            "background_cd_m2": rounded(numbers.background_cd_m2),
            "vertical_lux": rounded(numbers.vertical_lux),
            "source_threshold_cd_m2": rounded(found.threshold_cd_m2),
        },
        "validity": {name: asdict(value) for name, value in numbers.validity.items()},
        "warnings": [*warnings, *result.warnings],
    }


def rounded(value: float | NDArray[Any] | None, /) -> Any:
    """A number or a list of them to six significant digits; None where it is not finite."""
    if value is None:
        return None
    if isinstance(value, np.ndarray):
        return [rounded(float(part)) for part in value]
    return float(f"{value:.{DIGITS}g}") if np.isfinite(value) else None


def _source(source: Source, solid_angle: float, luminance: float) -> dict[str, Any]:
    radii = np.degrees(source.outline.radii_radians)
    return {
        "name": source.name,
        "direction": rounded(source.direction),
        "solid_angle_sr": rounded(solid_angle),
        "luminance_cd_m2": rounded(luminance),
        "illuminance_lux": rounded(float(photometric(source.illuminance_lux))),
        "illuminance_lux_rgb": rounded(source.illuminance_lux),
        "radius_degrees": {"least": rounded(radii.min()), "most": rounded(radii.max())},
        "clipped": source.clipped,
    }


def _view(result: GlareResult) -> dict[str, Any]:
    view = result.view
    facts: dict[str, Any] = {"projection": view.projection}
    if view.projection == "latlong":
        return facts | {"hfov_degrees": 360.0}
    half = view.width / 2 / view.fx
    half = float(np.arctan(half)) if view.projection == "pinhole" else half
    return facts | {
        "hfov_degrees": rounded(float(np.degrees(2 * half))),
        "fx_px": rounded(view.fx),
        "fy_px": rounded(view.fy),
        "cx_px": rounded(view.cx),
        "cy_px": rounded(view.cy),
    }


def _model(result: GlareResult) -> dict[str, Any]:
    return {
        "name": result.model.name,
        "valid_degrees": list(result.model.valid_degrees),
        "scattered_share": rounded(result.share),
        "renderer": result.renderer,
        "engine": result.engine,
        "sources_with_halo": result.stars[0],
        "sources_with_needles": result.stars[1],
    }


def warnings_of(result: GlareResult, /) -> tuple[str, ...]:
    """What is wrong with the pixels and sources of a picture, a line each."""
    lines: list[str] = []
    pixels = result.pixels
    for count, what in (
        (pixels.nan, "NaN"),
        (pixels.infinite, "infinite"),
        (pixels.negative, "negative"),
    ):
        if count:
            lines.append(f"pixels that are {what}: {count}; they count as 0")
    clipped = sum(source.clipped for source in result.found.sources)
    if clipped:
        lines.append(
            f"{clipped} of {len(result.found.sources)} sources are clipped: they are brighter than "
            "the picture says, and so is their glare"
        )
    if result.found.left_out:
        lines.append(
            f"{result.found.left_out} weaker bright regions are not listed; they have "
            f"{result.found.left_out_share:.1%} of all their light"
        )
    return tuple(lines)
