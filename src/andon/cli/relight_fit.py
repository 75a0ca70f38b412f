"""``andon relight --fit-to``: lamps fitted to a reference photograph."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from andon.cli.console import check_writable, note
from andon.cli.options import RelightOptions
from andon.errors import InputError

if TYPE_CHECKING:
    from andon.calibrate.lamps import FittedLight, LampFit, Measures
    from andon.scene import Scene

__all__ = ["check_fit", "fit_inputs", "fit_outputs", "fitted", "print_fit", "write_fit"]

PREFIX = "fit_"
# Names of predictions and regions in the table.
PREDICTIONS = {
    "fitted": "fitted",
    "unchanged": "unchanged",
    "gain_one": "best gain",
    "gain_channels": "gain of each channel",
}
REGIONS = ("inside", "outside", "whole")


def fit_outputs(options: RelightOptions) -> list[Path]:
    """What a fit writes besides the picture."""
    paths = options.fit_report, options.fit_figure, options.fit_scene
    return [path for path in paths if path is not None]


def fit_inputs(options: RelightOptions) -> list[Path]:
    """What a fit reads besides the scene."""
    return [path for path in (options.fit_to, options.fit_mask) if path is not None]


def check_fit(options: RelightOptions) -> None:
    """Refuses options of a fit without one, and outputs that cannot be written."""
    if options.fit_to is None:
        for field in fields(options):
            is_default = getattr(options, field.name) == field.default
            if field.name.startswith(PREFIX) and not is_default:
                raise InputError(
                    "is of a fit, and there is none",
                    field=_option(field.name),
                    remedy="name the reference photograph: --fit-to REFERENCE.png",
                )
        return
    for name, suffix in (("fit_report", ".json"), ("fit_figure", ".png"), ("fit_scene", ".toml")):
        path = getattr(options, name)
        if path is not None:
            check_writable(path, (suffix,), _option(name))


def fitted(options: RelightOptions, scene: Scene) -> LampFit:
    """The fit that was asked for. Raises `InputError` with the options' names."""
    from andon.calibrate.lamps import FitSettings, fit_lamps
    from andon.cli.bar import Bar

    if options.fit_scene is not None:
        _portable(scene, options.fit_scene)
    names = [table.name for table in scene.lamp]
    with Bar("reading") as bar:
        try:
            return fit_lamps(
                scene,
                options.fit_to,
                mask=options.fit_mask,
                settings=FitSettings(
                    _names(options.fit_lamps, names),
                    cast(Any, options.fit_dimming),
                    options.fit_colour,
                    options.fit_bounce,
                    options.fit_response,
                    cast(Any, options.fit_align),
                    options.time_seconds,
                    options.view,
                    cast(Any, options.engine),
                ),
                progress=bar.show,
            )
        except InputError as error:
            if error.field is None or not error.field.startswith(PREFIX):
                raise
            raise InputError(
                error.rule, file=error.file, field=_option(error.field), remedy=error.remedy
            ) from error


def _names(typed: list[str] | None, known: list[str]) -> tuple[str, ...] | None:
    """Names apart at commas, but for those that have one themselves."""
    if typed is None:
        return None
    found: list[str] = []
    for text in typed:
        parts = [text] if text in known else text.split(",")
        found += [part.strip() for part in parts if part.strip()]
    return tuple(found)


def _option(field: str) -> str:
    return "--" + field.replace("_", "-")


def write_fit(options: RelightOptions, fit: LampFit) -> None:
    """Report, figure and scene, where they were asked for."""
    from andon.calibrate.lamps.figure import fit_figure
    from andon.calibrate.lamps.report import fit_report
    from andon.files.atomic import write_bytes, write_json
    from andon.files.pictures import write_picture

    if options.fit_report is not None:
        write_json(options.fit_report, fit_report(fit))
    if options.fit_figure is not None:
        write_picture(options.fit_figure, fit_figure(fit))
    if options.fit_scene is not None and fit.scene is not None:
        write_bytes(options.fit_scene, _portable(fit.scene, options.fit_scene).encode())


def _portable(scene: Scene, path: Path) -> str:
    """The scene as a file at `path`, which names its files by where they lie from there.

    Raises `InputError` where one of them lies beyond the file's folder.
    """
    from andon.scene.dump import toml_text

    folder = path.resolve().parent

    def moved(value: Any) -> Any:
        if isinstance(value, dict):
            tables = cast(dict[str, Any], value)
            return {key: moved(inner) for key, inner in tables.items()}
        if isinstance(value, list | tuple):
            return [moved(inner) for inner in cast(tuple[Any, ...], value)]
        return _relative(value, folder) if isinstance(value, str) else value

    tables = scene.model_dump(mode="python", exclude_defaults=True)
    if scene.file != "command line" and scene.folder.resolve() != folder:
        raise InputError(
            f"must lie in the scene's folder, {str(scene.folder)!r}, to which its paths are "
            "relative",
            file=path,
            field="--fit-scene",
        )
    return toml_text(moved(tables))


def _relative(text: str, folder: Path) -> str:
    if not os.path.isabs(text):
        return text
    try:
        return Path(text).resolve().relative_to(folder).as_posix()
    except ValueError:
        raise InputError(
            f"{text!r} lies beyond its folder, in which all files of a scene lie",
            file=folder,
            field="--fit-scene",
            remedy="write it to a folder that holds them all, or leave it out",
        ) from None


def print_fit(fit: LampFit) -> None:
    """Fitted values and errors on stderr."""
    from rich.console import Console
    from rich.table import Table

    console = Console(stderr=True)
    values = Table(box=None, show_header=False, pad_edge=False)
    for row in _rows(fit):
        values.add_row(*row)
    console.print(values)
    errors = Table(box=None, pad_edge=False)
    for head in ("error, PSNR and mean ΔE₀₀", *PREDICTIONS.values()):
        errors.add_column(head)
    for name, measures in _regions(fit):
        parts = (measures[key] for key in PREDICTIONS)
        errors.add_row(name, *(f"{m.psnr_db:.2f} dB  {m.delta_e_mean:.2f}" for m in parts))
    console.print(errors)
    for line in fit.notes:
        note(line)


def _rows(fit: LampFit) -> list[tuple[str, str]]:
    rows = [("fitted", _lamp_text(fit, light)) for light in fit.lamps]
    if fit.dimming is not None:
        text = f"dimming: {_factors(fit.dimming)} of the scene's"
        rows.append(("fitted", f"{text}; of another exposure, lamps give that much less too"))
    if fit.fill is not None:
        sky, ground = (_triple(lux) for lux in (fit.fill.sky_lux, fit.fill.ground_lux))
        text = f"from above {sky} lx, from below {ground} lx ({fit.photometry})"
        rows.append(("fitted", f"bounce: {text}; {fit.fill.share:.0%} of the added light"))
    if fit.responses:
        tried = sorted(fit.responses.items(), key=lambda item: item[1])
        best = ", ".join(f"{name} {rmse:.4f}" for name, rmse in tried[:4])
        rows.append(("response", f"{tried[0][0]}; RMSE of codes: {best}"))
    return rows


def _regions(fit: LampFit) -> list[tuple[str, Mapping[str, Measures]]]:
    """Regions in their order; without holes where there are any."""
    found: list[tuple[str, Mapping[str, Measures]]] = []
    for region in REGIONS:
        own, bare = fit.measures.get(region), fit.measures.get(f"{region}_without_holes")
        if own is not None:
            found.append((region, own))
        if own is not None and bare and bare["fitted"].pixels != own["fitted"].pixels:
            found.append((f"{region}, no holes", bare))
    return found


def _lamp_text(fit: LampFit, light: FittedLight) -> str:
    from andon.calibrate.lamps.report import stated_light

    stated = stated_light(fit, light.name)
    values = ", ".join(f"{key} = {_value(value)}" for key, value in stated.items())
    return (
        f"{light.name}: {values} ({fit.photometry}); {_factors(light)} of what was stated, "
        f"{light.share:.0%} of the added light"
    )


def _value(value: Any) -> str:
    return _triple(value) if isinstance(value, tuple) else f"{value:.6g}"


def _triple(values: Any) -> str:
    return "[" + ", ".join(f"{value:.4g}" for value in values) + "]"


def _factors(light: FittedLight) -> str:
    texts = [
        f"{factor:.4g} ± {error:.1g}" if light.told_apart else f"{factor:.4g}"
        for factor, error in zip(light.factor, light.error, strict=True)
    ]
    return texts[0] if (light.factor == light.factor[0]).all() else f"[{', '.join(texts)}]"
