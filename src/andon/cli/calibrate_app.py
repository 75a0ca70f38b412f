"""``andon calibrate`` and its sub-commands, listed once."""

from __future__ import annotations

import typer

from andon.cli import calibrate_ambient, calibrate_response, calibrate_surface

__all__ = ["calibrate_app"]

calibrate_app = typer.Typer(no_args_is_help=True)


@calibrate_app.callback()
def _calibrate() -> None:
    """Find from pictures what a scene states: responses, surfaces, the light of a photograph."""


# In the order of ``andon calibrate --help``.
calibrate_app.command("response")(calibrate_response.response)
calibrate_app.command("surface")(calibrate_surface.surface)
calibrate_app.command("ambient")(calibrate_ambient.ambient)
