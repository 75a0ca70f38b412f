"""``andon glare IN -o OUT``: the options of a picture's glare; what they do is in `glare_run`."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from andon.cli.options import EngineOption, takes

__all__ = ["GlareOptions", "picture"]


@dataclass(frozen=True)
class GlareOptions:
    """The options of the command, as typed; each field is one of them."""

    picture: Annotated[
        Path, typer.Argument(help="Radiance HDR or EXR; PNG and JPEG have lost their lights.")
    ]
    out: Annotated[
        Path,
        typer.Option(
            "-o", "--out", help="PNG, JPEG: exposed; EXR: cd/m²; HDR: as Radiance has it."
        ),
    ]
    camera: Annotated[Path | None, typer.Option(help="Camera: TOML of Andon, or OpenCV YAML.")] = (
        None
    )
    projection: Annotated[
        str | None,
        typer.Option(
            metavar="pinhole|fisheye|latlong",
            help="Default: header, EXIF, 2:1 is latlong; else pinhole of 60°, with a warning.",
        ),
    ] = None
    hfov_degrees: Annotated[
        float | None, typer.Option(help="How wide the picture sees, across.")
    ] = None
    age: Annotated[
        str, typer.Option(metavar="YEARS[,…]", help="0…120; several make a sheet side by side.")
    ] = "25"
    pigment: Annotated[
        str, typer.Option(metavar="brown|blue|NUMBER", help="Of the eyes; as CIE has it: 0…1.2.")
    ] = "brown"
    pupil: Annotated[
        str, typer.Option(metavar="auto|MM", help="Diameter; auto: of the picture's light.")
    ] = "auto"
    glasses: Annotated[str, typer.Option(metavar="none|myopic|contact", help="What is worn.")] = (
        "none"
    )
    mist: Annotated[float, typer.Option(help="In the air, relative, ≥ 0.")] = 0.0
    model: Annotated[
        str, typer.Option(metavar="NAME", help="cie-total, cie-general, spencer, ijspeert, paper …")
    ] = "cie-total"
    luminance_scale: Annotated[
        float | None,
        typer.Option(metavar="CD_M2", help="Luminance of the picture's value 1; default: header."),
    ] = None
    renderer: Annotated[
        str,
        typer.Option(
            metavar="auto|per-source|whole-picture",
            help="All light scatters, or that of the sources found; auto: all.",
        ),
    ] = "auto"
    glare_only: Annotated[
        bool,
        typer.Option("--glare-only", help="What is added; EXR: with alpha 0, PNG: on black."),
    ] = False
    compare: Annotated[
        bool, typer.Option("--compare", help="The original beside it, at the same exposure.")
    ] = False
    veil_map: Annotated[
        Path | None,
        typer.Option(help="Veil towards every direction. EXR: cd/m²; PNG: false colours."),
    ] = None
    gaze: Annotated[
        str | None,
        typer.Option(metavar="X,Y", help="Pixel that is looked at; default: straight ahead."),
    ] = None
    report: Annotated[Path | None, typer.Option(help="All numbers, as JSON.")] = None
    evalglare: Annotated[
        bool, typer.Option("--evalglare", help="Radiance's numbers beside ours, in the report.")
    ] = False
    exposure: Annotated[
        str,
        typer.Option(
            metavar="auto|NUMBER", help="Screen value (0…1, linear) per cd/m², for PNG and JPEG."
        ),
    ] = "auto"
    engine: EngineOption = "auto"


@takes(GlareOptions)
def picture(**typed: Any) -> None:
    """Show a picture as an eye sees it: bright things veil what is around them.

    Numbers of the glare (veil where the eye looks, TI, UGR, DGP) go to the report.

    Examples:

        andon glare night.hdr -o seen.png --age 70

        andon glare night.hdr -o ages.png --age 20,45,70 --compare --report ages.json

        andon glare road.exr -o veil.exr --glare-only --projection pinhole --hfov-degrees 40
    """
    from andon.cli.glare_run import run

    run(GlareOptions(**typed))
