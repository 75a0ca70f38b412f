"""``andon glare komorebi``: its options; what they do is in `komorebi_run`."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from andon.cli.options import EngineOption, takes

__all__ = ["KomorebiOptions", "komorebi"]


@dataclass(frozen=True)
class KomorebiOptions:
    """The options of the command, as typed; each field is one of them."""

    leaves: Annotated[
        Path,
        typer.Argument(
            help="Picture of leaves against the sky; without colours: a mask of gaps; CSV, JSON: a "
            "list of them."
        ),
    ]
    out: Annotated[Path, typer.Option("-o", "--out", help="WebP, PNG, GIF that move; or a folder.")]
    seconds: Annotated[float, typer.Option(help="Length.")] = 5.0
    frames_per_second: Annotated[float, typer.Option("--fps", help="Frames per second.")] = 30.0
    gaps: Annotated[
        int | None, typer.Option(help="At most so many; default: 40 of a picture, 500 of a mask.")
    ] = None
    seed: Annotated[int, typer.Option(help="Of flickers and needles.")] = 0
    z: Annotated[float, typer.Option("--z", help="Of the flicker, 1…2; 1/f-like above 1.5.")] = 1.8
    steps_per_second: Annotated[
        float, typer.Option(help="Iterations of the flicker: how fast leaves move.")
    ] = 6.0
    sun_lux: Annotated[float, typer.Option(help="Of the whole sun, on a plane that faces it.")] = (
        100_000.0
    )
    through: Annotated[
        float, typer.Option(help="Share of it that comes through all gaps, in the mean.")
    ] = 0.01
    sun_at: Annotated[
        str | None,
        typer.Option(metavar="X,Y", help="Pixel of the sun; default: where gaps are densest."),
    ] = None
    hfov_degrees: Annotated[
        float | None, typer.Option(help="How wide the picture sees, across; default: 60.")
    ] = None
    projection: Annotated[
        str | None, typer.Option(metavar="pinhole|fisheye|latlong", help="Of the picture.")
    ] = None
    luminance_scale: Annotated[
        float | None,
        typer.Option(metavar="CD_M2", help="Of value 1; default: header, else a sky's 6000."),
    ] = None
    age: Annotated[float, typer.Option(help="Years, 0…120.")] = 25.0
    pigment: Annotated[
        str, typer.Option(metavar="brown|blue|NUMBER", help="Of the eyes; CIE's numbers: 0…1.2.")
    ] = "brown"
    pupil: Annotated[
        str, typer.Option(metavar="auto|MM", help="Diameter; auto: of the leaves' light.")
    ] = "auto"
    glasses: Annotated[str, typer.Option(metavar="none|myopic|contact", help="What is worn.")] = (
        "none"
    )
    model: Annotated[
        str, typer.Option(metavar="NAME", help="cie-total, cie-general, spencer, ijspeert, paper …")
    ] = "cie-total"
    exposure: Annotated[
        str, typer.Option(metavar="auto|NUMBER", help="Screen value (0…1, linear) per cd/m².")
    ] = "auto"
    engine: EngineOption = "auto"


@takes(KomorebiOptions)
def komorebi(**typed: Any) -> None:
    """Let the sun flicker through leaves, as an eye sees it that looks up.

    Each gap between leaves opens and closes by itself, as 1/f noise; what shines through has bloom,
    and needles where it is bright enough.

    Examples:

        andon glare komorebi examples/komorebi/leaves.png -o komorebi.webp --hfov-degrees 50

        andon glare komorebi gaps.png -o old.webp --seconds 2 --gaps 30 --age 70
    """
    from andon.cli.komorebi_run import run

    run(KomorebiOptions(**typed))
