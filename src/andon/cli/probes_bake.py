"""``andon probes bake``: captures the light at the probes of a scene."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from andon.cli.bar import Bar
from andon.cli.console import Interrupted, note
from andon.cli.options import EngineOption
from andon.cli.workers import (
    CertificateOption,
    KeyOption,
    SchedulerOption,
    TrustedOption,
    workers_of,
)
from andon.errors import InputError

if TYPE_CHECKING:
    from andon.bake import BakeReport, Written
    from andon.scene import Scene

__all__ = ["bake"]

BOUNCES_BY = ("probes", "radiance")
# Names that a line lists before it goes on with "…".
SHOWN_NAMES = 5
# As in scene files.
LONGEST_NAME = 200


def bake(
    scene: Annotated[Path, typer.Argument(help="Scene file (TOML) with a [probes] table.")],
    engine: EngineOption = "auto",
    state: Annotated[
        str | None,
        typer.Option(help="Name of the state that is baked; default: the scene's probes.state."),
    ] = None,
    bounces_by: Annotated[
        str | None,
        typer.Option(
            help="What computes bounces: probes or radiance; default: the scene's "
            "probes.bounces_by."
        ),
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option(min=1, help="Processes that trace bounces by Radiance; default: this one."),
    ] = None,
    scheduler: SchedulerOption = None,
    tls_ca: TrustedOption = None,
    tls_cert: CertificateOption = None,
    tls_key: KeyOption = None,
    fresh: Annotated[
        bool, typer.Option("--fresh", help="Forget what an interrupted bake has left.")
    ] = False,
    replace: Annotated[
        bool,
        typer.Option("--replace", help="Other states of a volume with other probes may go."),
    ] = False,
) -> None:
    """Capture the light at the probes of a scene, and write the volume that it names.

    A bake that was stopped goes on where it was. A second state (night) of the same probes is
    added to the volume: a scene file with the same [probes] and other lamps.

    Examples:

        andon probes bake basic.toml

        andon probes bake basic-at-night.toml --state night

        andon probes bake basic.toml --bounces-by radiance --workers 4
    """
    from andon.bake import bake_file
    from andon.scene import load_scene

    loaded = _bounced_by(_in_state(load_scene(scene), state), bounces_by)
    tls = tls_ca, tls_cert, tls_key
    alone = workers is None and scheduler is None and not any(tls)
    try:
        with Bar("placing") as bar:
            written = bake_file(
                loaded,
                engine=engine,
                fresh=fresh,
                replaces=replace,
                progress=bar.show,
                workers=None if alone else workers_of(workers, scheduler, tls),
            )
    except KeyboardInterrupt:
        raise Interrupted("interrupted; run it again and it goes on") from None
    for warning in (*written.warnings, *_notes(written)):
        note(warning)
    _print(written)
    print(written.path)
    note(f"look at it: andon probes show {written.path}")


def _in_state(scene: Scene, state: str | None) -> Scene:
    """The scene whose probes.state is that one; None: its own."""
    if state is None or scene.probes is None:
        return scene
    if not 1 <= len(state) <= LONGEST_NAME:
        raise InputError(
            f"must be a name of 1 to {LONGEST_NAME} characters, got {state[:40]!r}",
            field="--state",
            remedy="for example --state night",
        )
    probes = scene.probes.model_copy(update={"state": state})
    return scene.model_copy(update={"probes": probes})


def _bounced_by(scene: Scene, how: str | None) -> Scene:
    """The scene whose probes.bounces_by is that; None: its own."""
    if how is None or scene.probes is None:
        return scene
    if how not in BOUNCES_BY:
        raise InputError(
            f"must be probes or radiance, got {how[:40]!r}",
            field="--bounces-by",
            remedy="for example --bounces-by radiance",
        )
    probes = scene.probes.model_copy(update={"bounces_by": how})
    return scene.model_copy(update={"probes": probes})


def _notes(written: Written) -> list[str]:
    report = written.report
    notes: list[str] = []
    if written.replaced:
        notes.append(f"the volume that was there is replaced: it had {'; '.join(written.replaced)}")
    unsaid = tuple(name for name in report.in_walls if name not in written.tally.in_walls)
    if unsaid:
        notes.append(
            f"{len(unsaid)} of {report.probes} probes see mostly backs of surfaces, as inside a "
            f"wall: {_listed(unsaid)}"
        )
    if report.damaged:
        notes.append(f"{report.damaged} kept results were not whole and are captured again")
    if report.not_finite:
        notes.append(f"{report.not_finite} texels had light that is no number; they count as dark")
    if report.clipped:
        notes.append(
            f"light is cut off at the end of the range in {len(report.clipped)} probes, up to "
            f"{report.clipped_share:.2%} of the sphere: {_listed(report.clipped)}; a sun there is "
            "too dark (HDR panoramas keep it, or a [[lamp]] replaces it)"
        )
    if report.negative:
        notes.append(f"{report.negative} values of panoramas are negative and count as 0")
    if report.black:
        notes.append(
            f"in {report.black} channels of probes more light is taken away than there is: they "
            "are black; check the light of ambient.source"
        )
    if report.unphotographed_share > 0:
        notes.append(
            f"{report.unphotographed_share:.1%} of the photographed surface that probes see is in "
            "no photograph, and has the mean of what is"
        )
    if report.surroundings_share > 0:
        notes.append(
            f"{report.surroundings_share:.0%} of what the probes see is not in the photograph: "
            "taken as E0/π"
        )
    return [*notes, *_unstated(report)]


def _unstated(report: BakeReport) -> list[str]:
    """What the scene does not say, and somebody will ask."""
    notes: list[str] = []
    if report.unscaled:
        one = len(report.unscaled) == 1
        notes.append(
            f"cd/m² of panorama{'' if one else 's'} {_listed(report.unscaled)} taken as 1 per "
            "unit: state luminance_per_unit"
        )
    if report.needs_white:
        notes.append(
            "frames of this scene will need capture.luminance_per_unit: no distant lamp and no "
            "[ambient] says how bright white is"
        )
    return notes


def _listed(names: tuple[str, ...]) -> str:
    return ", ".join(names[:SHOWN_NAMES]) + (", …" if len(names) > SHOWN_NAMES else "")


def _print(written: Written) -> None:
    from rich.console import Console
    from rich.table import Table

    report = written.report
    table = Table(box=None, show_header=False, pad_edge=False)
    table.add_row("engine", f"{report.engine} · {report.adapter}")
    table.add_row("probes", f"{report.probes} in {report.cells} cells")
    by = ", by Radiance" if report.bounces_by == "radiance" else ""
    table.add_row("bounces", f"{report.bounces}{by}")
    table.add_row("states", ", ".join(written.states))
    seconds = f", {report.seconds / report.captured:.3g} s each" if report.captured else ""
    kept = f", {report.kept} kept from before" if report.kept else ""
    table.add_row("captures", f"{report.captured}{seconds}{kept}")
    table.add_row("inside walls", str(len(report.in_walls)))
    table.add_row("file", f"{written.path.stat().st_size / 1024:.1f} KiB")
    Console(stderr=True, highlight=False, markup=False).print(table)
