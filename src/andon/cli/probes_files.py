"""``andon probes info`` and ``export``: what a volume holds, and its light for other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

__all__ = ["probes_export", "probes_info"]

VolumeArgument = Annotated[Path, typer.Argument(help="A probe volume (.glb).")]


def probes_info(
    volume: VolumeArgument,
    json: Annotated[bool, typer.Option("--json", help="All of it, as JSON.")] = False,
) -> None:
    """Say what a probe volume holds: probes, states of light, zones, cells, memory.

    Examples:

        andon probes info room.glb

        andon probes info room.glb --json
    """
    from andon.cli.probe_facts import show

    show(volume, json=json)


def probes_export(
    volume: VolumeArgument,
    format: Annotated[
        str,
        typer.Option(
            metavar="three|gltf|unity|filament|csv",
            help="three: LightProbe JSON; gltf: EXT_lights_image_based; unity: JSON in the order "
            "of SphericalHarmonicsL2; filament: as cmgen --sh.",
        ),
    ],
    probe: Annotated[
        str | None, typer.Option(metavar="NAME|NUMBER", help="One probe; default: all.")
    ] = None,
    at: Annotated[
        str | None,
        typer.Option(metavar="X,Y,Z", help="The light between the probes at a point, metres."),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="File; default: text is printed.")
    ] = None,
    state: Annotated[str | None, typer.Option(help="Of the volume; default: its first.")] = None,
    blend_state: Annotated[str | None, typer.Option(help="A second state, mixed in.")] = None,
    blend: Annotated[float, typer.Option(help="0: state … 1: blend-state.")] = 0.0,
    white_cd_m2: Annotated[
        float | None,
        typer.Option(help="Luminance that becomes 1.0, as engines like it; default: cd/m²."),
    ] = None,
    raw: Annotated[
        bool,
        typer.Option(
            "--raw",
            help="Harmonics as captured; default: smoothed as little as keeps illuminance from "
            "going negative, as frames do.",
        ),
    ] = False,
    visibility: Annotated[
        bool,
        typer.Option(
            help="At a point, walls hide probes, where the volume has distances.",
        ),
    ] = True,
) -> None:
    """Give the light of probes to another program.

    It is the light that frames show: smoothed where it rings, and at a point without what walls
    hide. All but csv hold bands 0 to 2. unity negates x, as glTF importers there do.

    Examples:

        andon probes export room.glb --format three --probe door --white-cd-m2 200 -o door.json

        andon probes export room.glb --format filament --at 0,1.5,-2

        andon probes export room.glb --format csv --state night -o night.csv
    """
    from andon.cli.probe_export import ExportOptions, run

    run(
        ExportOptions(
            volume, format, probe, at, out, state, blend_state, blend, white_cd_m2, raw, visibility
        )
    )
