"""``andon glare`` and its sub-commands, listed once.

``andon glare IN.hdr -o OUT`` is the command `PICTURE`: it is what is meant where the first word is
none of the sub-commands. The commands themselves stand in modules that import nothing heavy; what
they do is imported when they run.
"""

from __future__ import annotations

from typing import Any

import typer
from typer.core import TyperGroup

from andon.cli import glare, glare_figures, glare_komorebi, glare_psf

__all__ = ["PICTURE", "glare_app"]

# The name of the default command.
PICTURE = "picture"


class _PictureFirst(TyperGroup):
    """Takes what is no sub-command for the arguments of `PICTURE`."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        known = {*self.commands, *ctx.help_option_names}
        if args and args[0] not in known:
            args = [PICTURE, *args]
        return super().parse_args(ctx, args)


glare_app = typer.Typer(
    cls=_PictureFirst,
    no_args_is_help=True,
    help="Glare: what bright light does in the eye that sees it.",
)

# In the order of ``andon glare --help``.
glare_app.command(PICTURE)(glare.picture)
glare_app.command("psf")(glare_psf.psf)
glare_app.command("komorebi")(glare_komorebi.komorebi)
glare_app.command("figures")(glare_figures.figures)
