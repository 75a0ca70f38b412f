"""``andon calibrate surface``: illuminance–RGB curves of real surfaces."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from andon.cli.console import check_apart, check_folder, note
from andon.errors import InputError

if TYPE_CHECKING:
    from andon.calibrate.surface import SurfaceFit

__all__ = ["SurfaceOptions", "run", "surface"]

# The surface that is everything, and its files.
WHOLE, WHOLE_NAME = "*", "all"
NAME = re.compile(r"[\w-]{1,64}", re.ASCII)
SNIPPET = "surface_response.toml"
FACTS = "fit.json"


@dataclass(frozen=True)
class SurfaceOptions:
    """What was typed."""

    photographs: tuple[str, ...]
    out: Path
    masks: tuple[str, ...] = ()
    response: str | None = None


def surface(
    photographs: Annotated[
        list[str],
        typer.Argument(
            metavar="PHOTO=LUX...",
            help="LUX: a number, three (200,190,150), or an EXR map of the view in lx.",
        ),
    ],
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder; is made.")],
    masks: Annotated[
        list[str] | None,
        typer.Option(
            "--mask", metavar="NAME=MASK.png", help="White is the surface NAME; repeatable."
        ),
    ] = None,
    response: Annotated[
        str | None,
        typer.Option(
            metavar="FILE.csv|srgb|linear|gamma:2.2",
            help="Of the camera; default: srgb, and linear for EXR and HDR.",
        ),
    ] = None,
) -> None:
    """Find what a camera makes of each surface in known light, from two photographs or more.

    All with one exposure, one white balance and from one place; only the light differs, and is
    known: measured with a luxmeter, or as a map. The texture of the surface cancels out. Writes,
    for each surface, NAME.csv and NAME.png; the table for the scene file and fit.json.

    Examples:

        andon calibrate surface dim.png=55 half.png=210 full.png=640 -o wall --response camera.csv

        andon calibrate surface a.exr=a_lux.exr b.exr=b_lux.exr -o room
            --mask floor=floor.png --mask wall=wall.png
    """
    run(SurfaceOptions(tuple(photographs), out, tuple(masks or ()), response))


def run(options: SurfaceOptions) -> None:
    """Reads, fits, writes. Raises `InputError` before anything is written."""
    from andon.calibrate.surface import fit_surface
    from andon.cli.known_light import read_known_light, read_masks

    named = dict(_named(word) for word in options.masks)
    if len(named) < len(options.masks):
        raise InputError("names a surface twice", field="--mask")
    typed = read_known_light(options.photographs, options.response)
    masks = read_masks(named) or {WHOLE: None}
    _check_out(options.out, [*typed.inputs, *named.values()], list(masks))
    fits = [fit_surface(typed.photographs, mask, name=name) for name, mask in masks.items()]
    _write(options.out, fits, named)
    for line in typed.assumed:
        note(line)
    _print(fits)
    print(options.out)


def _named(word: str) -> tuple[str, Path]:
    name, equals, path = word.partition("=")
    if not equals or not path or NAME.fullmatch(name) is None or name == WHOLE_NAME:
        raise InputError(
            f"must be NAME=MASK.png, the name of letters, digits, - and _, got {word[:60]!r}",
            field="--mask",
            remedy="e.g. --mask wall=wall_mask.png",
        )
    return name, Path(path)


def _file_name(surface: str) -> str:
    return WHOLE_NAME if surface == WHOLE else surface


def _check_out(out: Path, inputs: list[Path], surfaces: list[str]) -> None:
    check_folder(out)
    names = [f"{_file_name(name)}{end}" for name in surfaces for end in (".csv", ".png")]
    check_apart(inputs, [out / name for name in (*names, SNIPPET, FACTS)])


def _write(out: Path, fits: list[SurfaceFit], masks: Mapping[str, Path]) -> None:
    from andon.calibrate.surface.figure import surface_figure
    from andon.files.atomic import write_bytes, write_json
    from andon.files.pictures import write_png
    from andon.files.responses import write_surface_response

    try:
        out.mkdir(exist_ok=True)
    except OSError as error:
        raise InputError(f"cannot be made: {error.strerror}", file=out) from error
    for fit in fits:
        name = _file_name(fit.name)
        write_surface_response(out / f"{name}.csv", fit.curve)
        write_png(out / f"{name}.png", surface_figure(fit))
    tables = [_snippet(fit, out, masks.get(fit.name)) for fit in fits]
    write_bytes(out / SNIPPET, "\n".join([SNIPPET_HEAD, *tables]).encode())
    write_json(out / FACTS, {"surfaces": {fit.name: facts_of(fit) for fit in fits}})


SNIPPET_HEAD = """\
# For the scene file, if it lies beside this folder; paths there are relative to the scene file.
"""


def _snippet(fit: SurfaceFit, out: Path, mask: Path | None) -> str:
    lines = ["[[surface.response]]", f'material = "{fit.name}"']
    if mask is not None:
        lines.append(f"mask = {json.dumps(mask.as_posix(), ensure_ascii=False)}")
    file = f"{out.resolve().name}/{_file_name(fit.name)}.csv"
    return "\n".join([*lines, f"file = {json.dumps(file, ensure_ascii=False)}", ""])


def facts_of(fit: SurfaceFit) -> dict[str, Any]:
    """What the fit says, as JSON; null where nothing is known."""
    return {
        "unit_of_values": "relative: 1 is the camera's white",
        "rms_relative": fit.rms_relative.tolist(),
        "photographs": {
            name: float(rms) if rms == rms else None
            for name, rms in zip(fit.photographs, fit.photograph_rms, strict=True)
        },
        "pixels": len(fit.texture),
        "outlier_share": fit.outlier_share,
        "clipped_or_unknown_share": fit.clipped_share,
        "levelled_fall_share": fit.fall_share,
        "zero_at_0_lux_is_assumed": fit.zero_assumed,
        "exponent": [float(value) if value == value else None for value in fit.exponent],
        "largest_distance_from_straight": fit.straightness.tolist(),
    }


def _print(fits: list[SurfaceFit]) -> None:
    for fit in fits:
        red, green, blue = (100 * value for value in fit.rms_relative)
        bent, slope = 100 * fit.straightness.max(), ", ".join(f"{e:.2f}" for e in fit.exponent)
        note(
            f"{_file_name(fit.name)}: left over {red:.1f}, {green:.1f}, {blue:.1f} % RMS in R, G, "
            f"B; at most {bent:.1f} % of its range off a straight line, exponent {slope}"
        )
        if fit.outlier_share >= 0.01:
            note(f"{_file_name(fit.name)}: {fit.outlier_share:.1%} of the values are outliers")
        if fit.zero_assumed:
            note(f"{_file_name(fit.name)}: no photograph is dark; 0 at 0 lx is assumed")
        if fit.fall_share > 0:
            note(f"{_file_name(fit.name)}: falls by {fit.fall_share:.2%}, within noise; levelled")
        if len(fit.photographs) == 1:
            note(f"{_file_name(fit.name)}: of one photograph, texture is taken for light")
