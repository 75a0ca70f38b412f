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

        andon probes info basic.probes.glb

        andon probes info basic.probes.glb --json
    """
    from andon.cli.probe_facts import show

    show(volume, json=json)


def probes_export(
    volume: VolumeArgument,
    format: Annotated[
        str,
        typer.Option(
            metavar="three|gltf|unity|filament|csv",
            help="three: LightProbe JSON (.json); gltf: EXT_lights_image_based (.glb); unity: "
            "JSON in the order of SphericalHarmonicsL2 (.json); filament: as cmgen --sh, of one "
            "probe (.txt); csv: a table (.csv).",
        ),
    ],
    probe: Annotated[
        str | None, typer.Option(metavar="NAME|NUMBER", help="One probe; default: all.")
    ] = None,
    at: Annotated[
        str | None,
        typer.Option(
            metavar="X,Y,Z",
            help="The light between the probes at a point, metres; "
            "outside, that of the nearest point between them.",
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "-o", "--out", help="File, its suffix as the format's; default: text is printed."
        ),
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

        andon probes export basic.probes.glb --format three --probe green
            --white-cd-m2 6000 -o green.json

        andon probes export basic.probes.glb --format filament --at 0,1.5,-2

        andon probes export basic.probes.glb --format csv -o light.csv
    """
    from andon.cli.probe_export import ExportOptions, run

    run(
        ExportOptions(
            volume, format, probe, at, out, state, blend_state, blend, white_cd_m2, raw, visibility
        )
    )
