"""``andon calibrate response``: a camera's response from an exposure series."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from andon.cli.bracket import (
    AlignOption,
    BracketOptions,
    ListOption,
    PhotosArgument,
    SecondsOption,
    aligned_bracket,
    check_bracket,
    read_bracket,
)
from andon.cli.console import check_writable, note

if TYPE_CHECKING:
    from andon.calibrate.camera import CameraCalibration
    from andon.capture.align import Move
    from andon.capture.brackets import Bracket

__all__ = ["response", "run"]

# Beyond what shutters and apertures keep their stops to.
NOTED_EV = 1 / 3
# Shorter runs of codes without data lie safely between their neighbours.
LEAST_RUN_CODES = 4


def response(
    out: Annotated[
        Path, typer.Option("-o", "--out", help="The response (CSV), for capture.response.file.")
    ],
    photos: PhotosArgument = None,
    seconds: SecondsOption = None,
    exposures: ListOption = None,
    align: AlignOption = "auto",
    figure: Annotated[
        Path | None, typer.Option(help="PNG: the curves on their data, residuals, exposures.")
    ] = None,
    facts: Annotated[
        Path | None, typer.Option("--json", help="Residuals and exposures as numbers.")
    ] = None,
) -> None:
    """Find a camera's response from one still scene in several exposures.

    A tripod, one white balance, no flash, aperture and sensitivity fixed; steps of one or two
    stops, so that most things are well exposed twice at least. The response is relative: 1 is
    white. A series that contradicts itself is refused.

    Examples:

        andon calibrate response a.jpg b.jpg c.jpg d.jpg -o camera.csv --figure camera.png

        andon calibrate response a.png b.png c.png --seconds 1/320,1/80,1/20 -o camera.csv

        andon calibrate response --list image_list.txt -o film.csv --json film.json
    """
    run(BracketOptions(tuple(photos or ()), seconds, exposures, align), out, figure, facts)


def run(typed: BracketOptions, out: Path, figure: Path | None, facts: Path | None) -> None:
    """Reads, aligns, fits, writes. Raises `InputError` before anything is written."""
    check_writable(out, (".csv",), "--out")
    outputs = out, figure, facts
    for path, suffix, field in ((figure, ".png", "--figure"), (facts, ".json", "--json")):
        if path is not None:
            check_writable(path, (suffix,), field)
    check_bracket(typed, outputs)
    bracket = read_bracket(typed, outputs)
    from andon.calibrate.camera import calibrate_camera, check_calibration, check_still
    from andon.capture.brackets import check_exposures
    from andon.files.responses import write_response

    check_exposures(bracket)
    bracket, moves = aligned_bracket(bracket, typed.align)
    check_still(bracket)
    calibration = calibrate_camera(bracket)
    check_calibration(bracket, calibration)
    write_response(out, calibration.response)
    _write_more(bracket, calibration, moves, figure, facts)
    _print(bracket, calibration)
    for path in outputs:
        if path is not None:
            print(path)


def _write_more(
    bracket: Bracket,
    calibration: CameraCalibration,
    moves: tuple[Move, ...],
    figure: Path | None,
    facts: Path | None,
) -> None:
    from andon.files.atomic import write_json
    from andon.files.pictures import write_png

    if figure is not None:
        from andon.calibrate.camera_figure import camera_figure

        write_png(figure, camera_figure(bracket, calibration))
    if facts is not None:
        write_json(facts, facts_of(bracket, calibration, moves))


def facts_of(
    bracket: Bracket, calibration: CameraCalibration, moves: tuple[Move, ...]
) -> dict[str, Any]:
    """What the fit says, as JSON; null where nothing is known."""
    from andon.calibrate.camera import CHANNELS
    from andon.capture.recovery import seconds_of

    residuals, seconds = calibration.residuals, seconds_of(bracket)
    photographs = [
        {
            "file": Path(name).name,
            "stated_seconds": float(seconds[k]),
            "exposure_error_ev": _number(calibration.exposure_error_ev[k]),
            "rms_codes": _number(residuals.photograph_codes[k]),
            "rms_ev": _number(residuals.photograph_ev[k]),
            "shift_px": list(moves[k].shift_px),
            "turn_degrees": moves[k].turn_degrees,
        }
        for k, name in enumerate(bracket.names)
    ]
    channels = {
        name: {
            "is_monotone": channel.fall is None,
            "fall_ev": 0.0 if channel.fall is None else channel.fall.ev,
            "fall_codes": None if channel.fall is None else list(channel.fall.codes),
            "fall_noise_ev": None if channel.fall is None else channel.fall.noise_ev,
            "codes_without_data": [list(run) for run in calibration.unsupported(c)],
        }
        for c, (name, channel) in enumerate(
            zip(CHANNELS, calibration.recovery.channels, strict=True)
        )
    }
    return {
        "photometry": "relative",
        "rms_codes": residuals.rms_codes,
        "median_codes": residuals.median_codes,
        "rms_ev": residuals.rms_ev,
        "used_share": calibration.used_share,
        "kept_share": calibration.kept_share,
        "channels": channels,
        "photographs": photographs,
    }


def _number(value: Any) -> float | None:
    return float(value) if value == value else None


def _print(bracket: Bracket, calibration: CameraCalibration) -> None:
    """A table of the photographs on stderr, and notes on what is doubtful."""
    from rich.console import Console
    from rich.table import Table

    residuals, errors = calibration.residuals, calibration.exposure_error_ev
    table = Table(box=None, pad_edge=False)
    for column in ("photograph", "stated, s", "pictures say, EV", "RMS, codes", "RMS, EV"):
        table.add_column(column, justify="left" if column == "photograph" else "right")
    for k in bracket.order:
        assert bracket.seconds is not None
        columns = (bracket.seconds[k], errors[k], residuals.photograph_codes[k])
        shown = [f"{columns[0]:.4g}", _signed(columns[1]), f"{columns[2]:.1f}"]
        table.add_row(Path(bracket.names[k]).name, *shown, f"{residuals.photograph_ev[k]:.2f}")
    Console(stderr=True, highlight=False, markup=False).print(table)
    note(
        f"relative response, 1 is white; left over: {residuals.rms_codes:.1f} codes RMS "
        f"({residuals.median_codes:.1f} in the median), {residuals.rms_ev:.2f} EV"
    )
    note(
        f"{calibration.used_share:.1%} of all pixels are not clipped; "
        f"{calibration.kept_share:.1%} of those sampled fit, the others moved or are dirt"
    )
    for line in (*_on_exposures(bracket, errors), *_on_curves(calibration)):
        note(line)


def _signed(value: float) -> str:
    return f"{value:+.2f}" if value == value else "-"


def _on_exposures(bracket: Bracket, errors: Any) -> list[str]:
    if len(bracket.names) < 3:
        return ["two photographs cannot tell whether their times are true: take a third"]
    doubt = "; of three photographs it may be another one's time" if len(errors) == 3 else ""
    return [
        f"{Path(name).name} is exposed {error:+.2f} EV against what is stated, by what it shows"
        f"{doubt}"
        for name, error in zip(bracket.names, errors, strict=True)
        if abs(error) > NOTED_EV
    ]


def _on_curves(calibration: CameraCalibration) -> list[str]:
    from andon.calibrate.camera import CHANNELS

    lines: list[str] = []
    for c, (name, channel) in enumerate(zip(CHANNELS, calibration.recovery.channels, strict=True)):
        if channel.fall is not None:
            first, last = channel.fall.codes
            lines.append(
                f"{name}: the fit falls by {channel.fall.ev:.3f} EV from code {first} to {last}, "
                f"within its noise ({channel.fall.noise_ev:.3f} EV); made to rise"
            )
        runs = [r for r in calibration.unsupported(c) if r[1] - r[0] + 1 >= LEAST_RUN_CODES]
        if runs:
            spans = ", ".join(f"{first}-{last}" for first, last in runs)
            lines.append(f"{name}: no data for codes {spans}; a smooth curve is assumed there")
    return lines
