"""``andon gaze``: what a recording of gaze holds, and what each filter makes of it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from andon.cli.console import check_folder, note
from andon.errors import InputError, nearest_name

if TYPE_CHECKING:
    from andon.cli.gaze_report import Study

__all__ = ["GazeOptions", "run"]


@dataclass(frozen=True)
class GazeOptions:
    """The options of the command, as typed."""

    recording: Path
    out: Path
    filter: str | None = None
    scene: Path | None = None
    rate_hz: float | None = None


def run(options: GazeOptions) -> None:
    """Writes pictures, fixations and a report into a folder, and prints a table."""
    from andon.cli.gaze_report import study_of, write_fixations, write_pictures

    check_folder(options.out)
    study = study_of(_settings(options), options.recording, options.rate_hz)
    try:
        options.out.mkdir(exist_ok=True)
    except OSError as error:
        raise InputError(f"cannot be made: {error.strerror}", file=options.out) from error
    written = write_pictures(study, options.out)
    written.append(write_fixations(study, options.out / "fixations.csv"))
    written.append(_write_report(study.report, options.out / "report.json"))
    _print(study)
    for path in written:
        print(path)


def _settings(options: GazeOptions) -> Any:
    """[gaze] of the scene, with the filter that was typed."""
    from andon.observer.gaze import FILTERS
    from andon.scene import load_scene
    from andon.scene.eye import Gaze

    gaze = Gaze()
    if options.scene is not None:
        scene = load_scene(options.scene)
        if scene.gaze is None:
            note(f"{options.scene} has no [gaze]; its defaults are used")
        gaze = scene.gaze or gaze
    if options.rate_hz is not None and not 0 < options.rate_hz <= 1e5:
        raise InputError(f"must be > 0 Hz and ≤ 1e5, got {options.rate_hz:g}", field="--rate")
    if options.filter is None:
        return gaze
    scene_names = [name for name in FILTERS if name != "mean"]
    if options.filter not in scene_names:
        near = nearest_name(options.filter, scene_names)
        raise InputError(
            f"must be one of {', '.join(scene_names)}, got {options.filter!r}",
            field="--filter",
            remedy=f"did you mean {near!r}?" if near else None,
        )
    return gaze.model_copy(update={"filter": options.filter})


def _write_report(report: dict[str, Any], path: Path) -> Path:
    from andon.files.atomic import write_json

    return write_json(path, report)


def _print(study: Study) -> None:
    from rich.console import Console
    from rich.table import Table

    report = study.report
    console = Console(highlight=False, markup=False)
    facts = Table(box=None, show_header=False, pad_edge=False)
    samples = report["samples"]
    facts.add_row(
        "samples",
        f"{samples} in {report['duration_seconds']:.2f} s, {report['median_rate_hz']:.4g} Hz",
    )
    facts.add_row("good", f"{report['good']} ({report['good'] / samples:.1%})")
    for reason, count in report["rejected"].items():
        facts.add_row(f"  {reason}", f"{count} ({count / samples:.1%})")
    for reason, count in report["dropped_rows"].items():
        facts.add_row(f"  row dropped, {reason}", f"{count}")
    facts.add_row("blinks", f"{report['blinks']}")
    middle = report["vergence_dioptres"]
    if middle is not None:
        facts.add_row(
            "vergence",
            f"{middle['median']:.3f} D median, {middle['p5']:.3f}…{middle['p95']:.3f} D of 90 %",
        )
    console.print(facts)
    table = Table(box=None, pad_edge=False)
    for column in ("filter", "lag, s", "jitter, D", "seen", "held", "fallback"):
        table.add_column(column, justify="left" if column == "filter" else "right")
    for name, row in report["filters"].items():
        jitter, lag = row["jitter_dioptres"], row["lag_seconds"]
        table.add_row(
            name + (" *" if name == report["filter"] else ""),
            "-" if lag is None else f"{lag:.3f}",
            "-" if jitter is None else f"{jitter:.4f}",
            *(f"{row[state]:.1%}" for state in ("seen", "held", "fallback")),
        )
    console.print(table)
