"""``andon glare`` and its sub-commands, listed once.

``andon glare IN.hdr -o OUT`` is the command `PICTURE`: it is what is meant where the first word is
none of the sub-commands. The commands themselves stand in modules that import nothing heavy; what
they do is imported when they run.
"""

from __future__ import annotations

import typer

from andon.cli import glare, glare_figures, glare_komorebi, glare_psf
from andon.cli.default_command import DefaultCommand

__all__ = ["PICTURE", "glare_app"]

# The name of the default command.
PICTURE = "picture"


class _PictureFirst(DefaultCommand):
    default, group, noun = PICTURE, "glare", "picture"


glare_app = typer.Typer(
    cls=_PictureFirst, subcommand_metavar="{picture} -o OUT | COMMAND [ARGS]..."
)


@glare_app.callback(invoke_without_command=True)
def _glare(context: typer.Context) -> None:
    """Glare: what bright light does in the eye that sees it.

    `andon glare IN -o OUT` shows a picture as an eye sees it; its options (age and eyes, models,
    exposure, numbers) are those of `andon glare picture --help`.

    Examples:

        andon glare night.hdr -o seen.png --age 70

        andon glare night.hdr -o ages.png --age 20,45,70 --compare --report ages.json

        andon glare psf -o psf.png
    """
    if context.invoked_subcommand is None:
        print(context.get_help())


# In the order of ``andon glare --help``.
glare_app.command(PICTURE)(glare.picture)
glare_app.command("psf")(glare_psf.psf)
glare_app.command("komorebi")(glare_komorebi.komorebi)
glare_app.command("figures")(glare_figures.figures)
