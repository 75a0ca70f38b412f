"""``andon glare figures``: its options; what they do is in `figures`."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from andon.cli.options import EngineOption, takes

__all__ = ["FiguresOptions", "figures"]


@dataclass(frozen=True)
class FiguresOptions:
    """The options of the command, as typed; each field is one of them."""

    out: Annotated[Path, typer.Option("-o", "--out", help="Folder for the pictures.")]
    figures: Annotated[str, typer.Option(metavar="N[,…]", help="Of the paper: 4…8.")] = "4,5,6,7,8"
    width: Annotated[int, typer.Option(help="Of a picture, pixels.")] = 480
    age: Annotated[float, typer.Option(help="Years, 0…120.")] = 25.0
    glasses: Annotated[str, typer.Option(metavar="none|myopic|contact", help="What is worn.")] = (
        "myopic"
    )
    seed: Annotated[int, typer.Option(help="Of needles and leaves.")] = 0
    photo: Annotated[
        Path | None, typer.Option(help="A photograph of lamps by night, beside figure 7.")
    ] = None
    leaves: Annotated[
        Path | None, typer.Option(help="A picture of leaves, or a mask, for figure 8.")
    ] = None
    hfov_degrees: Annotated[
        float | None, typer.Option(help="How wide --photo and --leaves see, across.")
    ] = None
    luminance_scale: Annotated[
        float | None, typer.Option(metavar="CD_M2", help="Of value 1 of --photo; default: header.")
    ] = None
    engine: EngineOption = "auto"


@takes(FiguresOptions)
def figures(**typed: Any) -> None:
    """Draw figures 4 to 8 of the glare paper from inputs of our own.

    4 bloom of a point and of an ellipse; 5 needles; 6 the model of needles; 7 street lamps without
    glare, with bloom, with bloom and halo; 8 the sun through leaves. Each picture is a file, and
    glare-figures.png has them all.

    Examples:

        andon glare figures -o figures

        andon glare figures -o old --figures 4,7 --age 70 --glasses none
    """
    from andon.cli.figures.run import run

    run(FiguresOptions(**typed))
