"""``andon probes``: the commands around probe volumes, listed once.

The commands themselves stand in modules that import nothing heavy; what they do is imported when
they run.
"""

from __future__ import annotations

import typer

from andon.cli import probes_bake, probes_place, probes_show
from andon.cli.probes_files import probes_export, probes_info

__all__ = ["probes_app"]

probes_app = typer.Typer()


@probes_app.callback(invoke_without_command=True)
def _probes(context: typer.Context) -> None:
    """Light probes: light captured at places, for whatever moves between them."""
    if context.invoked_subcommand is None:
        print(context.get_help())


# In the order of ``andon probes --help``.
probes_app.command("place")(probes_place.place)
probes_app.command("bake")(probes_bake.bake)
probes_app.command("info")(probes_info)
probes_app.command("show")(probes_show.show)
probes_app.command("export")(probes_export)
