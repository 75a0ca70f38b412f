"""``andon glare`` and its sub-commands, listed once.

``andon glare IN.hdr -o OUT`` is the command `PICTURE`: it is what is meant where the first word is
none of the sub-commands. The commands themselves stand in modules that import nothing heavy; what
they do is imported when they run.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import typer
from typer.core import TyperGroup

from andon.cli import glare, glare_figures, glare_komorebi, glare_psf
from andon.errors import InputError, nearest_name

__all__ = ["PICTURE", "glare_app"]

# The name of the default command.
PICTURE = "picture"


class _PictureFirst(TyperGroup):
    """Takes what is no sub-command for the arguments of `PICTURE`."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        known = {*self.commands, *ctx.help_option_names}
        if args and args[0] not in known:
            self._refuse_misspelt(args[0])
            args = [PICTURE, *args]
        return super().parse_args(ctx, args)

    def _refuse_misspelt(self, word: str) -> None:
        """A word that is no picture's name, and nearly that of a sub-command."""
        near = nearest_name(word, list(self.commands))
        if near and not Path(word).suffix and not Path(word).exists():
            raise InputError(
                f"there is no command {word[:40]!r} and no picture of that name",
                field="glare",
                remedy=f"perhaps andon glare {near}",
            )


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
