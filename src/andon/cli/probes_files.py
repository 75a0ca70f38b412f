"""``andon probes info`` and ``export``: what a volume holds, and its light for other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

__all__ = ["probes_info"]


def probes_info(
    volume: Annotated[Path, typer.Argument(help="A probe volume (.glb).")],
    json: Annotated[bool, typer.Option("--json", help="All of it, as JSON.")] = False,
) -> None:
    """Say what a probe volume holds: probes, states of light, zones, cells, memory.

    Examples:

        andon probes info room.glb

        andon probes info room.glb --json
    """
    from andon.cli.probe_facts import show

    show(volume, json=json)
