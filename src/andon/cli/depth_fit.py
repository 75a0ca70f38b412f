"""``andon depth fit``: reads, fits, says how well, writes."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from andon.cli.console import check_apart, check_writable, note, printable
from andon.cli.depth_options import FitOptions
from andon.errors import InputError

if TYPE_CHECKING:
    from andon.calibrate.depth import DepthFit, RelativeDepth

__all__ = ["run"]

# A share of exact zeros that is a convention rather than the farthest pixel of all.
ZEROS_NOTED = 1e-3


def run(options: FitOptions) -> None:
    """Fits and writes. Raises `InputError` before anything is written."""
    _check(options)
    from andon.calibrate.depth import fit_depth, relative_depth
    from andon.cli.depth_typed import knowledge_of
    from andon.files.cameras import read_camera
    from andon.files.depth import read_depth_array

    raw = read_depth_array(options.relative)
    view = read_camera(options.camera)
    invalid = tuple(options.invalid or ())
    relative = relative_depth(
        raw, view, options.kind.value, invalid=invalid, file=str(options.relative)
    )
    zeros = float((raw == 0).mean())
    if zeros > ZEROS_NOTED and 0.0 not in invalid:
        note(f"{zeros:.1%} of the pixels are exactly 0, taken as a number; holes: --invalid 0")
    known = knowledge_of(options, relative, view)
    found = fit_depth(relative, known)
    _print(found, options)
    _write(found, relative, options)
    if options.figure is not None:
        from andon.calibrate.depth.figure import fit_picture
        from andon.files.pictures import write_picture

        write_picture(options.figure, fit_picture(relative, known, found))
    if options.json is not None:
        from andon.files.atomic import write_json

        write_json(options.json, report(found, options))
    print(options.out)


def _check(options: FitOptions) -> None:
    check_writable(options.out, (".exr", ".toml"), "--out")
    if options.figure is not None:
        check_writable(options.figure, (".png", ".jpg", ".jpeg"), "--figure")
    if options.json is not None:
        check_writable(options.json, (".json",), "--json")
    masks = [
        Path(text) for text in (*(options.planes or ()), options.floor) if text and "," not in text
    ]
    inputs = [options.relative, options.camera, *masks, *([options.known] if options.known else [])]
    check_apart(inputs, (options.out, options.figure, options.json))
    if options.out.suffix.lower() == ".toml":
        _file_in_scene(options)


def _file_in_scene(options: FitOptions) -> str:
    """The relative depth as a scene file beside --out names it."""
    named = os.path.relpath(options.relative.resolve(), options.out.resolve().parent)
    if named.startswith(".."):
        raise InputError(
            f"would name {printable(named)!r}, and a scene names no file outside its own folder",
            field="--out",
            remedy="write it to the folder of the relative depth",
        )
    return Path(named).as_posix()


def surface_table(found: DepthFit, options: FitOptions, /) -> dict[str, Any]:
    """[surface.depth] that says the same of the relative depth's own file, to the last bit."""
    table: dict[str, Any] = {"kind": "z", "scale_to_m": found.scale, "shift_m": found.shift}
    if options.kind.value == "inverse":  # z = baseline·focal/(scale·r + doffs)
        table = {"kind": "disparity", "baseline_m": 1.0, "focal_px": 1.0}
        table |= {"scale_to_m": found.scale, "doffs_px": found.shift}
    if options.invalid:
        table["invalid"] = [float(value) for value in options.invalid]
    return table


def _write(found: DepthFit, relative: RelativeDepth, options: FitOptions) -> None:
    if options.out.suffix.lower() == ".exr":
        from andon.files.pictures import write_exr

        depth = relative.metric(found.scale, found.shift)
        write_exr(options.out, depth, unit="m", photometry="absolute")
        return
    table = {"file": _file_in_scene(options), **surface_table(found, options)}
    lines = [f"{key} = {json.dumps(value, ensure_ascii=False)}" for key, value in table.items()]
    _write_text(options.out, "\n".join(["[surface.depth]", *lines]))


def _write_text(path: Path, text: str) -> None:
    from andon.files.atomic import write_bytes

    write_bytes(path, (text + "\n").encode())


def report(found: DepthFit, options: FitOptions, /) -> dict[str, Any]:
    """What was found, as JSON holds it: metres and relative shares."""
    ends = ("nearest_2_percent", "median", "farthest_2_percent")
    figures = zip(ends, found.percentiles_m, found.error_share, strict=True)
    return {
        "kind": options.kind.value,
        "scale": found.scale,
        "shift": found.shift,
        "shift_is_assumed": found.shift_is_assumed,
        "surface_depth": surface_table(found, options),
        "depth": {
            name: {"metres": metres, "standard_error_share": error}
            for name, metres, error in figures
        },
        "constraints": [
            {
                "name": row.name,
                "unit": row.unit,
                "stated": row.stated,
                "found": row.found,
                "residual": row.found - row.stated,
                "residual_share": row.share if row.unit == "m" else None,
            }
            for row in found.rows
        ],
        "planes": [{"name": name, "rms_share": rms} for rms, name in found.flatness],
        "known_median_error_share": found.scatter_share,
        "known_outlier_share": found.outlier_share,
        "behind_pixels": found.behind_pixels,
    }


def _print(found: DepthFit, options: FitOptions) -> None:
    from rich.console import Console
    from rich.table import Table

    table = Table(box=None, show_header=False, pad_edge=False)
    for name, value in _facts(found, options):
        table.add_row(name, value)
    Console(stderr=True, highlight=False, markup=False).print(table)
    if found.shift_is_assumed:
        note("the shift is undetermined: taken as 0; add a second --length, --at or --floor")
    if found.behind_pixels:
        note(f"{found.behind_pixels} pixels have no depth above 0 in this fit: holes")
    for line in found.notes:
        note(f"{line}: check its pixels and size")


def _facts(found: DepthFit, options: FitOptions) -> list[tuple[str, str]]:
    model = "1/z" if options.kind.value == "inverse" else "z"
    facts = [("model", f"{model} = {found.scale:.6g}·r {found.shift:+.6g}")]
    for name, metres, error in zip(
        ("near", "median", "far"), found.percentiles_m, found.error_share, strict=True
    ):
        facts.append((name, f"{metres:.3f} m ± {error:.1%}"))
    for row in found.rows:
        if row.unit == "degrees":
            facts.append((row.name, f"{row.found:.2f}°, stated {row.stated:g}°"))
            continue
        off = f"{(row.found - row.stated) * 1e3:+.1f} mm, {row.share:+.2%}"
        facts.append((row.name, f"{row.found:.4f} m, stated {row.stated:g} m ({off})"))
    facts += [(name, f"flat to {rms:.2%} of its distance (RMS)") for rms, name in found.flatness]
    if found.scatter_share is not None:
        off = f"median {found.scatter_share:.2%} off, {found.outlier_share:.1%} outliers"
        facts.append(("known depth", off))
    return facts
