"""``andon glare psf``: models of the eye's spread function, side by side."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from andon.cli.console import check_writable

__all__ = ["PsfOptions", "psf", "run"]


@dataclass(frozen=True)
class PsfOptions:
    """What was typed; no models: all of them."""

    out: Path
    models: tuple[str, ...] = ()
    ages: tuple[float, ...] = (25.0,)
    pigment: float = 0.5
    pupil_mm: float = 5.0


def psf(
    out: Annotated[Path, typer.Option("-o", "--out", help="The plot, PNG.")],
    models: Annotated[
        list[str] | None,
        typer.Option("--model", help="Of docs/glare.md, repeatable; default: all of them."),
    ] = None,
    ages: Annotated[
        list[float] | None,
        typer.Option("--age", help="Years, 0…120, repeatable; default: 25."),
    ] = None,
    pigment: Annotated[
        float, typer.Option(help="Of CIE: 0 black, 0.5 brown, 1 light, 1.2 very light eyes.")
    ] = 0.5,
    pupil_mm: Annotated[float, typer.Option(help="Diameter in mm; ijspeert depends on it.")] = 5.0,
) -> None:
    """Plot how the eye spreads the light of a point, over the angle from it.

    Models: cie135 (or cie-total), cie146-general (or cie-general), cie146-small-angle,
    cie146-stiles-holladay, spencer, ijspeert, paper.

    Examples:

        andon glare psf -o models.png

        andon glare psf -o ages.png --model cie135 --age 20 --age 45 --age 70
    """
    run(PsfOptions(out, tuple(models or ()), tuple(ages or (25.0,)), pigment, pupil_mm))


def run(options: PsfOptions) -> None:
    """Draws and writes the plot. Raises `InputError` before anything is drawn."""
    check_writable(options.out, (".png",), "--out")
    from andon.display.spread_plot import spread_plot
    from andon.files.pictures import write_png
    from andon.observer.spread.family import ALIASES, NAMES, spread_function
    from andon.observer.spread.model import Eye

    names = dict.fromkeys(ALIASES.get(name, name) for name in options.models or NAMES)
    spreads = [
        (spread_function(name, Eye(age, options.pigment, options.pupil_mm)), age)
        for name in names
        for age in dict.fromkeys(options.ages)
    ]
    write_png(options.out, spread_plot(spreads))
    print(options.out)
