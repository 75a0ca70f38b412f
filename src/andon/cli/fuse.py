"""``andon fuse``: photographs of several exposures as one picture, or as light."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from andon.cli.bracket import BracketOptions, aligned_bracket, check_bracket, read_bracket
from andon.cli.console import check_writable, note
from andon.errors import InputError

if TYPE_CHECKING:
    from andon.capture.brackets import Bracket
    from andon.capture.merge import Merged

__all__ = ["FuseOptions", "run"]

PICTURES, LIGHT = (".png", ".jpg", ".jpeg"), (".exr", ".hdr")
SHEET_COLUMNS = 4
SHEET_WIDTH_PX = 320
# Shares that are not 0.00 % when printed.
LEAST_NOTED = 5e-5


@dataclass(frozen=True)
class FuseOptions:
    """The options of the command, as typed."""

    photos: Sequence[Path]
    out: Path
    seconds: str | None = None
    exposures: Path | None = None
    align: str = "auto"
    sheet: Path | None = None
    response: Path | None = None


def run(options: FuseOptions) -> None:
    """Reads, aligns, fuses or merges, writes. Raises `InputError` before anything is written."""
    typed = BracketOptions(options.photos, options.seconds, options.exposures, options.align)
    outputs = options.out, options.sheet, options.response
    _check(options)
    check_bracket(typed, outputs)
    is_light = options.out.suffix.lower() in LIGHT
    bracket = read_bracket(typed, outputs)
    from andon.capture.brackets import check_exposures

    if is_light:
        check_exposures(bracket)
    bracket, _ = aligned_bracket(bracket, options.align)
    if is_light:
        picture, lines = _write_light(options, bracket)
    else:
        picture, lines = _write_picture(options, bracket)
    for line in lines:
        note(line)
    if options.sheet is not None:
        _write_sheet(options.sheet, bracket, picture)
    print(options.out)


def _check(options: FuseOptions) -> None:
    check_writable(options.out, (*PICTURES, *LIGHT), "--out")
    if options.sheet is not None:
        check_writable(options.sheet, PICTURES, "--sheet")
    if options.response is not None:
        check_writable(options.response, (".csv",), "--response")
        if options.out.suffix.lower() not in LIGHT:
            raise InputError(
                "is recovered where light is merged",
                field="--response",
                remedy="write light: --out with .exr or .hdr",
            )


def _write_picture(options: FuseOptions, bracket: Bracket) -> tuple[Any, list[str]]:
    """Exposure fusion of what all photographs show."""
    from andon.capture.brackets import common_rectangle
    from andon.display.fusion import fuse
    from andon.files.pictures import write_picture

    rows, columns = common_rectangle(bracket.seen)
    part = bracket.cropped(rows, columns)
    picture = fuse(part.codes)
    write_picture(options.out, picture)
    (height, width), whole = picture.shape[:2], bracket.codes[0].shape
    if (height, width) == whole[:2]:
        return picture, []
    return picture, [
        f"cropped to {width}×{height} of {whole[1]}×{whole[0]} px, which all photographs show"
    ]


def _write_light(options: FuseOptions, bracket: Bracket) -> tuple[Any, list[str]]:
    """The merged light, and for a sheet the fusion of what it would show at each exposure."""
    from andon.capture.merge import merge
    from andon.display.fusion import fuse
    from andon.files.pictures import write_exr, write_hdr
    from andon.files.responses import write_response
    from andon.responses import srgb_encode

    merged = merge(bracket)
    if options.out.suffix.lower() == ".exr":
        write_exr(options.out, merged.linear, unit="relative", photometry="relative")
    else:
        write_hdr(options.out, merged.linear)
    if options.response is not None:
        write_response(options.response, merged.response)
    assert bracket.seconds is not None  # by check_exposures
    gains = bracket.seconds / bracket.seconds[bracket.middle]
    shown = [srgb_encode(np.clip(merged.linear * gain, 0, 1)) for gain in gains]
    return fuse(shown), _on_light(merged, bracket)


def _on_light(merged: Merged, bracket: Bracket) -> list[str]:
    lines = [
        f"relative light: 1 is white in {Path(bracket.names[bracket.middle]).name} as sRGB has "
        f"it; range {merged.range_ratio:.3g}:1"
    ]
    for share, what in (
        (merged.clipped_share, "are white in every photograph: a shorter exposure is missing"),
        (merged.black_share, "are black in every photograph: a longer exposure is missing"),
        (merged.unseen_share, "are border in every photograph, and black"),
    ):
        if share >= LEAST_NOTED:
            lines.append(f"{share:.2%} of the pixels {what}")
    return lines


def _write_sheet(path: Path, bracket: Bracket, picture: Any) -> None:
    """All photographs from dark to bright, as aligned, and what was made of them as a picture."""
    import cv2

    from andon.display.false_colour import contact_sheet
    from andon.files.pictures import write_picture

    scale = min(1.0, SHEET_WIDTH_PX / bracket.codes[0].shape[1])
    small = [
        np.asarray(cv2.resize(p, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA), np.uint8)
        for p in (*(bracket.codes[i] for i in bracket.order), picture)
    ]
    names = [_caption(bracket, i) for i in bracket.order]
    tiles = list(zip([*names, "fused"], small, strict=True))
    write_picture(path, contact_sheet(tiles, columns=min(SHEET_COLUMNS, len(tiles))))


def _caption(bracket: Bracket, index: int) -> str:
    name = Path(bracket.names[index]).name
    if bracket.seconds is None:
        return name
    seconds = float(bracket.seconds[index])
    return f"{name}, {seconds:.3g} s" if seconds >= 0.3 else f"{name}, 1/{1 / seconds:.4g} s"
