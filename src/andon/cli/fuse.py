"""``andon fuse``: photographs of several exposures as one picture, or as light."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from andon.cli.console import check_apart, check_writable, note
from andon.errors import InputError

if TYPE_CHECKING:
    from andon.capture.align import Move
    from andon.capture.brackets import Bracket
    from andon.capture.merge import Merged
    from andon.files.pictures import Picture

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
    _check(options)
    is_light = options.out.suffix.lower() in LIGHT
    bracket = _read(options)
    from andon.capture.align import align
    from andon.capture.brackets import check_exposures

    if is_light:
        check_exposures(bracket)
    bracket, moves = align(bracket, options.align)  # type: ignore[arg-type]
    for line in _on_moves(bracket, moves):
        note(line)
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
    from andon.capture.align import ALIGNMENTS

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
    if options.align not in ALIGNMENTS:
        raise InputError(
            f"must be one of {', '.join(ALIGNMENTS)}, got {options.align!r}", field="--align"
        )
    if options.seconds is not None and options.exposures is not None:
        raise InputError("give one of --seconds and --list", field="--seconds")
    inputs = [*options.photos, *([options.exposures] if options.exposures else [])]
    check_apart(inputs, (options.out, options.sheet, options.response))


def _read(options: FuseOptions) -> Bracket:
    """The photographs and their exposures: as typed, as listed, or as EXIF states them."""
    from andon.capture.brackets import bracket_of
    from andon.files.pictures import read_picture

    paths, seconds = list(options.photos), None
    if options.exposures is not None:
        paths, seconds = _listed(paths, options.exposures)
    elif options.seconds is not None:
        seconds = _typed_seconds(options.seconds, len(paths))
    if not paths:
        raise InputError("are missing: there is nothing to fuse", field="PHOTOS")
    for path in (options.out, options.sheet):
        if path is not None and path.resolve() in {photo.resolve() for photo in paths}:
            raise InputError("is also an input, and would be overwritten", file=path)
    pictures = [read_picture(path) for path in paths]
    codes = [_codes(picture, path) for picture, path in zip(pictures, paths, strict=True)]
    if seconds is None:
        seconds = _stated_seconds(pictures)
    return bracket_of([str(path) for path in paths], codes, seconds)


def _codes(picture: Picture, path: Path) -> Any:
    """(H, W, 3) uint8; of 16 bits the upper 8."""
    if picture.encoding == "linear":
        raise InputError(
            "is light already, and has no exposure",
            file=path,
            remedy="give PNG or JPEG photographs; relight takes this one as it is",
        )
    values = picture.values
    return values if values.dtype == np.uint8 else np.asarray(values // 257, np.uint8)


def _listed(paths: list[Path], file: Path) -> tuple[list[Path], list[float]]:
    """The photographs that the list names, or their order as typed with the list's exposures."""
    from andon.files.exposures import read_exposures

    entries = read_exposures(file)
    if not paths:
        return [entry.path for entry in entries], [entry.seconds for entry in entries]
    seconds = {entry.path: entry.seconds for entry in entries}
    for path in paths:
        if path.resolve() not in seconds:
            raise InputError(f"does not name {path.name!r}", file=file, field="--list")
    return paths, [seconds[path.resolve()] for path in paths]


def _typed_seconds(text: str, count: int) -> list[float]:
    parts = text.split(",")
    if len(parts) != count:
        raise InputError(
            f"must be {count} exposures, one for each photograph, got {len(parts)}",
            field="--seconds",
        )
    found: list[float] = []
    for part in parts:
        try:
            value = float(Fraction(part.strip()))
        except (ValueError, ZeroDivisionError, OverflowError):
            value = 0.0
        if not 0 < value < float("inf"):
            raise InputError(
                f"exposures must be numbers or fractions > 0, got {part.strip()[:40]!r}",
                field="--seconds",
                remedy="e.g. --seconds 1/320,1/80,0.05",
            )
        found.append(value)
    return found


def _stated_seconds(pictures: list[Picture]) -> list[float] | None:
    """Exposures from EXIF at the first photograph's aperture and sensitivity; None if not stated.

    Proportional to seconds·ISO/N². What not all state is taken to be the same in all.
    """
    facts = [picture.attributes for picture in pictures]
    if not all("exposure_seconds" in fact for fact in facts):
        return None
    exposures = np.array([fact["exposure_seconds"] for fact in facts], np.float64)
    for name, power in (("iso", 1), ("f_number", -2)):
        if all(name in fact for fact in facts):
            values = np.array([fact[name] for fact in facts], np.float64)
            exposures *= (values / values[0]) ** power
    return exposures.tolist()


def _on_moves(bracket: Bracket, moves: Sequence[Move]) -> list[str]:
    moved = [
        (name, move) for name, move in zip(bracket.names, moves, strict=True) if not move.is_still
    ]
    lines = [
        f"{Path(name).name} lies {move.shift_px[0]:+.1f}, {move.shift_px[1]:+.1f} px off "
        f"{Path(bracket.names[bracket.middle]).name}, turned by {move.turn_degrees:+.2f}°: aligned"
        for name, move in moved
    ]
    return lines


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
    from andon.responses import srgb_encode

    merged = merge(bracket)
    if options.out.suffix.lower() == ".exr":
        write_exr(options.out, merged.linear, unit="relative", photometry="relative")
    else:
        write_hdr(options.out, merged.linear)
    if options.response is not None:
        _write_response(options.response, merged)
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


def _write_response(path: Path, merged: Merged) -> None:
    """The recovered response as `capture.response.file` takes it."""
    from andon.files.atomic import write_bytes

    response = merged.response
    assert response.encoded is not None
    assert response.linear is not None
    rows = np.column_stack([response.encoded[:, 0], response.linear])
    lines = [",".join(f"{value:.9g}" for value in row) for row in rows.tolist()]
    text = "\n".join(["encoded,linear_r,linear_g,linear_b", *lines, ""])
    write_bytes(path, text.encode())


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
