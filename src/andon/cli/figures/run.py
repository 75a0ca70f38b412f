"""What ``andon glare figures`` does: checks, draws figure by figure, writes."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from andon.cli.console import note, steps
from andon.cli.figures.leaves import FRAME_SECONDS, draw_komorebi
from andon.cli.figures.model import Asked, Draw, Figure
from andon.cli.figures.needle_model import draw_model
from andon.cli.figures.photograph import Photograph, draw_photograph
from andon.cli.figures.sheet import row_of, sheet_of
from andon.cli.figures.sources import draw_blooms, draw_needles
from andon.cli.figures.street import AGES_YEARS, draw_street, street_scene
from andon.cli.glare_figures import FiguresOptions
from andon.cli.glare_typed import GLASSES, one_of
from andon.errors import InputError, MachineError
from andon.files.pictures import write_png
from andon.observer.presets import WORN

__all__ = ["SHEET", "run"]

SHEET = "glare-figures.png"
WIDTHS = (64, 2048)
# Steps of each figure, for the bar.
STEPS = {4: 2, 5: 3, 6: 1, 7: 1 + 3 * (1 + len(AGES_YEARS)), 8: 1 + len(FRAME_SECONDS)}
PHOTO_STEPS = 3


def run(options: FiguresOptions) -> None:
    """Draws and writes. Raises `InputError` before anything is written."""
    asked, numbers = _checked(options)
    draws = _draws(options, asked, numbers)
    figures: list[Figure] = []
    with steps("drawing", sum(count for count, _ in draws)) as step:
        for _, draw in draws:
            figures += draw(asked, step)
    _write(options, figures)
    print(options.out / SHEET)


def _checked(options: FiguresOptions) -> tuple[Asked, tuple[int, ...]]:
    least, most = WIDTHS
    if not least <= options.width <= most:
        raise InputError(f"must be {least}…{most} px, got {options.width}", field="--width")
    if not 0 <= options.age <= 120:
        raise InputError(f"must be 0…120 years, got {options.age:g}", field="--age")
    if options.seed < 0:
        raise InputError(f"must be ≥ 0, got {options.seed}", field="--seed")
    if options.out.exists() and not options.out.is_dir():
        raise InputError("is no folder", file=options.out, field="--out")
    names = [str(number) for number in STEPS]
    typed = [one_of(part.strip(), names, "--figures") for part in options.figures.split(",")]
    glasses, dioptres = WORN[GLASSES[one_of(options.glasses, list(GLASSES), "--glasses")]]
    engine: Any = options.engine
    asked = Asked(options.width, engine, options.age, glasses, dioptres, options.seed)
    return asked, tuple(sorted({int(number) for number in typed}))


def _draws(
    options: FiguresOptions, asked: Asked, numbers: tuple[int, ...]
) -> list[tuple[int, Draw]]:
    """How many steps each takes, and what draws it; a photograph is read at once."""

    def street(asked: Asked, step: Callable[[], None]) -> tuple[Figure, ...]:
        return draw_street(street_scene(), asked, step)

    def leaves(asked: Asked, step: Callable[[], None]) -> tuple[Figure, ...]:
        return draw_komorebi(options.leaves, options.hfov_degrees, asked, step)

    known = {4: draw_blooms, 5: draw_needles, 6: draw_model, 7: street, 8: leaves}
    draws: list[tuple[int, Draw]] = [(STEPS[number], known[number]) for number in numbers]
    if options.photo is not None and 7 in numbers:
        photo = Photograph.read(
            options.photo,
            asked.width,
            hfov_degrees=options.hfov_degrees,
            cd_m2_per_unit=options.luminance_scale,
        )
        for warning in photo.warnings:
            note(warning)
        draws.insert(numbers.index(7) + 1, (PHOTO_STEPS, partial(draw_photograph, photo)))
    return draws


def _write(options: FiguresOptions, figures: list[Figure]) -> None:
    try:
        options.out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise MachineError(f"{options.out}: cannot be made: {error.strerror}") from error
    for figure in figures:
        for panel in figure.panels:
            write_png(options.out / f"{panel.name}.png", panel.picture)
        if len(figure.panels) > 1:
            write_png(options.out / f"{figure.name}.png", row_of(figure))
    write_png(options.out / SHEET, sheet_of(figures))
