"""The photographs of an exposure series, as the commands that take one read them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from andon.cli.console import check_apart, note
from andon.errors import InputError

if TYPE_CHECKING:
    from andon.capture.align import Move
    from andon.capture.brackets import Bracket
    from andon.files.pictures import Picture

__all__ = [
    "AlignOption",
    "BracketOptions",
    "ListOption",
    "PhotosArgument",
    "SecondsOption",
    "aligned_bracket",
    "check_bracket",
    "read_bracket",
]

PhotosArgument = Annotated[
    list[Path] | None, typer.Argument(help="PNG or JPEG, two or more of one size.")
]
SecondsOption = Annotated[
    str | None,
    typer.Option(help="Exposures in the photographs' order: 1/320,1/80,1/20. Default: EXIF."),
]
ListOption = Annotated[
    Path | None,
    typer.Option("--list", help="Names and exposures of the photographs, a line each."),
]
AlignOption = Annotated[
    str,
    typer.Option(metavar="auto|none|shift|ecc", help="Of hand-held photographs; ecc turns."),
]


@dataclass(frozen=True)
class BracketOptions:
    """The options of a series, as typed; `seconds` and `exposures` exclude each other."""

    photos: Sequence[Path]
    seconds: str | None = None
    exposures: Path | None = None
    align: str = "auto"


def check_bracket(options: BracketOptions, outputs: Sequence[Path | None]) -> None:
    """Refuses what cannot be read, and outputs that are inputs. Raises `InputError`."""
    from andon.capture.align import ALIGNMENTS

    if options.align not in ALIGNMENTS:
        raise InputError(
            f"must be one of {', '.join(ALIGNMENTS)}, got {options.align!r}", field="--align"
        )
    if options.seconds is not None and options.exposures is not None:
        raise InputError("give one of --seconds and --list", field="--seconds")
    inputs = [*options.photos, *([options.exposures] if options.exposures else [])]
    check_apart(inputs, outputs)


def read_bracket(options: BracketOptions, outputs: Sequence[Path | None]) -> Bracket:
    """The photographs and their exposures: as typed, as listed, or as EXIF states them."""
    from andon.capture.brackets import bracket_of
    from andon.files.pictures import read_picture

    paths, seconds = list(options.photos), None
    if options.exposures is not None:
        paths, seconds = _listed(paths, options.exposures)
    elif options.seconds is not None:
        seconds = _typed_seconds(options.seconds, len(paths))
    if not paths:
        raise InputError("are missing", field="PHOTOS")
    for path in outputs:
        if path is not None and path.resolve() in {photo.resolve() for photo in paths}:
            raise InputError("is also an input, and would be overwritten", file=path)
    pictures = [read_picture(path) for path in paths]
    codes = [_codes(picture, path) for picture, path in zip(pictures, paths, strict=True)]
    if seconds is None:
        seconds = _stated_seconds(pictures)
    return bracket_of([str(path) for path in paths], codes, seconds)


def _codes(picture: Picture, path: Path) -> Any:
    """(H, W, 3) uint8; of 16 bits the upper 8."""
    import numpy as np

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
    import numpy as np

    facts = [picture.attributes for picture in pictures]
    if not all("exposure_seconds" in fact for fact in facts):
        return None
    exposures = np.array([fact["exposure_seconds"] for fact in facts], np.float64)
    for name, power in (("iso", 1), ("f_number", -2)):
        if all(name in fact for fact in facts):
            values = np.array([fact[name] for fact in facts], np.float64)
            exposures *= (values / values[0]) ** power
    return exposures.tolist()


def aligned_bracket(bracket: Bracket, method: str) -> tuple[Bracket, tuple[Move, ...]]:
    """The bracket in one frame and how each photograph moved; says so of those that did."""
    from andon.capture.align import align

    bracket, moves = align(bracket, method)  # type: ignore[arg-type]
    for line in _on_moves(bracket, moves):
        note(line)
    return bracket, moves


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
