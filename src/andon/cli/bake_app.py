"""``andon bake`` and its sub-commands, listed once.

``andon bake SCENE`` is the command `MAPS`: it is what is meant where the first word is none of the
sub-commands. The commands themselves stand in modules that import nothing heavy.
"""

from __future__ import annotations

from typing import Any

import typer
from typer.core import TyperCommand

from andon.cli import bake, bake_cameras, bake_show, bake_status
from andon.cli.default_command import DefaultCommand

__all__ = ["MAPS", "bake_app"]

# The name of the default command.
MAPS = "maps"


class _SceneFirst(DefaultCommand):
    default, group, noun = MAPS, "bake", "scene file"


class _WithQualities(TyperCommand):
    """Says what the qualities cost and err when somebody asks for help; not before."""

    def format_help(self, ctx: Any, formatter: Any) -> None:
        """As Typer does."""
        self.help = (self.help or "").replace("QUALITIES", bake.qualities())
        super().format_help(ctx, formatter)


bake_app = typer.Typer(cls=_SceneFirst, subcommand_metavar="{SCENE | COMMAND [ARGS]...}")


@bake_app.callback(invoke_without_command=True)
def _bake(context: typer.Context) -> None:
    """Bake global illumination: what lamps give to a room, reflections included, by Radiance.

    `andon bake SCENE` makes the illuminance maps of the scene's [baked] table, or goes on with
    them; its options (workers, cluster, quality) are those of `andon bake maps --help`.

    Examples:

        andon bake room.toml --dry-run

        andon bake room.toml

        andon bake status room.toml
    """
    if context.invoked_subcommand is None:
        print(context.get_help())


# In the order of ``andon bake --help``.
bake_app.command(MAPS, cls=_WithQualities)(bake.maps)
bake_app.command("status")(bake_status.status)
bake_app.command("cameras")(bake_cameras.cameras)
bake_app.command("show")(bake_show.show)
