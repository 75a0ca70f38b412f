"""``andon bake status``: how far a bake is, from its folder alone."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from andon.cli.bake import maps_folder, size
from andon.cli.console import printable
from andon.cli.durations import duration

if TYPE_CHECKING:
    from andon.bake.tasks import TasksStatus

__all__ = ["status"]

# Failed tasks that are listed before the list goes on with "…".
SHOWN = 10


def status(
    place: Annotated[Path, typer.Argument(help="Scene file with a [baked] table, or the folder.")],
) -> None:
    """Say how far a bake is: it may run, have been stopped, or be done.

    Examples:

        andon bake status room.toml

        andon bake status maps
    """
    from andon.bake.tasks import tasks_status

    folder = maps_folder(place)
    found = tasks_status(folder)
    if found is None:
        print(f"{folder}: no bake has begun")
        return
    for line in _lines(found, (folder / "maps.json").exists()):
        print(line)


def _lines(status: TasksStatus, has_maps: bool) -> list[str]:
    left = status.planned - status.done - len(status.failed)
    lines = [f"{status.folder}: {_state(status, left, has_maps)}"]
    failed = f", {len(status.failed)} failed" if status.failed else ""
    lines.append(f"tasks    {status.done} of {status.planned} done, {left} left{failed}")
    lines.append(f"work     {duration(status.seconds)}, {size(status.bytes)}")
    if status.running and status.seconds_left is not None:
        lines.append(f"left     about {duration(status.seconds_left)}")
    if status.last_done:
        lines.append(f"finished {printable(status.last_done)}")
    if status.last is not None:
        lines.append(f"last     {status.last.astimezone():%Y-%m-%d %H:%M:%S}")
    for failure in status.failed[:SHOWN]:
        lines.append(f"failed   {printable(failure.name)}: {printable(failure.reason)}")
    if len(status.failed) > SHOWN:
        lines.append(f"failed   … and {len(status.failed) - SHOWN} more")
    return lines


def _state(status: TasksStatus, left: int, has_maps: bool) -> str:
    if status.running:
        return f"running (pid {status.pid or 'unknown'})"
    if left or status.failed:
        return "stopped; run it again and it goes on"
    return "done" if has_maps else "all maps are done; run it again and it is complete"
