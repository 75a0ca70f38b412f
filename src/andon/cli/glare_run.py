"""What ``andon glare IN -o OUT`` does: reads, scatters for each eye, writes."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from andon.cli.console import check_apart, check_writable, note, steps
from andon.cli.glare import GlareOptions
from andon.cli.glare_typed import ages_of, exposure_of, eye_of, gaze_of, model_of, one_of, view_of
from andon.errors import InputError

if TYPE_CHECKING:
    from andon.glare.calibration import Calibrated
    from andon.glare.picture import GlareResult

__all__ = ["run"]

PICTURES, LIGHT = (".png", ".jpg", ".jpeg"), (".exr", ".hdr")
RENDERERS = ("auto", "per-source", "whole-picture")


def run(options: GlareOptions) -> None:
    """Reads, scatters, writes. Raises `InputError` before anything is written."""
    ages = _check(options)
    seen = _read(options)
    results = _results(options, seen, ages)
    check = _checked(results[0]) if options.evalglare else None
    for warning in (*seen.warnings, *results[0].warnings):
        note(warning)
    _note_assumed(options, seen, results[0])
    _write(options, seen, results, check)
    for line in _told(results[-1]):
        note(line)
    print(options.out)


def _note_assumed(options: GlareOptions, seen: Calibrated, result: GlareResult) -> None:
    """What was taken for granted, and what was asked for in vain."""
    width, height = seen.view.width, seen.view.height
    if seen.view.projection == "latlong" and abs(width - 2 * height) > 0.02 * width:
        note(f"{width}×{height} is no 2:1: taken as the whole sphere, its pixels are not square")
    if seen.photometry == "relative":
        eye = result.eye
        note(f"without cd/m² the eye is {eye.adaptation}, its pupil {eye.pupil_mm:g} mm")
    if options.renderer == "per-source" and not result.found.sources:
        note(
            "no source is 40 times brighter than the picture, so that nothing is scattered; "
            "--renderer whole-picture scatters all light"
        )


def _check(options: GlareOptions) -> tuple[float, ...]:
    """The ages; all else that can be refused before the picture is read."""
    check_writable(options.out, (*PICTURES, *LIGHT), "--out")
    if options.veil_map is not None:
        check_writable(options.veil_map, (".exr", ".png"), "--veil-map")
    if options.report is not None:
        check_writable(options.report, (".json",), "--report")
    inputs = [options.picture, *([options.camera] if options.camera else [])]
    check_apart(inputs, [options.out, options.veil_map, options.report])
    ages = ages_of(options.age)
    is_light = options.out.suffix.lower() in LIGHT
    if is_light and (len(ages) > 1 or options.compare):
        raise InputError(
            "several pictures make a sheet, which is for people",
            file=options.out,
            field="--out",
            remedy="name a .png, or give one age and no --compare",
        )
    if options.veil_map is not None and len(ages) > 1:
        raise InputError("is of one eye: give one age", field="--veil-map")
    if options.evalglare and (options.report is None or options.gaze is not None):
        raise InputError(
            "goes into the report, of an eye that looks straight ahead",
            field="--evalglare",
            remedy="name a --report, and leave --gaze out",
        )
    one_of(options.renderer, RENDERERS, "--renderer")
    model_of(options.model)
    eye_of(options, min(ages), None)
    exposure_of(options.exposure)
    return ages


def _read(options: GlareOptions) -> Calibrated:
    from andon.files.limits import DEFAULT_LIMITS
    from andon.files.pictures import read_picture
    from andon.glare.calibration import calibrated
    from andon.glare.cleaning import MAX_PIXELS

    limits = replace(DEFAULT_LIMITS, max_pixels=MAX_PIXELS)
    picture = read_picture(options.picture, limits=limits)
    if not np.isfinite(picture.values).any():
        raise InputError("has no pixel that is a number", file=options.picture)
    return calibrated(
        picture,
        view=view_of(options, picture),
        cd_m2_per_unit=options.luminance_scale,
        file=str(options.picture),
    )


def _results(options: GlareOptions, seen: Calibrated, ages: tuple[float, ...]) -> list[GlareResult]:
    from andon.glare.picture import glare_of_picture

    level = _level(seen)
    gaze = gaze_of(options.gaze, seen.view)
    renderer: Any = options.renderer
    engine: Any = options.engine
    results: list[GlareResult] = []
    with steps("scattering", len(ages)) as step:
        for age in ages:
            results.append(
                glare_of_picture(
                    seen.luminance_cd_m2,
                    seen.view,
                    eye_of(options, age, level),
                    options.model,
                    renderer=renderer,
                    engine=engine,
                    gaze=gaze,
                    photometry=seen.photometry,
                    clipped=seen.clipped,
                    shows=seen.shows,
                )
            )
            step()
    return results


def _level(seen: Calibrated) -> float | None:
    """What the eye is adapted to, cd/m²; None where the picture is relative."""
    if seen.photometry == "relative":
        return None
    from andon.glare.cleaning import cleaned
    from andon.glare.sources.find import background_luminance
    from andon.quantities import photometric

    light = photometric(cleaned(seen.luminance_cd_m2, seen.view, seen.shows).light)
    solid = seen.view.solid_angles()
    shows = np.ones(light.shape, bool) if seen.shows is None else seen.shows
    return background_luminance(light[shows], solid[shows])


def _write(options: GlareOptions, seen: Calibrated, results: list[GlareResult], check: Any) -> None:
    from andon.cli.glare_outputs import write_light, write_report, write_veil

    first = results[0]
    map_file = None if options.veil_map is None else options.veil_map.name
    reports = [_report(result, seen, map_file) | (check or {}) for result in results]
    if options.out.suffix.lower() in LIGHT:
        light = first.glare if options.glare_only else first.picture
        write_light(options.out, light, first, seen, additive=options.glare_only)
    else:
        _write_picture(options, seen, results)
    if options.veil_map is not None:
        write_veil(options.veil_map, first)
    if options.report is not None:
        write_report(options.report, reports)


def _write_picture(options: GlareOptions, seen: Calibrated, results: list[GlareResult]) -> None:
    from andon.cli.glare_outputs import auto_exposure, caption, exposed, sheet
    from andon.files.pictures import write_picture

    stated = exposure_of(options.exposure)
    scale = auto_exposure(seen) if stated is None else stated
    tiles: list[tuple[str, NDArray[np.uint8]]] = []
    if options.compare:
        tiles.append((f"{options.picture.name}, original", exposed(results[0].pixels.light, scale)))
    for result in results:
        light = result.glare if options.glare_only else result.picture
        tiles.append((caption(result), exposed(light, scale)))
    write_picture(options.out, tiles[0][1] if len(tiles) == 1 else sheet(tiles))
    if stated is None:
        note(
            f"exposure {scale:.4g} per cd/m²"
            + (", of the log mean" if seen.clipped is None else "")
        )


def _checked(result: GlareResult) -> dict[str, Any]:
    """What Radiance's evalglare says of the same light."""
    from andon.glare.numbers.evalglare import evalglare
    from andon.glare.report import rounded
    from andon.quantities import photometric

    threshold = result.numbers.discomfort.threshold_cd_m2
    light = photometric(result.pixels.light)
    found = evalglare(light, result.view, threshold_cd_m2=threshold)
    values = {name: rounded(value) for name, value in found.values.items()}
    return {"evalglare": {"sources": found.sources, "threshold_cd_m2": rounded(threshold)} | values}


def _report(result: GlareResult, seen: Calibrated, map_file: str | None) -> Any:
    told = result.report(map_file=map_file, warnings=seen.warnings)
    told["view"] |= {"angles_from": seen.angles_from}
    told["pixels"] |= {"cd_m2_per_unit": seen.cd_m2_per_unit, "light_from": seen.light_from}
    return told


def _short(value: float) -> str:
    """Three digits, without an exponent where a person would write none."""
    return f"{float(f'{value:.3g}'):g}"


def _told(result: GlareResult) -> list[str]:
    """The main numbers of the last eye, as lines."""
    numbers = result.numbers
    word = result.photometry
    unit = "cd/m²" if word == "absolute" else "(relative)"
    lines = [
        f"{result.eye.age_years:g} years: a veil of {_short(numbers.veil_cd_m2)} {unit} where the "
        f"eye looks; the picture's mean without sources is {_short(numbers.adaptation_cd_m2)}; "
        f"sources: {len(result.found.sources)}"
    ]
    for name, value in (("TI", numbers.ti_percent), ("UGR", numbers.ugr), ("DGP", numbers.dgp)):
        valid = numbers.validity[{"TI": "ti_percent"}.get(name, name.lower())]
        if value is not None and valid.holds:
            lines.append(f"{name} {value:.3g} {valid.unit if valid.unit != '1' else ''}".rstrip())
    return lines
