"""``andon bake SCENE``: global illumination of the lamps in [baked], as illuminance maps."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from andon.cli.bar import Bar
from andon.cli.console import Interrupted, note
from andon.cli.durations import duration
from andon.cli.workers import (
    CertificateOption,
    KeyOption,
    SchedulerOption,
    TrustedOption,
    WorkersOption,
    workers_of,
)
from andon.errors import InputError

if TYPE_CHECKING:
    from andon.bake.maps import BakedMapsReport, MapsPlan
    from andon.scene import Scene

__all__ = ["maps", "maps_folder", "qualities", "size"]

QUALITIES = ("draft", "normal", "fine")


def maps(
    scene: Annotated[Path, typer.Argument(help="Scene file (TOML) with a [baked] table.")],
    workers: WorkersOption = None,
    scheduler: SchedulerOption = None,
    tls_ca: TrustedOption = None,
    tls_cert: CertificateOption = None,
    tls_key: KeyOption = None,
    quality: Annotated[
        str | None,
        typer.Option(metavar="draft|normal|fine", help="Instead of the scene's baked.quality."),
    ] = None,
    fresh: Annotated[
        bool, typer.Option("--fresh", help="Keep nothing of earlier bakes of this folder.")
    ] = False,
    trust: Annotated[
        bool,
        typer.Option("--trust", help="Lines of baked.include that start programs (!) are run."),
    ] = False,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Say what would be done and how long it takes.")
    ] = False,
) -> None:
    """Bake the light of the lamps in [baked], reflections included, into illuminance maps.

    A bake that was stopped goes on where it was, and one of a changed scene computes what changed.
    Frames of the scene find the maps by themselves. A scheduler runs the code that its peers send:
    use one on a network that you trust, or TLS.

    QUALITIES

    Examples:

        andon bake room.toml --dry-run

        andon bake room.toml --quality draft

        andon bake room.toml --scheduler tcp://10.0.0.7:8786
    """
    from andon.bake.maps import bake_maps, plan_maps
    from andon.scene import load_scene

    loaded = _with_quality(load_scene(scene), quality)
    chosen = workers_of(workers, scheduler, (tls_ca, tls_cert, tls_key))
    if dry_run:
        plan = plan_maps(loaded, trust=trust)
        _print_plan(plan, getattr(chosen, "count", 1))
        for difference in plan.unsaid:
            note(difference)
        return
    try:
        with Bar("looking for cameras") as bar:
            report = bake_maps(loaded, workers=chosen, progress=bar.show, fresh=fresh, trust=trust)
    except KeyboardInterrupt:
        raise Interrupted("interrupted; run it again and it goes on") from None
    if report.damaged:
        note(f"{report.damaged} kept maps were not whole and are computed again")
    _print_report(report)
    for difference in report.plan.unsaid:
        note(difference)
    print(report.folder)
    note(f"look at them: andon bake show {report.folder}")


def maps_folder(source: Path, /) -> Path:
    """The folder itself, or the one that a scene's [baked] names."""
    if source.suffix.lower() != ".toml" or source.is_dir():
        return source
    from andon.scene import load_scene

    scene = load_scene(source)
    if scene.baked is None:
        raise InputError(
            "needs a [baked] table", file=source, remedy='add [baked] with folder = "maps"'
        )
    return scene.path(scene.baked.folder, "baked.folder")


def qualities() -> str:
    """What each quality errs and costs, as Markdown for the help."""
    from andon.transport.baked.radiance.quality import QUALITIES

    lines = [
        f"* {quality.name}: errors {quality.median_error:.1%} median, {quality.p95_error:.1%} 95th "
        f"percentile; {quality.seconds_per_100k_points:g} s"
        for quality in QUALITIES.values()
    ]
    first = "Qualities, in a furnished room, with seconds of one core for 100,000 points:"
    return "\n\n".join([first, *lines])


def _with_quality(scene: Scene, quality: str | None) -> Scene:
    """The scene whose baked.quality is that one; None: its own."""
    if quality is None:
        return scene
    if quality not in QUALITIES:
        raise InputError(
            f"must be {', '.join(QUALITIES[:-1])} or {QUALITIES[-1]}, got {quality[:40]!r}",
            field="--quality",
        )
    if scene.baked is None:
        return scene
    return scene.model_copy(update={"baked": scene.baked.model_copy(update={"quality": quality})})


def _rows(plan: MapsPlan) -> list[tuple[str, str]]:
    """What plan and report both say."""
    whence = "stated"
    if plan.coverage is not None:
        whence = f"found, which see {plan.coverage:.1%} of the surface"
    quality = plan.quality
    return [
        ("cameras", f"{len(plan.views)} {whence}; {_cameras(plan)}"),
        ("lamps", ", ".join(f"{name} ({_light(part)})" for name, part in plan.parts.items())),
        ("moments", _moments(plan.moments)),
        (
            "quality",
            f"{quality.name}, {_bounces(plan.bounces)}; errors {quality.median_error:.1%} median, "
            f"{quality.p95_error:.1%} 95th percentile",
        ),
    ]


def _bounces(count: int) -> str:
    return "1 bounce" if count == 1 else f"{count} bounces"


def _light(part: str) -> str:
    return {"all": "all light", "bounce": "reflected light"}[part]


def _cameras(plan: MapsPlan) -> str:
    """Their sizes, each once, and how much surface they show."""
    sizes = dict.fromkeys(f"{view.width}×{view.height}" for view in plan.views)
    least, most = min(plan.seen), max(plan.seen)
    shares = f"{least:.0%}" if f"{least:.0%}" == f"{most:.0%}" else f"{least:.0%}…{most:.0%}"
    return f"{', '.join(sizes)} px, {shares} of the pixels show a surface"


def _moments(moments: tuple[float, ...]) -> str:
    if len(moments) == 1:
        return "1: nothing moves"
    return f"{len(moments)}, {moments[0]:g}…{moments[-1]:g} s"


def _print(rows: list[tuple[str, str]]) -> None:
    from rich.console import Console
    from rich.table import Table

    table = Table(box=None, show_header=False, pad_edge=False)
    for row in rows:
        table.add_row(*row)
    Console(stderr=True, highlight=False, markup=False).print(table)


def _print_plan(plan: MapsPlan, count: int) -> None:
    seconds = plan.estimated_seconds / count
    _print(
        [
            *_rows(plan),
            ("maps", f"{plan.light_tasks} of light, {plan.points} points"),
            (
                "time",
                f"about {duration(seconds)} with {count} worker{'s' if count > 1 else ''}, "
                "if nothing is kept; rooms differ by a factor of some three",
            ),
        ]
    )
    print(plan.folder)


def _print_report(report: BakedMapsReport) -> None:
    kept = f", {report.kept} kept from before" if report.kept else ""
    removed = f"; {report.removed} old files removed" if report.removed else ""
    work = f", {duration(report.work_seconds)} of work" if report.computed else ""
    workers = f" by {report.workers} workers" if report.workers > 1 else ""
    _print(
        [
            *_rows(report.plan),
            ("tasks", f"{report.computed} done{workers}{kept}"),
            ("time", f"{duration(report.elapsed_seconds)}{work}"),
            ("on disk", f"{size(report.disk_bytes)}{removed}"),
        ]
    )


def size(count: int, /) -> str:
    """Bytes as KiB or MiB."""
    return f"{count / 2**10:.0f} KiB" if count < 2**20 else f"{count / 2**20:.1f} MiB"
