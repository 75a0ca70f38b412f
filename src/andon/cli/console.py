"""What the commands print."""

from __future__ import annotations

import sys
from collections.abc import Callable, Generator, Iterable, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from andon.errors import AndonError, InputError

if TYPE_CHECKING:
    from andon.pipeline import Report

__all__ = [
    "Interrupted",
    "check_apart",
    "check_folder",
    "check_writable",
    "note",
    "print_report",
    "printable",
    "steps",
]


class Interrupted(AndonError):
    """Somebody stopped a command that has something to say of what is left."""

    exit_code = 130


def note(message: str) -> None:
    """A line on stderr that is worth reading but no failure."""
    print(f"andon: {message}", file=sys.stderr)


@contextmanager
def steps(what: str, total: int, /) -> Generator[Callable[[], None]]:
    """A bar on stderr of work in `total` steps; what is given says that one is done."""
    from rich.console import Console
    from rich.progress import Progress

    console = Console(stderr=True)
    # Where nobody looks at it, all that is left of a bar is an empty line.
    with Progress(console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task(what, total=total)
        yield lambda: bar.advance(task)


def printable(text: str) -> str:
    """A stranger's label as one line without control characters."""
    return "".join(c if c.isprintable() else " " for c in text)[:200].strip()


def check_folder(out: Path) -> None:
    """Refuses a folder for results, which may not exist yet, where it cannot be made."""
    if out.exists() and not out.is_dir():
        raise InputError("must be a folder", file=out, field="--out")
    if not out.absolute().parent.is_dir():
        raise InputError(
            f"the folder {str(out.parent)!r} does not exist",
            file=out,
            field="--out",
            remedy="make it",
        )


def check_writable(path: Path, suffixes: tuple[str, ...], field: str) -> None:
    """Refuses an output before any work is done for it. Raises `InputError`."""
    if path.suffix.lower() not in suffixes:
        raise InputError(
            f"must end in {', '.join(suffixes)}, got {path.name!r}", file=path, field=field
        )
    if path.is_dir():
        raise InputError("must be a file, not a folder", file=path, field=field)
    folder = path.parent
    if not folder.is_dir():
        raise InputError(
            f"the folder {str(folder)!r} does not exist", file=path, field=field, remedy="make it"
        )


def check_apart(inputs: Iterable[Path], outputs: Iterable[Path | None]) -> None:
    """Refuses an output that is an input or another output. Raises `InputError`."""
    taken = {path.resolve() for path in inputs}
    for path in outputs:
        if path is None:
            continue
        if path.resolve() in taken:
            raise InputError(
                "is also an input or another output, and would be overwritten",
                file=path,
                remedy="give it another name",
            )
        taken.add(path.resolve())


def print_report(
    report: Report,
    setup_seconds: Mapping[str, float],
    pixels: int,
    depth: str | None = None,
    white: str | None = None,
) -> None:
    """Engine, stage times, depths, holes and shadow geometry of a frame.

    `white` says what is white on the screen where no photograph does: then there is none.
    """
    from rich.console import Console
    from rich.table import Table

    table = Table(box=None, show_header=False, pad_edge=False)
    table.add_row("engine", f"{report.engine} · {report.adapter}")
    seconds: dict[str, Any] = {**setup_seconds, **report.stage_seconds}
    table.add_row("stages", " · ".join(f"{k} {v * 1e3:.0f} ms" for k, v in seconds.items()))
    table.add_row("photometry", report.photometry)
    if white is not None:
        table.add_row("white", white)
    if depth is not None:  # the unit of a depth is mistaken more often than all else
        table.add_row("depth", depth)
    for row in _rows_of_picture(report, pixels, has_photograph=white is None):
        table.add_row(*row)
    if report.uncovered_share is not None:
        share = f"{1 - report.uncovered_share:.1%}"
        table.add_row("baked light", f"maps see {share} of the surface")
    if report.beyond_curve_share is not None:
        share = f"{1 - report.beyond_curve_share:.1%}"
        table.add_row("curves", f"{share} of their pixels lie within what was measured")
    if report.ignored_tables:
        table.add_row("not drawn", f"{', '.join(report.ignored_tables)} (later versions)")
    Console(stderr=True).print(table)


def _rows_of_picture(report: Report, pixels: int, *, has_photograph: bool) -> list[tuple[str, str]]:
    holes, triangles = f"{report.hole_pixels / pixels:.1%} of the pixels", report.occluder_triangles
    if not has_photograph:
        rows = [("background", f"{holes} show no surface")]
        return [*rows, ("shadows", f"{triangles} triangles, all there are")] if triangles else rows
    rows = [
        ("holes", f"{holes} get no added light"),
        ("clipped", f"{report.clipped_pixels / pixels:.1%} of the photograph is clipped"),
    ]
    if not triangles:
        return rows
    shadows = (
        f"{triangles} of {report.occluder_triangles_before} triangles, "
        f"95 % within {report.occluder_error_m * 1e3:.1f} mm, "
        f"{report.occluder_lost_share:.1%} lost; "
        f"lift {report.shadow_bias_m * 1e3:.1f} mm"
    )
    return [*rows, ("shadows", shadows)]
